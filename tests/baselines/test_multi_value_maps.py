"""The multi-sourced value maps: nearness, remoteness and their mean, by hand."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from toponav.baselines.multi_value_maps import combined, nearness, remoteness

LINE = np.column_stack([np.arange(5.0), np.zeros(5)])
"""Points at x = 0 ... 4."""
NOWHERE = np.zeros((0, 2))


def test_nearness_falls_with_the_distance_and_ends_at_the_cut() -> None:
    near = nearness(LINE, np.array([[0.0, 1.0], [-3.0, 0.0]]), cut_m=2.3)
    far = np.sqrt(17.0) - 1.0
    expected = [1.0, 1.0 - (np.sqrt(2.0) - 1.0) / far, 1.0 - (np.sqrt(5.0) - 1.0) / far, 0.0, 0.0]
    np.testing.assert_allclose(near, expected)


def test_remoteness_rises_from_the_trajectory_to_the_farthest_point() -> None:
    np.testing.assert_allclose(
        remoteness(LINE, np.array([[0.0, 0.0], [1.0, 0.0]])), [0.0, 0.0, 1 / 3, 2 / 3, 1.0]
    )


def test_nothing_is_near_to_or_far_from_nothing() -> None:
    assert not nearness(LINE, NOWHERE, 1.0).any()
    assert not remoteness(LINE, NOWHERE).any()


def test_a_lone_point_is_near_if_the_mark_is() -> None:
    here, mark = LINE[:1], np.array([[0.5, 0.0]])
    assert nearness(here, mark, 1.0) == [1.0]
    assert nearness(here, mark, 0.4) == [0.0]


def test_the_mean_is_clipped_and_nothing_beside_obstacles() -> None:
    maps = np.array([[0.0, 1.0, 0.4, 1.0], [0.0, 1.0, 0.2, 1.0], [0.0, 1.0, 0.0, 1.0], [0.1] * 4])
    value = combined(maps, np.array([1.0, 1.0, 0.25, 0.2]))
    assert value == pytest.approx([0.1, 0.775, 0.175, 0.0])


@given(st.lists(st.tuples(*[st.floats(-9, 9)] * 2), min_size=1, max_size=8), st.floats(0.0, 20.0))
def test_values_lie_in_the_unit_interval(marks: list[tuple[float, float]], cut_m: float) -> None:
    for value in (nearness(LINE, np.array(marks), cut_m), remoteness(LINE, np.array(marks))):
        assert value.min() >= 0.0
        assert value.max() <= 1.0
