"""Open tours against all permutations."""

from __future__ import annotations

from itertools import permutations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from toponav.baselines.open_tour import EXACT_PLACES, open_tour, tour_length


def scattered(seed: int, places: int) -> tuple[np.ndarray, np.ndarray]:
    points = np.random.default_rng(seed).uniform(0.0, 10.0, (places + 1, 2))
    length = np.linalg.norm(points[:, None] - points, axis=-1)
    return length[0, 1:], length[1:, 1:]


@settings(max_examples=30)
@given(seed=st.integers(0, 10_000), places=st.integers(1, 6))
def test_small_tours_are_as_short_as_the_best_permutation(seed: int, places: int) -> None:
    start, between = scattered(seed, places)
    best = min(tour_length(order, start, between) for order in permutations(range(places)))
    order = open_tour(start, between)
    assert sorted(order) == list(range(places))
    assert tour_length(order, start, between) == pytest.approx(best)


@pytest.mark.parametrize("seed", range(5))
def test_large_tours_are_complete_cannot_be_shortened_by_a_reversal_and_repeat(seed: int) -> None:
    start, between = scattered(seed, EXACT_PLACES + 8)
    order = open_tour(start, between)
    assert sorted(order) == list(range(len(start)))
    assert open_tour(start, between) == order
    length = tour_length(order, start, between)
    for first in range(len(order)):
        for last in range(first + 1, len(order)):
            turned = order[:first] + order[first : last + 1][::-1] + order[last + 1 :]
            assert tour_length(turned, start, between) >= length - 1e-6


def test_the_largest_exact_tour_is_not_beaten_by_the_heuristic() -> None:
    start, between = scattered(3, EXACT_PLACES)
    padded = np.append(start, start[0]), np.pad(between, ((0, 1), (0, 1)), mode="edge")
    padded[1][-1, :-1] = padded[1][:-1, -1] = between[0]  # a thirteenth place upon the first
    padded[1][0, -1] = padded[1][-1, 0] = padded[1][-1, -1] = 0.0
    exact = tour_length(open_tour(start, between), start, between)
    assert exact <= tour_length(open_tour(*padded), *padded) + 1e-9


def test_of_equal_tours_the_first_places_win_and_no_places_are_no_tour() -> None:
    start, between = np.ones(3), np.ones((3, 3)) - np.eye(3)
    assert open_tour(start, between) == open_tour(start, between)
    assert open_tour(np.zeros(0), np.zeros((0, 0))) == ()
    assert tour_length((), start, between) == 0.0
