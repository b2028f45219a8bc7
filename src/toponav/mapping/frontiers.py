"""M_fro: where known free space borders on the unknown (Section III-C; Yamauchi 1997).

A frontier cell is a free cell with an unknown 4-neighbour that keeps clear of obstacles; frontier
cells that are 8-connected form a frontier, and frontiers of few cells are noise.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from toponav.mapping.occupancy import EMPTY_BOX, Box, FloorGrid, embedded
from toponav.mapping.view import FREE, OCCUPIED, UNKNOWN


class FrontierMap:
    """The frontiers of one floor, searched only where its grid has changed."""

    def __init__(self, grid: FloorGrid, clearance_cells: int, min_cells: int) -> None:
        """Watch a grid.

        Args:
            grid: G of a floor.
            clearance_cells: Cells around a frontier cell, diagonals included, without an obstacle.
            min_cells: Frontiers of fewer cells are dropped.
        """
        self._grid = grid
        self._min_cells = min_cells
        self._clearance = clearance_cells
        self._first = grid.first
        self._mask = np.zeros(grid.cells.shape, np.bool_)
        self._rows = np.zeros(grid.cells.shape, np.int32)

    @property
    def nbytes(self) -> int:
        """Memory held, bytes."""
        return self._mask.nbytes + self._rows.nbytes

    def find(self) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
        """The frontiers now.

        Returns:
            (N, 2) centres of the frontier cells in metres, in raster order, and (N,) the frontier
            that each belongs to, 0-based in the order of their first cells. The paper's formula
            names the cell's corner; the centre is where the free space is.
        """
        grid = self._grid
        self._follow_storage()
        changed = grid.take_changes()
        if changed != EMPTY_BOX:
            box = _dilated(changed, max(1, self._clearance))
            mark_frontiers(grid.cells, self._mask, self._clearance, box)
        i, j, i_end, j_end = grid.known
        cells = np.argwhere(self._mask[i:i_end, j:j_end])
        labels = _label(cells, self._min_cells, self._rows[i:i_end, j:j_end])
        kept = labels >= 0
        world = cells[kept] + np.asarray(grid.first) + (i, j)
        return (world + 0.5) * grid.resolution, labels[kept]

    def _follow_storage(self) -> None:
        """Grow the mask as the grid's storage has grown."""
        grid = self._grid
        if grid.cells.shape != self._mask.shape:
            shift = (self._first[0] - grid.first[0], self._first[1] - grid.first[1])
            shift = shift if self._mask.size else (0, 0)
            self._mask = embedded(self._mask, grid.cells.shape, shift)
            self._rows = np.zeros(grid.cells.shape, np.int32)
        self._first = grid.first


def _dilated(box: Box, cells: int) -> Box:
    return (box[0] - cells, box[1] - cells, box[2] + cells, box[3] + cells)


@njit(cache=True)
def mark_frontiers(
    cells: NDArray[np.int8], mask: NDArray[np.bool_], clearance: int, box: Box
) -> None:
    """Recompute `mask` in a box, cut to the grid; beyond the grid all is unknown."""
    rows, columns = cells.shape
    for i in range(max(0, box[0]), min(rows, box[2])):
        for j in range(max(0, box[1]), min(columns, box[3])):
            mask[i, j] = cells[i, j] == FREE and (
                i == 0
                or cells[i - 1, j] == UNKNOWN
                or i == rows - 1
                or cells[i + 1, j] == UNKNOWN
                or j == 0
                or cells[i, j - 1] == UNKNOWN
                or j == columns - 1
                or cells[i, j + 1] == UNKNOWN
            )
            if mask[i, j]:
                for a in range(max(0, i - clearance), min(rows, i + clearance + 1)):
                    for b in range(max(0, j - clearance), min(columns, j + clearance + 1)):
                        if cells[a, b] == OCCUPIED:
                            mask[i, j] = False


def label_clusters(
    mask: NDArray[np.bool_], cells: NDArray[np.int64], min_cells: int
) -> NDArray[np.int64]:
    """Cluster of each marked cell: 8-connected, numbered in the order of `cells`.

    Args:
        mask: (N_x, N_y) marked cells.
        cells: (N, 2) their indices.
        min_cells: Cells of smaller clusters get -1.
    """
    labels: NDArray[np.int64] = _label(cells, min_cells, np.zeros(mask.shape, np.int32))
    return labels


@njit(cache=True)
def _label(
    cells: NDArray[np.int64], min_cells: int, row_of: NDArray[np.int32]
) -> NDArray[np.int64]:
    """As `label_clusters`; (N_x, N_y) `row_of` is all zeros before and afterwards.

    To fill the room for so many numbers would cost more than all the rest.
    """
    for row in range(len(cells)):
        row_of[cells[row, 0], cells[row, 1]] = row + 1
    labels = np.full(len(cells), -1, np.int64)
    reached = np.zeros(len(cells), np.bool_)
    queue = np.empty(len(cells), np.int64)
    clusters = 0
    for seed in range(len(cells)):
        if reached[seed]:
            continue
        reached[seed] = True
        queue[0], head, tail = seed, 0, 1
        while head < tail:
            i, j = cells[queue[head], 0], cells[queue[head], 1]
            head += 1
            for a in range(max(0, i - 1), min(row_of.shape[0], i + 2)):
                for b in range(max(0, j - 1), min(row_of.shape[1], j + 2)):
                    row = row_of[a, b] - 1
                    if row >= 0 and not reached[row]:
                        reached[row] = True
                        queue[tail] = row
                        tail += 1
        if tail >= min_cells:
            for position in range(tail):
                labels[queue[position]] = clusters
            clusters += 1
    for row in range(len(cells)):
        row_of[cells[row, 0], cells[row, 1]] = 0
    return labels
