"""Dijkstra's algorithm on a grid of 16 neighbours: costs to the nearest seed, and the way there.

Cells wait in buckets no wider than the cheapest move, so that all cells of one bucket are settled
when their turn comes, in any order (Dial's method): several times faster than a heap. A cell to
which a cheaper way is found waits once more, and is passed over the second time. Cells are numbered
along a grid with a margin as wide as a move, so that no move has to be kept inside. All moves from
a cell are tried at once, without branches that nobody can foresee, before any of them is made.
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

LENGTHS = np.sqrt((NEIGHBOURS**2).sum(axis=1).astype(np.float64))
"""Of the moves, in cells."""

HALF_LENGTHS = 0.5 * LENGTHS
"""What a move costs, times the sum of the costs of its two ends."""

NO_PARENT = -1
"""The parent of seeds and of cells without a way."""


MARGIN = 2
"""Cells around the grid that nobody enters: no move reaches farther."""

EVERYWHERE = (np.empty((0, 2), np.int64), 0.0)
"""A search that ends when there is nothing left to search."""

NONE = -1
"""No entry."""

DE_BRUIJN = np.uint32(0x09AF)
"""Shifted by n, its upper four of sixteen bits differ for every n: they tell the n of 2^n."""

BIT_OF = np.zeros(16, np.int64)
"""The n of 2^n, by those four bits."""
for _n in range(16):
    BIT_OF[(int(DE_BRUIJN) << _n >> 12) & 15] = _n

SLACK = 1e-9
"""Share by which sums of the same costs along different ways may differ by rounding: far more."""


class Ground(NamedTuple):
    """A grid with its margin, M cells in all; what all searches on it have in common.

    Attributes:
        shape: (N_x, N_y) of the grid without its margin.
        columns: Cells of a row with its margin.
        traversable: (M,) cells that may be entered.
        cell_cost: (M,) cost of crossing one.
        may_move: (M,) which of `NEIGHBOURS` may be made from a cell, a bit each.
        moves: (16,) what a move adds to a cell's number.
        costs: (2,) the least and the greatest cost of cells that may be entered; infinite and 0
            without any.
    """

    shape: tuple[int, int]
    columns: int
    traversable: NDArray[np.bool_]
    cell_cost: NDArray[np.float64]
    may_move: NDArray[np.uint16]
    moves: NDArray[np.int64]
    costs: NDArray[np.float64]


class _Buckets(NamedTuple):
    """Cells that wait, by cost; a ring of lists, since no move costs more than it spans.

    Attributes:
        width: Cost that a bucket spans.
        first: (R,) a bucket's first entry, or `NONE`; R is a power of two.
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
        came_by: (M,) the move from the next cell on the way to the seed, or `NO_PARENT`.
        is_settled: (M,) whether that is final.
        is_wanted: (M,) whether the search may end without it.
    """

    cost: NDArray[np.float64]
    came_by: NDArray[np.int8]
    is_settled: NDArray[np.bool_]
    is_wanted: NDArray[np.bool_]


@njit(cache=True)
def ground_of(traversable: NDArray[np.bool_], cell_cost: NDArray[np.float64]) -> Ground:
    """Prepare a grid for searches.

    Args:
        traversable: (N_x, N_y) cells that may be entered.
        cell_cost: (N_x, N_y) positive cost of crossing one cell.
    """
    rows, columns = traversable.shape
    wide = columns + 2 * MARGIN
    may_enter = np.zeros((rows + 2 * MARGIN, wide), np.bool_)
    crossing = np.zeros((rows + 2 * MARGIN, wide))
    may_enter[MARGIN : MARGIN + rows, MARGIN : MARGIN + columns] = traversable
    crossing[MARGIN : MARGIN + rows, MARGIN : MARGIN + columns] = cell_cost
    moves, beside = np.empty(len(NEIGHBOURS), np.int64), np.zeros((len(NEIGHBOURS), 2), np.int64)
    for n in range(len(NEIGHBOURS)):
        di, dj = NEIGHBOURS[n]
        moves[n] = di * wide + dj
        if abs(di) == 2:
            beside[n] = (di // 2 * wide, di // 2 * wide + dj)
        elif abs(dj) == 2:
            beside[n] = (dj // 2, di * wide + dj // 2)
        elif di and dj:
            beside[n] = (di * wide, dj)
    flat = may_enter.ravel()
    may_move = np.zeros(flat.size, np.uint16)
    first, last = MARGIN * (wide + 1), flat.size - MARGIN * (wide + 1)
    for n in range(len(NEIGHBOURS)):
        touched = (moves[n], beside[n, 0], beside[n, 1])
        into, past, by = [flat[first + cell : last + cell] for cell in touched]
        _add_move(may_move[first:last], np.uint16(1 << n), (into, past, by))
    costs = np.array([np.inf, 0.0])
    for i in range(rows):
        for j in range(columns):
            cost = cell_cost[i, j]
            costs[0] = min(costs[0], cost if traversable[i, j] else np.inf)
            costs[1] = max(costs[1], cost if traversable[i, j] else 0.0)
    return Ground((rows, columns), wide, flat, crossing.ravel(), may_move, moves, costs)


@njit(cache=True)
def _add_move(
    may_move: NDArray[np.uint16],
    bit: np.uint16,
    touched: tuple[NDArray[np.bool_], NDArray[np.bool_], NDArray[np.bool_]],
) -> None:
    """Set a move's bit for the cells where all that it touches may be entered."""
    into, past, by = touched
    for cell in range(may_move.size):
        may_move[cell] |= bit * np.uint16(into[cell] & past[cell] & by[cell])


@njit(cache=True)
def _buckets(ground: Ground) -> _Buckets:
    cheapest, dearest = ground.costs
    # A little less than the cheapest move, so that rounding leads to no bucket that has been left.
    width = 0.999 * cheapest if cheapest < np.inf else 1.0
    ring = 4
    while ring < LENGTHS.max() * dearest / width + 3.0:
        ring *= 2
    # Every move may find a cheaper way.
    entries = len(NEIGHBOURS) * ground.traversable.size
    cells = np.empty(entries, np.int32)
    return _Buckets(width, np.full(ring, NONE, np.int32), cells, np.empty(entries, np.int32))


@njit(cache=True)
def _new_search(cells: int) -> _Search:
    return _Search(
        np.full(cells, np.inf),
        np.full(cells, NO_PARENT, np.int8),
        np.zeros(cells, np.bool_),
        np.zeros(cells, np.bool_),
    )


@njit(cache=True)
def shortest_paths(
    ground: Ground, seeds: NDArray[np.int64], until: tuple[NDArray[np.int64], float]
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Cost from every cell to the nearest seed.

    A move costs its length in cells times the mean cost of its two ends. Of equally cheap ways that
    over the cheaper neighbour is taken, then that over the one of lower index, so the result does
    not depend on the order of the seeds.

    Args:
        ground: Where.
        seeds: (S, 2) indices inside the grid; those not traversable are ignored.
        until: (W, 2) indices inside the grid, and a margin in units of cost. The search ends when
            all of these cells and what costs up to the margin more are settled; the rest keeps an
            infinite cost. With no cell, or one that no way leads to, everything is searched.

    Returns:
        (N_x, N_y) costs, infinite without a way, and (N_x, N_y) parents: the flat index of the next
        cell on the way to the seed.
    """
    search, buckets = _new_search(ground.traversable.size), _buckets(ground)
    limit, _ = _spread(ground, search, buckets, (seeds, until), _anywhere())
    rows, columns = ground.shape
    cost = np.full((rows, columns), np.inf)
    parent = np.full((rows, columns), NO_PARENT, np.int64)
    back = NEIGHBOURS[:, 0] * columns + NEIGHBOURS[:, 1]
    for i in range(rows):
        for j in range(columns):
            cell = (i + MARGIN) * ground.columns + j + MARGIN
            if search.cost[cell] > limit:
                continue
            cost[i, j] = search.cost[cell]
            move = search.came_by[cell]
            if move != NO_PARENT:
                parent[i, j] = i * columns + j - back[move]
    return cost, parent


class _Bounds(NamedTuple):
    """What a search knows of ways to the W cells that it wants.

    Attributes:
        within: (W,) beyond which cost a cell is out of reach; empty where all ways matter.
        cell_costs: (M,) of the ways from some one place to every cell, infinite without one.
        wanted_costs: (W,) of those to the wanted cells.
    """

    within: NDArray[np.float64]
    cell_costs: NDArray[np.float64]
    wanted_costs: NDArray[np.float64]


@njit(cache=True)
def _anywhere() -> _Bounds:
    nothing = np.empty(0)
    return _Bounds(nothing, nothing, nothing)


@njit(cache=True)
def costs_between(
    ground: Ground,
    cells: NDArray[np.int64],
    within: NDArray[np.float64],
    known: NDArray[np.float64],
) -> NDArray[np.float64]:
    """(N, N) costs between (N, 2) cells inside the grid; infinite without a way, or beyond a cost.

    Costs are those of `shortest_paths`. Both directions cost the same, so that every search looks
    for the cells before its own alone, and all share their memory. A search goes on only from cells
    that may lie on a way that is cheap enough.

    Args:
        ground: Where.
        cells: One or more.
        within: (N, N) symmetric; for each pair beyond which cost it does not matter.
        known: (N_x, N_y) costs from some place to every cell, as of `shortest_paths`: a way costs
            no less than those to its two ends differ.
    """
    between = np.full((len(cells), len(cells)), np.inf)
    search, buckets = _new_search(ground.traversable.size), _buckets(ground)
    places = (cells[:, 0] + MARGIN) * ground.columns + cells[:, 1] + MARGIN
    wide = np.full((known.shape[0] + 2 * MARGIN, ground.columns), np.inf)
    wide[MARGIN:-MARGIN, MARGIN:-MARGIN] = known
    cell_costs = wide.ravel()
    for k in range(len(cells)):
        between[k, k] = 0.0 if ground.traversable[places[k]] else np.inf
        if k == 0:
            continue
        bounds = _Bounds(within[k, :k], cell_costs, cell_costs[places[:k]])
        ends = (cells[k : k + 1], (cells[:k], 0.0))
        limit, entries = _spread(ground, search, buckets, ends, bounds)
        for other in range(k):
            place = places[other]
            if search.cost[place] <= min(limit, within[k, other]):
                between[k, other] = between[other, k] = search.cost[place]
            search.is_wanted[place] = False
        for entry in range(entries):
            search.cost[buckets.cells[entry]] = np.inf
            search.is_settled[buckets.cells[entry]] = False
        buckets.first[:] = NONE
    return between


@njit(cache=True, error_model="numpy")
def _spread(
    ground: Ground,
    search: _Search,
    buckets: _Buckets,
    ends: tuple[NDArray[np.int64], tuple[NDArray[np.int64], float]],
    bounds: _Bounds,
) -> tuple[float, int]:
    """Settle cells in the order of their costs.

    Args:
        ground: Where.
        search: In the making.
        buckets: Empty.
        ends: Seeds and `until`, as of `shortest_paths`.
        bounds: Of the ways to the cells of `until`.

    Returns:
        The cost up to which they are settled, and the number of entries made.
    """
    cost, is_settled, is_wanted = search.cost, search.is_settled, search.is_wanted
    width, first, cells, after = buckets
    seeds, (wanted, margin) = ends
    in_ring = first.size - 1
    entries = 0
    for k in range(len(seeds)):
        cell = (seeds[k, 0] + MARGIN) * ground.columns + seeds[k, 1] + MARGIN
        if ground.traversable[cell] and cost[cell] > 0.0:
            cost[cell], search.came_by[cell] = 0.0, NO_PARENT
            cells[entries], after[entries], first[0] = cell, first[0], entries
            entries += 1
    waiting = entries
    missing = 0
    for k in range(len(wanted)):
        cell = (wanted[k, 0] + MARGIN) * ground.columns + wanted[k, 1] + MARGIN
        missing += int(not is_wanted[cell])
        is_wanted[cell] = True
    farthest, bucket = 0.0, 0
    is_bounded = bounds.within.size > 0
    farthest_within = bounds.within.max() if is_bounded else np.inf
    limit = farthest_within
    while waiting > 0 and bucket * width <= limit:
        entry = first[bucket & in_ring]
        if entry == NONE:
            bucket += 1
            continue
        first[bucket & in_ring] = after[entry]
        cell = cells[entry]
        if is_settled[cell]:
            continue
        is_settled[cell] = True
        waiting -= 1
        if not is_bounded or _may_lead_on(ground, (cell, cost[cell]), wanted, bounds, width):
            new, entries = _pass_on(ground, search, buckets, cell, entries)
            waiting += new
        if is_wanted[cell]:
            farthest = max(farthest, cost[cell])
            missing -= 1
            if missing == 0:
                limit = min(farthest_within, farthest + margin)
    return limit, entries


@njit(cache=True, error_model="numpy")
def _may_lead_on(
    ground: Ground,
    reached: tuple[int, float],
    wanted: NDArray[np.int64],
    bounds: _Bounds,
    width: float,
) -> bool:
    """Whether a cell, reached at a cost, may lie on a way to a wanted cell that is within reach.

    No way is shorter than the straight line, or cheaper than over the cheapest cells; and none is
    cheaper than the difference of what the ways to its ends cost from anywhere.
    """
    cell, cost = reached
    row = np.uint32(cell) // np.uint32(ground.columns)
    i, j = int(row) - MARGIN, cell - int(row) * ground.columns - MARGIN
    known = bounds.cell_costs[cell]
    slack = SLACK * (1.0 + known)
    for k in range(len(wanted)):
        left = bounds.within[k] - cost
        if left < 0.0 or abs(known - bounds.wanted_costs[k]) > left + slack:
            continue
        away_i, away_j, cells_left = wanted[k, 0] - i, wanted[k, 1] - j, left / width
        if away_i * away_i + away_j * away_j <= cells_left * cells_left:
            return True
    return False


@njit(cache=True, error_model="numpy", inline="always")
def _pass_on(
    ground: Ground, search: _Search, buckets: _Buckets, cell: int, entries: int
) -> tuple[int, int]:
    """Offer the ways over a settled cell to its neighbours.

    What is settled already is nearer than any such way, and so refuses it.

    Returns:
        How many had none before, and the number of entries now.
    """
    _, _, _, cell_cost, may_move, moves, _ = ground
    cost, came_by = search.cost, search.came_by
    width, first, cells, after = buckets
    settled, here, per_width = cost[cell], cell_cost[cell], 1.0 / width
    here_at, in_ring = np.uint64(cell), np.uint32(first.size - 1)
    welcome = np.uint32(0)
    for n in range(len(NEIGHBOURS)):
        other = here_at + np.uint64(moves[n])
        candidate = settled + HALF_LENGTHS[n] * (here + cell_cost[other])
        welcome |= np.uint32(candidate <= cost[other]) << np.uint32(n)
    welcome &= np.uint32(may_move[cell])
    new = 0
    while welcome:
        lowest = welcome & (~welcome + np.uint32(1))
        welcome ^= lowest
        n = BIT_OF[((lowest * DE_BRUIJN) >> np.uint32(12)) & np.uint32(15)]
        other = here_at + np.uint64(moves[n])
        known = cost[other]
        candidate = settled + HALF_LENGTHS[n] * (here + cell_cost[other])
        if candidate < known:
            new += int(known == np.inf)
            cost[other], came_by[other] = candidate, n
            bucket = np.uint32(candidate * per_width) & in_ring
            cells[entries], after[entries], first[bucket] = other, first[bucket], entries
            entries += 1
        else:
            rival = int(other) - moves[came_by[other]]
            if settled < cost[rival] or (settled == cost[rival] and cell < rival):
                came_by[other] = n
    return new, entries
