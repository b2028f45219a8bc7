"""Dijkstra's algorithm on a grid of 16 neighbours: costs to the nearest seed, and the way there."""

from __future__ import annotations

import heapq

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


@njit(cache=True)
def shortest_paths(
    traversable: NDArray[np.bool_], cell_cost: NDArray[np.float64], seeds: NDArray[np.int64]
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Cost from every cell to the nearest seed.

    A move costs its length in cells times the mean cost of its two ends. Cells of equal cost are
    settled in the order of their index, so the result does not depend on that of the seeds.

    Args:
        traversable: (N_x, N_y) cells that may be entered.
        cell_cost: (N_x, N_y) positive cost of crossing one cell.
        seeds: (S, 2) indices inside the grid; those not traversable are ignored.

    Returns:
        (N_x, N_y) costs, infinite without a way, and (N_x, N_y) parents: the flat index of the next
        cell on the way to the seed.
    """
    rows, columns = traversable.shape
    cost = np.full((rows, columns), np.inf)
    parent = np.full((rows, columns), NO_PARENT, dtype=np.int64)
    heap = [(0.0, 0)]
    heap.pop()  # tells numba the type of an empty heap
    for k in range(len(seeds)):
        i, j = seeds[k]
        if traversable[i, j] and cost[i, j] > 0.0:
            cost[i, j] = 0.0
            heapq.heappush(heap, (0.0, i * columns + j))
    while heap:
        settled, cell = heapq.heappop(heap)
        i, j = cell // columns, cell % columns
        if settled > cost[i, j]:
            continue
        for n in range(len(NEIGHBOURS)):
            di, dj = NEIGHBOURS[n]
            a, b = i + di, j + dj
            if a < 0 or b < 0 or a >= rows or b >= columns or not traversable[a, b]:
                continue
            if n >= STRAIGHT_MOVES and not passable(traversable, i, j, di, dj):
                continue
            length = np.sqrt(float(di * di + dj * dj))
            candidate = settled + length * 0.5 * (cell_cost[i, j] + cell_cost[a, b])
            if candidate < cost[a, b]:
                cost[a, b] = candidate
                parent[a, b] = cell
                heapq.heappush(heap, (candidate, a * columns + b))
    return cost, parent
