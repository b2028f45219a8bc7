"""Dijkstra's algorithm on a grid of 16 neighbours: costs to the nearest seed, and the way there.

Cells wait in buckets no wider than the cheapest move, so that all cells of one bucket are settled
when their turn comes, in any order (Dial's method): several times faster than a heap.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

NEIGHBOURS = np.array(
    [
        (1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (1, -1), (-1, 1), (-1, -1),
        (2, 1), (2, -1), (-2, 1), (-2, -1), (1, 2), (1, -2), (-1, 2), (-1, -2),
    ],
    dtype=np.int64,
)  # fmt: skip
"""Straight, diagonal and knight's moves, which keep lengths within 3 % of Euclid's."""

STRAIGHT_MOVES = 4
"""The first so many of `NEIGHBOURS` pass no other cell."""

LENGTHS = np.sqrt((NEIGHBOURS**2).sum(axis=1).astype(np.float64))
"""Of the moves, in cells."""

NO_PARENT = -1
"""The parent of seeds and of cells without a way."""


@njit(cache=True)
def passable(traversable: NDArray[np.bool_], i: int, j: int, di: int, dj: int) -> bool:
    """Whether every cell that a diagonal or knight's move touches is traversable."""
    if abs(di) == 2:
        return bool(traversable[i + di // 2, j] and traversable[i + di // 2, j + dj])
    if abs(dj) == 2:
        return bool(traversable[i, j + dj // 2] and traversable[i + di, j + dj // 2])
    return bool(traversable[i + di, j] and traversable[i, j + dj])


EVERYWHERE = (np.empty((0, 2), np.int64), 0.0)
"""A search that ends when there is nothing left to search."""


class _Buckets(NamedTuple):
    """Cells that wait, by cost; a ring, since no move costs more than it spans.

    Attributes:
        width: Cost that a bucket spans.
        first: (R,) flat index of a bucket's first cell, or `NONE`.
        before: (N_x * N_y,) neighbours in the list of the cell's bucket, or `NONE`.
        after: (N_x * N_y,) likewise.
    """

    width: float
    first: NDArray[np.int32]
    before: NDArray[np.int32]
    after: NDArray[np.int32]


NONE = -1
"""No cell."""


@njit(cache=True)
def _buckets(traversable: NDArray[np.bool_], cell_cost: NDArray[np.float64]) -> _Buckets:
    cheapest, dearest = np.inf, 0.0
    for i in range(traversable.shape[0]):
        for j in range(traversable.shape[1]):
            if traversable[i, j]:
                cheapest = min(cheapest, cell_cost[i, j])
                dearest = max(dearest, cell_cost[i, j])
    # A little less than the cheapest move, so that rounding leads to no bucket that has been left.
    width = 0.999 * cheapest if cheapest < np.inf else 1.0
    ring = int(LENGTHS.max() * dearest / width) + 3
    first = np.full(ring, NONE, np.int32)
    before = np.full(traversable.size, NONE, np.int32)
    return _Buckets(width, first, before, before.copy())


@njit(cache=True)
def _enter(buckets: _Buckets, cell: int, cost: float) -> None:
    bucket = int(cost / buckets.width) % buckets.first.size
    next_cell = buckets.first[bucket]
    buckets.first[bucket] = cell
    buckets.before[cell], buckets.after[cell] = NONE, next_cell
    if next_cell != NONE:
        buckets.before[next_cell] = cell


@njit(cache=True)
def _leave(buckets: _Buckets, cell: int, cost: float) -> None:
    before, after = buckets.before[cell], buckets.after[cell]
    if before == NONE:
        buckets.first[int(cost / buckets.width) % buckets.first.size] = after
    else:
        buckets.after[before] = after
    if after != NONE:
        buckets.before[after] = before


class _Search(NamedTuple):
    """A search in the making, over (N_x, N_y) cells.

    Attributes:
        cost: From the nearest seed; infinite where it has not come yet.
        parent: Flat index of the next cell on the way to the seed.
        is_wanted: Whether the search may end without it.
        buckets: Cells that wait.
    """

    cost: NDArray[np.float64]
    parent: NDArray[np.int64]
    is_wanted: NDArray[np.bool_]
    buckets: _Buckets


@njit(cache=True)
def _new_search(traversable: NDArray[np.bool_], cell_cost: NDArray[np.float64]) -> _Search:
    return _Search(
        np.full(traversable.shape, np.inf),
        np.full(traversable.shape, NO_PARENT, np.int64),
        np.zeros(traversable.shape, np.bool_),
        _buckets(traversable, cell_cost),
    )


@njit(cache=True)
def shortest_paths(
    traversable: NDArray[np.bool_],
    cell_cost: NDArray[np.float64],
    seeds: NDArray[np.int64],
    until: tuple[NDArray[np.int64], float],
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Cost from every cell to the nearest seed.

    A move costs its length in cells times the mean cost of its two ends. Of equally cheap ways that
    over the cheaper neighbour is taken, then that over the one of lower index, so the result does
    not depend on the order of the seeds.

    Args:
        traversable: (N_x, N_y) cells that may be entered.
        cell_cost: (N_x, N_y) positive cost of crossing one cell.
        seeds: (S, 2) indices inside the grid; those not traversable are ignored.
        until: (W, 2) indices inside the grid, and a margin in units of cost. The search ends when
            all of these cells and what costs up to the margin more are settled; the rest keeps an
            infinite cost. With no cell, or one that no way leads to, everything is searched.

    Returns:
        (N_x, N_y) costs, infinite without a way, and (N_x, N_y) parents: the flat index of the next
        cell on the way to the seed.
    """
    search = _new_search(traversable, cell_cost)
    cost, parent = search.cost, search.parent
    limit = _spread((traversable, cell_cost), search, seeds, until, np.inf)
    for i in range(cost.shape[0]):
        for j in range(cost.shape[1]):
            if cost[i, j] > limit:
                cost[i, j], parent[i, j] = np.inf, NO_PARENT
    return cost, parent


@njit(cache=True)
def costs_between(
    traversable: NDArray[np.bool_],
    cell_cost: NDArray[np.float64],
    cells: NDArray[np.int64],
    within: float,
) -> NDArray[np.float64]:
    """(N, N) costs between (N, 2) cells inside the grid; infinite without a way, or beyond a cost.

    Costs are those of `shortest_paths`. Both directions cost the same, so that every search looks
    for the cells before its own alone, and all share their memory.
    """
    between = np.full((len(cells), len(cells)), np.inf)
    search = _new_search(traversable, cell_cost)
    for k in range(len(cells)):
        between[k, k] = 0.0 if traversable[cells[k, 0], cells[k, 1]] else np.inf
        if k == 0:
            continue
        search.cost[:] = np.inf
        search.is_wanted[:] = False
        search.buckets.first[:] = NONE
        limit = _spread(
            (traversable, cell_cost), search, cells[k : k + 1], (cells[:k], 0.0), within
        )
        for other in range(k):
            cost = search.cost[cells[other, 0], cells[other, 1]]
            if cost <= limit:
                between[k, other] = between[other, k] = cost
    return between


@njit(cache=True)
def _spread(
    ground: tuple[NDArray[np.bool_], NDArray[np.float64]],
    search: _Search,
    seeds: NDArray[np.int64],
    until: tuple[NDArray[np.int64], float],
    within: float,
) -> float:
    """Settle cells in the order of their costs; returns the cost up to which they are settled."""
    traversable = ground[0]
    cost, parent, is_wanted, buckets = search
    columns = traversable.shape[1]
    waiting = 0
    for k in range(len(seeds)):
        i, j = seeds[k]
        if traversable[i, j] and cost[i, j] > 0.0:
            cost[i, j], parent[i, j] = 0.0, NO_PARENT
            _enter(buckets, i * columns + j, 0.0)
            waiting += 1
    wanted, margin = until
    missing = 0
    for k in range(len(wanted)):
        missing += int(not is_wanted[wanted[k, 0], wanted[k, 1]])
        is_wanted[wanted[k, 0], wanted[k, 1]] = True
    farthest, limit, bucket = 0.0, within, 0
    while waiting > 0 and bucket * buckets.width <= limit:
        cell = buckets.first[bucket % buckets.first.size]
        if cell == NONE:
            bucket += 1
            continue
        i, j = cell // columns, cell % columns
        _leave(buckets, cell, cost[i, j])
        waiting += _pass_on(ground, buckets, cost, parent, cell) - 1
        if is_wanted[i, j]:
            farthest = max(farthest, cost[i, j])
            missing -= 1
            if missing == 0:
                limit = min(within, farthest + margin)
    return limit


@njit(cache=True)
def _pass_on(
    ground: tuple[NDArray[np.bool_], NDArray[np.float64]],
    buckets: _Buckets,
    cost: NDArray[np.float64],
    parent: NDArray[np.int64],
    cell: int,
) -> int:
    """Offer the ways over a settled cell to its neighbours; returns how many had none before."""
    traversable, cell_cost = ground
    rows, columns = traversable.shape
    i, j = cell // columns, cell % columns
    settled = cost[i, j]
    new = 0
    for n in range(len(NEIGHBOURS)):
        di, dj = NEIGHBOURS[n]
        a, b = i + di, j + dj
        if a < 0 or b < 0 or a >= rows or b >= columns or not traversable[a, b]:
            continue
        known = cost[a, b]
        if known <= settled:
            continue
        if n >= STRAIGHT_MOVES and not passable(traversable, i, j, di, dj):
            continue
        candidate = settled + LENGTHS[n] * 0.5 * (cell_cost[i, j] + cell_cost[a, b])
        if candidate < known:
            if known < np.inf:
                _leave(buckets, a * columns + b, known)
            else:
                new += 1
            cost[a, b], parent[a, b] = candidate, cell
            _enter(buckets, a * columns + b, candidate)
        elif candidate == known:
            other = parent[a, b]
            of_other = cost[other // columns, other % columns]
            if settled < of_other or (settled == of_other and cell < other):
                parent[a, b] = cell
    return new
