"""The shortest way past all of some places: an open travelling-salesman tour from a start."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations, pairwise

import numpy as np
from numpy.typing import NDArray

EXACT_PLACES = 12
"""Up to so many places the tour is exact: 12 * 2^12 states of Held and Karp's recursion."""

SLACK_M = 1e-9
"""A change of the tour must gain more than this: rounding never makes one go round in circles."""


def open_tour(start: NDArray[np.float64], between: NDArray[np.float64]) -> tuple[int, ...]:
    """The order in which to visit all places, not coming back; the same input, the same order.

    Exact up to `EXACT_PLACES` (Held and Karp 1962), above that the nearest neighbour first and
    then reversals of parts of the tour (2-opt) for as long as they help.

    Args:
        start: (K,) lengths of the ways from the start to each place, metres.
        between: (K, K) lengths between places, symmetric, metres.

    Returns:
        The K places in order.
    """
    if len(start) <= EXACT_PLACES:
        return _exact(start, between)
    return _two_opt(_nearest_neighbours(start, between), start, between)


def tour_length(
    order: Sequence[int], start: NDArray[np.float64], between: NDArray[np.float64]
) -> float:
    """Length of the way from the start past the places in that order, metres."""
    if not order:
        return 0.0
    return float(start[order[0]]) + sum(float(between[a, b]) for a, b in pairwise(order))


def _exact(start: NDArray[np.float64], between: NDArray[np.float64]) -> tuple[int, ...]:
    """Held and Karp's recursion over (set of places visited, last place)."""
    count = len(start)
    best: dict[tuple[int, int], tuple[float, int]] = {
        (1 << place, place): (float(start[place]), -1) for place in range(count)
    }
    for size in range(2, count + 1):
        for chosen in combinations(range(count), size):
            visited = sum(1 << place for place in chosen)
            for last in chosen:
                before = visited ^ (1 << last)
                best[visited, last] = min(
                    (best[before, place][0] + float(between[place, last]), place)
                    for place in chosen
                    if place != last
                )
    visited = (1 << count) - 1
    last = min(range(count), key=lambda place: (best[visited, place][0], place), default=-1)
    order = []
    while last >= 0:
        order.append(last)
        visited, last = visited ^ (1 << last), best[visited, last][1]
    return tuple(reversed(order))


def _nearest_neighbours(
    start: NDArray[np.float64], between: NDArray[np.float64]
) -> tuple[int, ...]:
    order: list[int] = []
    left = list(range(len(start)))
    while left:
        onward = between[order[-1]] if order else start
        order.append(min(left, key=lambda place: (float(onward[place]), place)))
        left.remove(order[-1])
    return tuple(order)


def _two_opt(
    order: tuple[int, ...], start: NDArray[np.float64], between: NDArray[np.float64]
) -> tuple[int, ...]:
    """Reverse parts of the tour while one of them, the first found, makes it shorter."""
    length = tour_length(order, start, between)
    improved = True
    while improved:
        improved = False
        for first, last in combinations(range(len(order)), 2):
            turned = order[:first] + order[first : last + 1][::-1] + order[last + 1 :]
            turned_length = tour_length(turned, start, between)
            if turned_length < length - SLACK_M:
                order, length, improved = turned, turned_length, True
    return order
