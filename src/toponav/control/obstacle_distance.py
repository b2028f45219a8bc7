"""How far every cell of a grid is from the nearest obstacle, exactly, in two passes.

Meijster, Roerdink, Hesselink: "A general algorithm for computing distance transforms in linear
time" (2000): first along the columns, then the lower envelope of parabolas along the rows.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray


@njit(cache=True)
def obstacle_distance(occupied: NDArray[np.bool_]) -> NDArray[np.float64]:
    """(N_x, N_y) distances between centres of cells, in cells; infinite without any obstacle."""
    rows, columns = occupied.shape
    far = rows + columns
    along = np.empty((rows, columns), np.int32)
    above = np.full(columns, far, np.int32)
    for i in range(rows):
        for j in range(columns):
            above[j] = 0 if occupied[i, j] else min(far, above[j] + 1)
            along[i, j] = above[j]
    for i in range(rows - 2, -1, -1):
        for j in range(columns):
            along[i, j] = min(along[i, j], along[i + 1, j] + 1)
    distance = np.empty((rows, columns))
    apex, start = np.empty(columns, np.int64), np.empty(columns, np.int64)
    for i in range(rows):
        _envelope(along[i], (apex, start), far, distance[i])
    return distance


@njit(cache=True)
def _envelope(
    along: NDArray[np.int32],
    room: tuple[NDArray[np.int64], NDArray[np.int64]],
    far: int,
    distance: NDArray[np.float64],
) -> None:
    """A row's distances from those along its columns; `far` stands for none."""
    apex, start = room
    last = -1
    for j in range(along.size):
        height = int(along[j])
        if height >= far:
            continue
        begins = 0
        while last >= 0:
            other = apex[last]
            above = (j * j - other * other) + (height * height - int(along[other]) ** 2)
            begins = above // (2 * (j - other)) + 1  # from here on this one is nearer
            if begins > start[last]:
                break
            last -= 1
        if last < 0:
            begins = 0
        if begins < along.size:
            last += 1
            apex[last], start[last] = j, begins
    if last < 0:
        distance[:] = np.inf
        return
    for j in range(along.size - 1, -1, -1):
        while start[last] > j:
            last -= 1
        across, height = j - apex[last], int(along[apex[last]])
        distance[j] = np.sqrt(float(across * across + height * height))
