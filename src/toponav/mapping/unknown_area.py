"""How much there is to see beyond a frontier."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from toponav.mapping.view import UNKNOWN, OccupancyGrid


def unknown_area_m2(grid: OccupancyGrid, cells: NDArray[np.int64], reach_m: float) -> float:
    """Area of unknown floor that can be reached from some cells through unknown cells alone.

    What lies beyond the edge of the grid is unknown, too.

    Args:
        grid: The map.
        cells: (N, 2) indices, N >= 1, of cells in the grid.
        reach_m: Unknown cells farther than this from the cells, over unknown cells, do not count.
    """
    pad = int(np.ceil(reach_m / grid.resolution)) + 1
    low, high = cells.min(axis=0) - pad, cells.max(axis=0) + pad + 1
    window = np.full(tuple(high - low), UNKNOWN, np.int8)
    inner_low = np.maximum(low, 0)
    inner_high = np.minimum(high, grid.cells.shape)
    target = tuple(slice(a, b) for a, b in zip(inner_low - low, inner_high - low, strict=True))
    source = tuple(slice(a, b) for a, b in zip(inner_low, inner_high, strict=True))
    window[target] = grid.cells[source]
    steps = int(reach_m / grid.resolution)
    count = _flooded(window == UNKNOWN, (cells - low).astype(np.int64), steps)
    return count * grid.resolution**2


@njit(cache=True)
def _flooded(unknown: NDArray[np.bool_], seeds: NDArray[np.int64], steps: int) -> int:
    """Cells reached from the seeds in so many 4-connected steps over unknown cells."""
    rows, columns = unknown.shape
    seen = np.zeros(unknown.shape, np.bool_)
    queue = np.empty((rows * columns, 3), np.int64)
    head, tail, count = 0, 0, 0
    for k in range(len(seeds)):
        i, j = seeds[k]
        if not seen[i, j]:
            seen[i, j] = True
            queue[tail] = (i, j, 0)
            tail += 1
    while head < tail:
        i, j, step = queue[head]
        head += 1
        if step == steps:
            continue
        for side in range(4):
            a = i + (1 if side == 0 else -1 if side == 1 else 0)
            b = j + (1 if side == 2 else -1 if side == 3 else 0)
            if 0 <= a < rows and 0 <= b < columns and unknown[a, b] and not seen[a, b]:
                seen[a, b] = True
                count += 1
                queue[tail] = (a, b, step + 1)
                tail += 1
    return count
