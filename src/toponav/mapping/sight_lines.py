"""Straight lines over the grid, many at once: which of them lead through marked cells."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from toponav.mapping.view import OccupancyGrid


def lines_through(
    marked: NDArray[np.bool_],
    starts: NDArray[np.floating],
    ends: NDArray[np.floating],
    grid: OccupancyGrid,
) -> NDArray[np.bool_]:
    """(N,) which lines lead through a marked cell, looked at every half cell.

    Args:
        marked: (N_x, N_y) cells of the grid; beyond it nothing is marked.
        starts: (N, 2) or (2,) world frame, metres.
        ends: (N, 2) or (2,) likewise.
        grid: Where the cells lie.
    """
    line = np.atleast_2d(ends - starts)
    longest = np.hypot(line[:, 0], line[:, 1]).max(initial=0.0)
    samples = 2 + math.ceil(longest / (0.5 * grid.resolution))
    share = np.linspace(0.0, 1.0, samples)[:, None, None]
    cells = grid.index_of(starts + share * line)
    inside = grid.contains(cells)
    i, j = np.moveaxis(np.where(inside[..., None], cells, 0), -1, 0)
    return np.asarray((inside & marked[i, j]).any(axis=0))
