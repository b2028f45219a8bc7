"""The grid G of one floor, kept up to date cell by cell (Section III-C)."""

from __future__ import annotations

from typing import TypeVar

import numpy as np
from numba import njit
from numpy.typing import NDArray

from toponav.mapping.view import FREE, OCCUPIED, UNKNOWN, OccupancyGrid

Scalar = TypeVar("Scalar", bound=np.generic)

GROWTH_CELLS = 64
"""Margin by which the storage outgrows its contents, so that it is seldom copied."""

Box = tuple[int, int, int, int]
"""(i_first, j_first, i_end, j_end) in storage cells, ends exclusive."""

EMPTY_BOX: Box = (0, 0, 0, 0)


class FloorGrid:
    """Counts the navigable and obstacle voxels over each cell, and says which box has changed.

    Cells are addressed by world index: cell (i, j) covers x in [i, i + 1) r_g. The storage covers
    a growing window of them.
    """

    def __init__(self, resolution: float, min_obstacle_voxels: int) -> None:
        """Create an empty grid.

        Args:
            resolution: r_g, metres.
            min_obstacle_voxels: Voxels of M_obs that make a cell an obstacle; the paper's is 1.
        """
        self.resolution = resolution
        self._min_obstacle_voxels = min_obstacle_voxels
        self._first = (0, 0)
        self._navigable = np.zeros((0, 0), np.int32)
        self._obstacles = np.zeros((0, 0), np.int32)
        self._cells = np.full((0, 0), UNKNOWN, np.int8)
        self._known = EMPTY_BOX
        self._changed = EMPTY_BOX

    @property
    def cells(self) -> NDArray[np.int8]:
        """The whole storage of G, live; UNKNOWN beyond what was observed."""
        return self._cells

    @property
    def first(self) -> tuple[int, int]:
        """World index of the storage's cell (0, 0)."""
        return self._first

    @property
    def known(self) -> Box:
        """Tightest box, in storage cells, that ever held a voxel."""
        return self._known

    @property
    def nbytes(self) -> int:
        """Memory held, bytes."""
        return self._navigable.nbytes + self._obstacles.nbytes + self._cells.nbytes

    def change(self, cells: NDArray[np.int64], navigable: int, obstacles: int) -> None:
        """Add voxels over cells, or take them away.

        Args:
            cells: (N, 2) world indices; a cell may occur several times.
            navigable: +1, 0 or -1 navigable voxels over each.
            obstacles: +1, 0 or -1 obstacle voxels over each.
        """
        if not len(cells):
            return
        low, high = cells.min(axis=0), cells.max(axis=0)
        self._cover(low, high)
        local = cells - np.asarray(self._first)
        i, j = low - self._first
        i_last, j_last = high - self._first
        box = (int(i), int(j), int(i_last) + 1, int(j_last) + 1)
        _change_counts(self._navigable, self._obstacles, local, navigable, obstacles)
        _classify_box(self._cells, self._navigable, self._obstacles, box, self._min_obstacle_voxels)
        self._known = union(self._known, box)
        self._changed = union(self._changed, box)

    def take_changes(self) -> Box:
        """The box of cells changed since the last call, in storage cells."""
        changed, self._changed = self._changed, EMPTY_BOX
        return changed

    def snapshot(self) -> OccupancyGrid:
        """G over the observed extent: N_x by N_y cells from (x_min, y_min)."""
        i, j, i_end, j_end = self._known
        cells = self._cells[i:i_end, j:j_end].copy()
        cells.setflags(write=False)
        origin = ((self._first[0] + i) * self.resolution, (self._first[1] + j) * self.resolution)
        return OccupancyGrid(cells, origin, self.resolution)

    def _cover(self, low: NDArray[np.int64], high: NDArray[np.int64]) -> None:
        """Grow the storage until it holds world cells `low` to `high`, inclusive."""
        first = np.asarray(self._first, np.int64)
        end = first + self._cells.shape
        if self._cells.size and (low >= first).all() and (high < end).all():
            return
        if not self._cells.size:
            first, end = low, low
        new_first = np.where(low < first, low - GROWTH_CELLS, first)
        new_end = np.where(high >= end, high + 1 + GROWTH_CELLS, end)
        shape = tuple(int(n) for n in new_end - new_first)
        shift = (int(first[0] - new_first[0]), int(first[1] - new_first[1]))
        self._navigable = embedded(self._navigable, shape, shift)
        self._obstacles = embedded(self._obstacles, shape, shift)
        self._cells = embedded(self._cells, shape, shift)
        self._first = (int(new_first[0]), int(new_first[1]))
        self._known = _shifted(self._known, shift)
        self._changed = _shifted(self._changed, shift)


def union(a: Box, b: Box) -> Box:
    """The smallest box that holds two; an empty one holds nothing."""
    if EMPTY_BOX in (a, b):
        return b if a == EMPTY_BOX else a
    return (min(a[0], b[0]), min(a[1], b[1]), max(a[2], b[2]), max(a[3], b[3]))


def embedded(
    array: NDArray[Scalar], shape: tuple[int, ...], shift: tuple[int, int]
) -> NDArray[Scalar]:
    """A zeroed array of `shape` that holds `array` from cell `shift` on."""
    larger = np.zeros(shape, array.dtype)
    larger[shift[0] : shift[0] + array.shape[0], shift[1] : shift[1] + array.shape[1]] = array
    return larger


def _shifted(box: Box, shift: tuple[int, int]) -> Box:
    if box == EMPTY_BOX:
        return box
    return (box[0] + shift[0], box[1] + shift[1], box[2] + shift[0], box[3] + shift[1])


@njit(cache=True)
def _change_counts(
    navigable_counts: NDArray[np.int32],
    obstacle_counts: NDArray[np.int32],
    cells: NDArray[np.int64],
    navigable: int,
    obstacles: int,
) -> None:
    for row in range(cells.shape[0]):
        i, j = cells[row, 0], cells[row, 1]
        navigable_counts[i, j] += navigable
        obstacle_counts[i, j] += obstacles


@njit(cache=True)
def _classify_box(
    cells: NDArray[np.int8],
    navigable_counts: NDArray[np.int32],
    obstacle_counts: NDArray[np.int32],
    box: Box,
    min_obstacle_voxels: int,
) -> None:
    """G(i, j) of Section III-C; where both M_nav and M_obs project, the obstacle wins."""
    for i in range(box[0], box[2]):
        for j in range(box[1], box[3]):
            if obstacle_counts[i, j] >= min_obstacle_voxels:
                cells[i, j] = OCCUPIED
            elif navigable_counts[i, j] > 0:
                cells[i, j] = FREE
            else:
                cells[i, j] = UNKNOWN
