"""The value map: the cone of an image, the fusion of looks, and medians over it."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from drawn_map import observation_at
from toponav.baselines.value_map import CELL_M, ValueMap, cone_confidence, fused, visible_cone

UNIT = st.floats(0.0, 1.0)


def test_confidence_is_one_ahead_and_a_quarter_at_the_edge() -> None:
    confidence = cone_confidence(np.radians([0.0, 20.0, -20.0, 40.0]), np.radians(80.0))
    np.testing.assert_allclose(confidence, [1.0, 0.625, 0.625, 0.25])


def test_two_looks_are_weighted_by_their_confidence() -> None:
    value, confidence = fused(np.array([0.2]), np.array([0.5]), 0.8, np.array([1.0]))
    assert value == pytest.approx([(0.5 * 0.2 + 1.0 * 0.8) / 1.5])
    assert confidence == pytest.approx([1.25 / 1.5])


def test_a_doubtful_look_changes_only_what_is_known_worse() -> None:
    old = np.array([0.2, 0.2, 0.0]), np.array([0.5, 0.3, 0.0])
    value, confidence = fused(*old, 0.8, np.array([0.34, 0.34, 0.34]))
    assert value[0] == 0.2
    assert confidence[0] == 0.5
    assert value[1] > 0.2
    assert (value[2], confidence[2]) == pytest.approx((0.8, 0.34))


@given(UNIT, st.floats(0.0, 1.0), UNIT, st.floats(0.25, 1.0))
def test_a_fused_value_lies_between_the_two(old: float, known: float, new: float, w: float) -> None:
    value, confidence = fused(np.array([old]), np.array([known]), new, np.array([w]))
    assert min(old, new) - 1e-9 <= value[0] <= max(old, new) + 1e-9
    assert 0.0 < confidence[0] <= 1.0


def test_the_cone_ends_at_the_wall_and_at_the_images_edges() -> None:
    observation = observation_at(1.0, 1.5, depth_m=2.0)
    cells, confidence = visible_cone(observation, max_range_m=5.0)
    x, y = ((cells + 0.5) * CELL_M - (1.0, 1.5)).T
    assert 1.8 < x.max() <= 2.0
    assert x.min() > 0.0
    # Half a pixel beyond its centre the last column still covers the floor.
    assert (np.abs(y / x) <= np.tan(observation.intrinsics.hfov / 2) + 0.05).all()
    assert np.abs(y).max() > 1.4
    best = np.argmax(confidence)
    assert abs(y[best] / x[best]) < 0.06
    near, _ = visible_cone(observation, max_range_m=1.0)
    assert np.hypot(*((near + 0.5) * CELL_M - (1.0, 1.5)).T).max() <= 1.0


def test_right_of_the_image_is_right_of_the_agent() -> None:
    observation = observation_at(1.0, 1.5, depth_m=2.0)
    observation.depth[:, 20:] = 0.0
    cells, _ = visible_cone(observation, max_range_m=5.0)
    assert ((cells[:, 1] + 0.5) * CELL_M).min() > 1.4


def test_medians_are_taken_over_seen_cells_only_wherever_the_map_has_grown() -> None:
    values = ValueMap(max_range_m=5.0)
    assert values.median_within((2.0, 1.5), 0.5) == 0.0
    values.add(observation_at(1.0, 1.5), 0.6)
    assert values.median_within((3.0, 1.5), 0.5) == pytest.approx(0.6)
    values.add(observation_at(-30.0, -20.0), 0.3)
    assert values.median_within((3.0, 1.5), 0.5) == pytest.approx(0.6)
    assert values.median_within((-28.5, -20.0), 0.5) == pytest.approx(0.3)
    assert values.median_within((90.0, 90.0), 0.5) == 0.0
    assert values.median_within((-90.0, -90.0), 0.5) == 0.0


def test_an_image_without_depth_shows_nothing() -> None:
    values = ValueMap(max_range_m=5.0)
    values.add(observation_at(0.0, 0.0, depth_m=0.0), 0.9)
    assert values.median_within((1.0, 0.0), 2.0) == 0.0
