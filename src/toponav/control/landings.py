"""What lies before the last treads of a flight that no image has shown: more treads, and floor.

Coming down a flight, a camera that looks ahead passes over what is nearest to the agent's feet, the
last treads and the landing; where a wall stands behind it, no image shows them before the agent is
there. Without a guess it would never go there.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import find_objects, label

from toponav.mapping.view import DROP, UNKNOWN, OccupancyGrid

LOW_M = 1.2
"""Treads this near to the floor's height tell where a flight leads: it may turn further up."""

NEAR_FLOOR_M = 0.6
"""A flight whose last known tread is farther than this from the floor's height ends elsewhere."""

LEAST_TREADS = 10
"""Cells of treads that tell a direction."""

SLOPES = (0.3, 1.5)
"""Height of a flight for each metre of its length."""


def landings(grid: OccupancyGrid, landing_m: float) -> NDArray[np.bool_]:
    """(N_x, N_y) cells that lie before the last treads of a flight, and of which nothing was seen.

    What looks like a drop there is as likely the treads that are hidden below the last known one.

    Args:
        grid: Known space, with the heights of its stairs.
        landing_m: Length of a landing, and how far it reaches to both sides of the flight, metres;
            with 0 there is none.
    """
    guessed = np.zeros(grid.cells.shape, np.bool_)
    if not landing_m or grid.stairs is None:
        return guessed
    height = np.abs(grid.stairs)
    flights, _ = label(height <= LOW_M)  # NaN, no stair, is not
    reach = round((landing_m + NEAR_FLOOR_M / SLOPES[0]) / grid.resolution)
    for number, (rows, columns) in enumerate(find_objects(flights), start=1):
        window = (
            slice(max(0, rows.start - reach), rows.stop + reach),
            slice(max(0, columns.start - reach), columns.stop + reach),
        )
        treads = np.argwhere(flights[window] == number)
        heights = height[window][tuple(treads.T)].astype(np.float64)
        if len(treads) >= LEAST_TREADS and heights.min() <= NEAR_FLOOR_M:
            cells = np.argwhere(np.isin(grid.cells[window], (UNKNOWN, DROP)))
            before = cells[_before(cells, treads, heights, grid.resolution, landing_m)]
            guessed[window][tuple(before.T)] = True
    return guessed


def _before(
    cells: NDArray[np.int64],
    treads: NDArray[np.int64],
    heights: NDArray[np.float64],
    resolution: float,
    landing_m: float,
) -> NDArray[np.bool_]:
    """(N,) which of (N, 2) cells continue a flight of (M, 2) cells straight on, or are its landing.

    Args:
        cells: Unknown ones.
        treads: Known treads of one flight.
        heights: (M,) their distance from the floor's height, metres.
        resolution: Edge of a cell, metres.
        landing_m: As for `landings`.
    """
    middle = treads.mean(axis=0)
    known = (treads - middle) * resolution
    design = np.column_stack([known, np.ones(len(known))])
    (x, y, at_middle), *_ = np.linalg.lstsq(design, heights, rcond=None)
    slope = float(np.hypot(x, y))
    if not SLOPES[0] <= slope <= SLOPES[1]:
        return np.zeros(len(cells), np.bool_)
    down = -np.array([x, y]) / slope
    across = np.array([-down[1], down[0]])
    end, foot = float((known @ down).max()), at_middle / slope
    left, right = float((known @ across).min()), float((known @ across).max())
    offset = (cells - middle) * resolution
    along, aside = offset @ down, offset @ across
    end = min(end, foot)
    straight_on = (along > end - resolution) & (aside >= left) & (aside <= right)
    landing = (along >= foot) & (aside >= left - landing_m) & (aside <= right + landing_m)
    return np.asarray((straight_on | landing) & (along <= max(end, foot) + landing_m))
