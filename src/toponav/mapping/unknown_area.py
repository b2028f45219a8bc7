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
    steps = int(reach_m / grid.resolution)
    count = _flooded(grid.cells, cells.astype(np.int64), steps)
    return count * grid.resolution**2


@njit(cache=True)
def _flooded(cells: NDArray[np.int8], seeds: NDArray[np.int64], steps: int) -> int:
    """Cells reached from the seeds in so many 4-connected steps over unknown cells."""
    low_i, low_j = seeds[:, 0].min() - steps, seeds[:, 1].min() - steps
    rows = seeds[:, 0].max() + steps + 1 - low_i
    columns = seeds[:, 1].max() + steps + 1 - low_j
    seen = np.zeros((rows, columns), np.bool_)
    queue = np.empty((rows * columns, 2), np.int32)
    tail = 0
    for k in range(len(seeds)):
        i, j = seeds[k, 0] - low_i, seeds[k, 1] - low_j
        if not seen[i, j]:
            seen[i, j] = True
            queue[tail, 0], queue[tail, 1] = i, j
            tail += 1
    head, known = 0, tail
    for _ in range(steps):
        end = tail
        while head < end:
            i, j = queue[head, 0], queue[head, 1]
            head += 1
            for side in range(4):
                a = i + (1 if side == 0 else -1 if side == 1 else 0)
                b = j + (1 if side == 2 else -1 if side == 3 else 0)
                if seen[a, b]:
                    continue
                x, y = a + low_i, b + low_j
                inside = 0 <= x < cells.shape[0] and 0 <= y < cells.shape[1]
                if inside and cells[x, y] != UNKNOWN:
                    continue
                seen[a, b] = True
                queue[tail, 0], queue[tail, 1] = a, b
                tail += 1
    return tail - known
