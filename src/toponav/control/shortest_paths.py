"""Dijkstra's algorithm on a grid of 16 neighbours: costs to the nearest seed, and the way there.

Cells wait in buckets no wider than the cheapest move, so that all cells of one bucket are settled
when their turn comes, in any order (Dial's method): several times faster than a heap. A cell to
which a cheaper way is found waits once more, and is passed over the second time. Cells are numbered
along a grid with a margin as wide as a move, so that no move has to be kept inside.
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


MARGIN = 2
"""Cells around the grid that nobody enters: no move reaches farther."""

EVERYWHERE = (np.empty((0, 2), np.int64), 0.0)
"""A search that ends when there is nothing left to search."""

NONE = -1
"""No entry."""


class _Ground(NamedTuple):
    """The grid with its margin, M cells in all.

    Attributes:
        columns: Cells of one of its rows.
        traversable: (M,) cells that may be entered.
        cell_cost: (M,) cost of crossing one.
        moves: (16,) what a move adds to a cell's number.
        beside: (16, 2) likewise the two cells that a diagonal or knight's move touches.
    """

    columns: int
    traversable: NDArray[np.bool_]
    cell_cost: NDArray[np.float64]
    moves: NDArray[np.int64]
    beside: NDArray[np.int64]


class _Buckets(NamedTuple):
    """Cells that wait, by cost; a ring of lists, since no move costs more than it spans.

    Attributes:
        width: Cost that a bucket spans.
        first: (R,) a bucket's first entry, or `NONE`.
        cells: (E,) the cell of an entry.
        after: (E,) the next entry of its bucket, or `NONE`.
    """

    width: float
    first: NDArray[np.int32]
    cells: NDArray[np.int32]
    after: NDArray[np.int32]


class _Search(NamedTuple):
    """A search in the making, over the M cells of the ground.

    Attributes:
        cost: (M,) from the nearest seed; infinite where it has not come yet.
        parent: (M,) the next cell on the way to the seed, or `NO_PARENT`.
        is_settled: (M,) whether that is final.
        is_wanted: (M,) whether the search may end without it.
    """

    cost: NDArray[np.float64]
    parent: NDArray[np.int32]
    is_settled: NDArray[np.bool_]
    is_wanted: NDArray[np.bool_]


@njit(cache=True)
def _ground(traversable: NDArray[np.bool_], cell_cost: NDArray[np.float64]) -> _Ground:
    rows, columns = traversable.shape
    wide = columns + 2 * MARGIN
    may_enter = np.zeros((rows + 2 * MARGIN, wide), np.bool_)
    costs = np.zeros((rows + 2 * MARGIN, wide))
    may_enter[MARGIN : MARGIN + rows, MARGIN : MARGIN + columns] = traversable
    costs[MARGIN : MARGIN + rows, MARGIN : MARGIN + columns] = cell_cost
    moves, beside = np.empty(len(NEIGHBOURS), np.int64), np.zeros((len(NEIGHBOURS), 2), np.int64)
    for n in range(len(NEIGHBOURS)):
        di, dj = NEIGHBOURS[n]
        moves[n] = di * wide + dj
        if abs(di) == 2:
            beside[n] = (di // 2 * wide, di // 2 * wide + dj)
        elif abs(dj) == 2:
            beside[n] = (dj // 2, di * wide + dj // 2)
        else:
            beside[n] = (di * wide, dj)
    return _Ground(wide, may_enter.ravel(), costs.ravel(), moves, beside)


@njit(cache=True)
def _buckets(ground: _Ground) -> _Buckets:
    cheapest, dearest, entries = np.inf, 0.0, 1
    for cell in range(ground.traversable.size):
        if ground.traversable[cell]:
            cheapest = min(cheapest, ground.cell_cost[cell])
            dearest = max(dearest, ground.cell_cost[cell])
            entries += 1
    # A little less than the cheapest move, so that rounding leads to no bucket that has been left.
    width = 0.999 * cheapest if cheapest < np.inf else 1.0
    ring = int(LENGTHS.max() * dearest / width) + 3
    # Every move may find a cheaper way.
    entries *= len(NEIGHBOURS)
    cells = np.empty(entries, np.int32)
    return _Buckets(width, np.full(ring, NONE, np.int32), cells, np.empty(entries, np.int32))


@njit(cache=True)
def _new_search(cells: int) -> _Search:
    return _Search(
        np.full(cells, np.inf),
        np.full(cells, NO_PARENT, np.int32),
        np.zeros(cells, np.bool_),
        np.zeros(cells, np.bool_),
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
    ground = _ground(traversable, cell_cost)
    search, buckets = _new_search(ground.traversable.size), _buckets(ground)
    limit, _ = _spread(ground, search, buckets, seeds, until, np.empty(0))
    cost = np.full(traversable.shape, np.inf)
    parent = np.full(traversable.shape, NO_PARENT, np.int64)
    rows, columns = traversable.shape
    for i in range(rows):
        for j in range(columns):
            cell = (i + MARGIN) * ground.columns + j + MARGIN
            if search.cost[cell] > limit:
                continue
            cost[i, j] = search.cost[cell]
            onward = search.parent[cell]
            if onward != NO_PARENT:
                row = onward // ground.columns
                parent[i, j] = (row - MARGIN) * columns + onward - row * ground.columns - MARGIN
    return cost, parent


@njit(cache=True)
def costs_between(
    traversable: NDArray[np.bool_],
    cell_cost: NDArray[np.float64],
    cells: NDArray[np.int64],
    within: NDArray[np.float64],
) -> NDArray[np.float64]:
    """(N, N) costs between (N, 2) cells inside the grid; infinite without a way, or beyond a cost.

    Costs are those of `shortest_paths`. Both directions cost the same, so that every search looks
    for the cells before its own alone, and all share their memory. (N, N) symmetric `within` says
    for each pair beyond which cost it does not matter: the search goes on only from cells that may
    lie on a cheaper way.
    """
    between = np.full((len(cells), len(cells)), np.inf)
    ground = _ground(traversable, cell_cost)
    search, buckets = _new_search(ground.traversable.size), _buckets(ground)
    for k in range(len(cells)):
        between[k, k] = 0.0 if traversable[cells[k, 0], cells[k, 1]] else np.inf
        if k == 0:
            continue
        until = (cells[:k], 0.0)
        limit, entries = _spread(ground, search, buckets, cells[k : k + 1], until, within[k, :k])
        for other in range(k):
            place = (cells[other, 0] + MARGIN) * ground.columns + cells[other, 1] + MARGIN
            if search.cost[place] <= min(limit, within[k, other]):
                between[k, other] = between[other, k] = search.cost[place]
            search.is_wanted[place] = False
        for entry in range(entries):
            search.cost[buckets.cells[entry]] = np.inf
            search.is_settled[buckets.cells[entry]] = False
        buckets.first[:] = NONE
    return between


@njit(cache=True)
def _spread(
    ground: _Ground,
    search: _Search,
    buckets: _Buckets,
    seeds: NDArray[np.int64],
    until: tuple[NDArray[np.int64], float],
    within: NDArray[np.float64],
) -> tuple[float, int]:
    """Settle cells in the order of their costs.

    Args:
        ground: Where.
        search: In the making.
        buckets: Empty.
        seeds: From where.
        until: As of `shortest_paths`.
        within: Beyond which cost each of the cells of `until` is out of reach; empty for nowhere.

    Returns:
        The cost up to which they are settled, and the number of entries made.
    """
    cost, is_settled, is_wanted = search.cost, search.is_settled, search.is_wanted
    width, first, cells, after = buckets
    ring = first.size
    entries = 0
    for k in range(len(seeds)):
        cell = (seeds[k, 0] + MARGIN) * ground.columns + seeds[k, 1] + MARGIN
        if ground.traversable[cell] and cost[cell] > 0.0:
            cost[cell], search.parent[cell] = 0.0, NO_PARENT
            cells[entries], after[entries], first[0] = cell, first[0], entries
            entries += 1
    waiting = entries
    wanted, margin = until
    missing = 0
    for k in range(len(wanted)):
        cell = (wanted[k, 0] + MARGIN) * ground.columns + wanted[k, 1] + MARGIN
        missing += int(not is_wanted[cell])
        is_wanted[cell] = True
    farthest, bucket = 0.0, 0
    farthest_within = within.max() if within.size else np.inf
    limit = farthest_within
    while waiting > 0 and bucket * width <= limit:
        entry = first[bucket % ring]
        if entry == NONE:
            bucket += 1
            continue
        first[bucket % ring] = after[entry]
        cell = cells[entry]
        if is_settled[cell]:
            continue
        is_settled[cell] = True
        waiting -= 1
        if not within.size or _may_lead_on(ground, (cell, cost[cell]), wanted, within, buckets):
            new, entries = _pass_on(ground, search, buckets, cell, entries)
            waiting += new
        if is_wanted[cell]:
            farthest = max(farthest, cost[cell])
            missing -= 1
            if missing == 0:
                limit = min(farthest_within, farthest + margin)
    return limit, entries


@njit(cache=True)
def _may_lead_on(
    ground: _Ground,
    reached: tuple[int, float],
    wanted: NDArray[np.int64],
    within: NDArray[np.float64],
    buckets: _Buckets,
) -> bool:
    """Whether a cell, reached at a cost, may lie on a way to a wanted cell that is within reach.

    No way is shorter than the straight line, or cheaper than over the cheapest cells.
    """
    cell, cost = reached
    i, j = cell // ground.columns - MARGIN, cell % ground.columns - MARGIN
    for k in range(len(wanted)):
        left = (within[k] - cost) / buckets.width
        away_i, away_j = wanted[k, 0] - i, wanted[k, 1] - j
        if left >= 0.0 and away_i * away_i + away_j * away_j <= left * left:
            return True
    return False


@njit(cache=True, inline="always")
def _pass_on(
    ground: _Ground, search: _Search, buckets: _Buckets, cell: int, entries: int
) -> tuple[int, int]:
    """Offer the ways over a settled cell to its neighbours.

    Returns:
        How many had none before, and the number of entries now.
    """
    _, traversable, cell_cost, moves, beside = ground
    cost, parent = search.cost, search.parent
    width, first, cells, after = buckets
    settled, here, ring = cost[cell], cell_cost[cell], np.uint32(first.size)
    here_at = np.uint64(cell)
    new = 0
    for n in range(len(NEIGHBOURS)):
        other = here_at + np.uint64(moves[n])
        known = cost[other]
        if known <= settled or not traversable[other]:
            continue
        if n >= STRAIGHT_MOVES and not (
            traversable[here_at + np.uint64(beside[n, 0])]
            and traversable[here_at + np.uint64(beside[n, 1])]
        ):
            continue
        candidate = settled + LENGTHS[n] * 0.5 * (here + cell_cost[other])
        if candidate < known:
            new += int(known == np.inf)
            cost[other], parent[other] = candidate, cell
            bucket = np.uint32(candidate / width) % ring
            cells[entries], after[entries], first[bucket] = other, first[bucket], entries
            entries += 1
        elif candidate == known:
            of_rival = cost[parent[other]]
            if settled < of_rival or (settled == of_rival and cell < parent[other]):
                parent[other] = cell
    return new, entries
