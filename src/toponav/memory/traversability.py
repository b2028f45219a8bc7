"""Whether the straight line L(n_i, n_j) between two nodes is free of obstacles (Section III-D)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from toponav.mapping.view import DROP, OCCUPIED, OccupancyGrid


def cells_on_segment(
    grid: OccupancyGrid, start: tuple[float, float], end: tuple[float, float]
) -> NDArray[np.int64]:
    """(N, 2) cell indices of the supercover of a segment, in and outside the grid.

    The segment is cut where it meets the grid's lines; each piece lies in one cell. Where it
    leaves a cell exactly through a corner, both cells beside that corner count, so that a
    diagonal wall one cell thick cannot be crossed.
    """
    a = (np.asarray(start, np.float64) - grid.origin) / grid.resolution
    b = (np.asarray(end, np.float64) - grid.origin) / grid.resolution
    cuts = [np.array([0.0, 1.0])]
    for axis in range(2):
        low, high = sorted((a[axis], b[axis]))
        lines = np.arange(np.floor(low) + 1.0, np.ceil(high))
        if lines.size:
            cuts.append((lines - a[axis]) / (b[axis] - a[axis]))
    t = np.unique(np.clip(np.concatenate(cuts), 0.0, 1.0))
    middle = (t[:-1] + t[1:]) / 2.0
    pieces = np.floor(a + middle[:, None] * (b - a)).astype(np.int64)
    before, after = pieces[:-1], pieces[1:]
    corner = np.all(before != after, axis=1)
    beside = [
        np.column_stack([before[corner, 0], after[corner, 1]]),
        np.column_stack([after[corner, 0], before[corner, 1]]),
    ]
    ends = np.floor(np.stack([a, b])).astype(np.int64)
    return np.unique(np.concatenate([ends, pieces, *beside]), axis=0)


def is_clear(grid: OccupancyGrid, start: tuple[float, float], end: tuple[float, float]) -> bool:
    """Whether no cell of the segment's supercover is OCCUPIED or a DROP.

    G(i, j) = -1 exactly where a point of M_obs projects into the cell, so this is the paper's
    condition with a line as wide as a cell. Unknown cells and those outside G hold no obstacle
    point and do not block.
    """
    cells = cells_on_segment(grid, start, end)
    cells = cells[grid.contains(cells)]
    return not bool(np.isin(grid.cells[cells[:, 0], cells[:, 1]], (OCCUPIED, DROP)).any())
