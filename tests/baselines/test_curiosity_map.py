"""The curiosity map: floor painted by views, which can only lower it."""

from __future__ import annotations

import numpy as np
import pytest

from toponav.baselines.curiosity_map import PAINTED_M, UNSEEN, CuriosityMap

EYE = np.zeros(2)
FLOOR = np.array([(0.05, 0.05), (1.05, 0.05), (1.06, 0.06), (PAINTED_M + 0.05, 0.05)])


def test_views_lower_the_floor_close_by() -> None:
    curiosity = CuriosityMap()
    curiosity.paint(FLOOR, EYE, 4.0)
    np.testing.assert_array_equal(curiosity.at(FLOOR), [4.0, 4.0, 4.0, UNSEEN])
    curiosity.paint(FLOOR[:1], EYE, 7.0)
    curiosity.paint(FLOOR[1:2], EYE, 1.0)
    np.testing.assert_array_equal(curiosity.at(FLOOR), [4.0, 1.0, 1.0, UNSEEN])


def test_the_mean_is_over_cells_and_nothing_is_worth_nothing() -> None:
    curiosity = CuriosityMap()
    curiosity.paint(FLOOR, EYE, 4.0)
    assert curiosity.mean(FLOOR) == pytest.approx((4.0 + 4.0 + UNSEEN) / 3)
    assert curiosity.mean(FLOOR[:0]) == 0.0
