"""M_fro: the border between free and unknown space (Yamauchi 1997; Section III-C)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from toponav.mapping.view import FREE, OCCUPIED, UNKNOWN, OccupancyGrid

EIGHT_CONNECTED = np.ones((3, 3), dtype=np.bool_)


def frontier_cells(
    grid: OccupancyGrid, min_cells: int, clearance_cells: int
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Free cells beside unknown ones, clear of obstacles, in clusters of some size.

    Args:
        grid: G.
        min_cells: Smaller 8-connected clusters are dropped.
        clearance_cells: Cells with an obstacle within this Chebyshev distance are no frontier
            ("safe clearance from obstacles"), 0 for no clearance.

    Returns:
        (F, 2) cell indices ordered by cluster, then row by row, and their (F,) cluster labels.
        Clusters are numbered from 0 in the order of their first cell.
    """
    unknown = grid.cells == UNKNOWN
    beside_unknown = np.zeros_like(unknown)
    beside_unknown[1:] |= unknown[:-1]
    beside_unknown[:-1] |= unknown[1:]
    beside_unknown[:, 1:] |= unknown[:, :-1]
    beside_unknown[:, :-1] |= unknown[:, 1:]
    candidates = (grid.cells == FREE) & beside_unknown
    if clearance_cells:
        occupied = grid.cells == OCCUPIED
        size = 2 * clearance_cells + 1
        candidates &= ~ndimage.maximum_filter(occupied, size=size, mode="constant")
    labels, count = ndimage.label(candidates, structure=EIGHT_CONNECTED)
    sizes = np.bincount(labels.ravel(), minlength=count + 1)
    keep = sizes >= min_cells
    keep[0] = False
    renumbered = np.cumsum(keep) - 1
    cells = np.argwhere(keep[labels])
    cluster = renumbered[labels[cells[:, 0], cells[:, 1]]]
    order = np.argsort(cluster, kind="stable")
    return cells[order], cluster[order].astype(np.int64)
