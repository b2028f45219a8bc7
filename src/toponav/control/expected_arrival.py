"""The order of visits that finds something soonest, when each place holds it with some chance."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

MAX_PLACES = 12
"""Places that are ordered exactly: 12^2 * 2^12 steps of the recursion, a few milliseconds."""


def soonest_order(
    start: NDArray[np.float64], between: NDArray[np.float64], chance: NDArray[np.float64]
) -> tuple[int, ...]:
    """The order that minimises the mean way to the place that holds it; exact.

    The sum over places of chance x length of the way until there, by recursion over (set of places
    visited, last place): each step costs its length for all the chance that is still ahead.

    Args:
        start: (K,) lengths of the ways from the start, K <= `MAX_PLACES`, metres.
        between: (K, K) lengths between places, metres.
        chance: (K,) >= 0; need not sum to 1.

    Returns:
        The K places in order; the same input, the same order.
    """
    assert len(start) <= MAX_PLACES
    if not len(start):
        return ()
    return tuple(int(place) for place in _order(start, between, chance))


@njit(cache=True)
def _order(
    start: NDArray[np.float64], between: NDArray[np.float64], chance: NDArray[np.float64]
) -> NDArray[np.int64]:
    count = len(start)
    sets = 1 << count
    best = np.full((sets, count), np.inf)
    before = np.full((sets, count), -1, np.int64)
    ahead = np.zeros(sets)
    for visited in range(sets):
        for place in range(count):
            if not visited >> place & 1:
                ahead[visited] += chance[place]
    for place in range(count):
        best[1 << place, place] = start[place] * ahead[0]
    for visited in range(1, sets):
        for last in range(count):
            so_far = best[visited, last]
            if not np.isfinite(so_far):
                continue
            for place in range(count):
                if visited >> place & 1:
                    continue
                cost = so_far + between[last, place] * ahead[visited]
                after = visited | 1 << place
                if cost < best[after, place]:
                    best[after, place] = cost
                    before[after, place] = last
    order = np.empty(count, np.int64)
    visited = sets - 1
    last = int(np.argmin(best[visited]))
    for position in range(count - 1, -1, -1):
        order[position] = last
        visited, last = visited ^ (1 << last), before[visited, last]
    return order
