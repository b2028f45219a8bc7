"""The grid G of one floor, kept up to date voxel by voxel (Section III-C)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from toponav.mapping.view import FREE, OCCUPIED, OccupancyGrid

GROWTH_CELLS = 64
"""The grid grows by at least this much at a side: 6.4 m at 10 cm."""


class OccupancyCounts:
    """Counts the voxels of M_nav and M_obs in every cell.

    A cell holds `cell_voxels` voxels a side, so that every voxel lies in exactly one cell:
    phi(p) of any of its points.
    """

    def __init__(self, resolution: float, cell_voxels: int, min_obstacle_voxels: int) -> None:
        """Start empty; `resolution` is r_g in metres."""
        self._resolution = resolution
        self._cell_voxels = cell_voxels
        self._min_obstacle_voxels = min_obstacle_voxels
        self._low = np.zeros(2, np.int64)
        self._navigable = np.zeros((0, 0), np.int32)
        self._obstacles = np.zeros((0, 0), np.int32)
        self._cells = np.zeros((0, 0), np.int8)

    def add(self, navigable: NDArray[np.int32], obstacles: NDArray[np.int32]) -> bool:
        """Count new voxels, (N, 3) and (M, 3) voxel coordinates; says whether any cell changed."""
        nav = np.floor_divide(navigable[:, :2], self._cell_voxels).astype(np.int64)
        obs = np.floor_divide(obstacles[:, :2], self._cell_voxels).astype(np.int64)
        new = np.concatenate([nav, obs])
        if not len(new):
            return False
        self._make_room(new.min(axis=0), new.max(axis=0))
        np.add.at(self._navigable, tuple((nav - self._low).T), 1)
        np.add.at(self._obstacles, tuple((obs - self._low).T), 1)
        i, j = (new - self._low).T
        before = self._cells[i, j]
        after = np.where(self._navigable[i, j] > 0, FREE, before)
        after = np.where(self._obstacles[i, j] >= self._min_obstacle_voxels, OCCUPIED, after)
        self._cells[i, j] = after
        return bool(np.any(after != before))

    def grid(self) -> OccupancyGrid:
        """G as it is now, copied."""
        x, y = (float(v) for v in self._low * self._resolution)
        return OccupancyGrid(self._cells.copy(), (x, y), self._resolution)

    def _make_room(self, low: NDArray[np.int64], high: NDArray[np.int64]) -> None:
        """Grow the arrays so that cells `low` to `high` lie inside."""
        if not self._cells.size:
            self._low = low - GROWTH_CELLS
            self._resize(self._low, high + GROWTH_CELLS)
            return
        end = self._low + self._cells.shape
        if (low >= self._low).all() and (high < end).all():
            return
        new_low = np.where(low < self._low, low - GROWTH_CELLS, self._low)
        new_high = np.where(high >= end, high + GROWTH_CELLS, end - 1)
        self._resize(new_low, new_high)

    def _resize(self, low: NDArray[np.int64], high: NDArray[np.int64]) -> None:
        shape = tuple(int(n) for n in high - low + 1)
        i, j = (int(n) for n in self._low - low)
        old_shape = self._cells.shape
        for name in ("_navigable", "_obstacles", "_cells"):
            old = getattr(self, name)
            new = np.zeros(shape, old.dtype)
            new[i : i + old_shape[0], j : j + old_shape[1]] = old
            setattr(self, name, new)
        self._low = low
