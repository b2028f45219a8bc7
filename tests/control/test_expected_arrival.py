"""The soonest order against every other order."""

from __future__ import annotations

from itertools import pairwise, permutations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from toponav.control.expected_arrival import soonest_order


def mean_way(
    order: tuple[int, ...], start: np.ndarray, between: np.ndarray, chance: np.ndarray
) -> float:
    ways = np.cumsum([start[order[0]], *(between[a, b] for a, b in pairwise(order))])
    return float(ways @ chance[list(order)])


@given(st.integers(1, 6), st.integers(0, 2**32 - 1))
def test_no_other_order_is_sooner(count: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    start, chance = rng.uniform(0.0, 9.0, count), rng.uniform(0.0, 1.0, count)
    between = rng.uniform(0.0, 9.0, (count, count))
    order = soonest_order(start, between, chance)
    assert sorted(order) == list(range(count))
    others = [mean_way(o, start, between, chance) for o in permutations(range(count))]
    assert mean_way(order, start, between, chance) == pytest.approx(min(others))


def test_a_near_place_on_the_way_comes_first_and_a_likely_one_before_a_nearer_one() -> None:
    place = np.array([1.0, 5.0, -2.0])
    between = np.abs(place[:, None] - place)
    assert soonest_order(np.abs(place), between, np.array([0.1, 0.8, 0.1])) == (0, 1, 2)
    assert soonest_order(np.abs(place), between, np.array([0.1, 0.1, 0.8])) == (2, 0, 1)


def test_nothing_has_an_order() -> None:
    assert soonest_order(np.zeros(0), np.zeros((0, 0)), np.zeros(0)) == ()
