"""Flights of stairs on the grid: gaps between treads, ends, and what the wells beside them hide.

From a landing a flight that leads down is seen at a flat angle or not at all, and interpolation
between the agent and the floor beyond the well would have one walk on air.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import (
    binary_closing,
    binary_opening,
    convolve,
    distance_transform_edt,
    label,
    maximum,
)

from toponav.mapping.view import DROP, FREE, OCCUPIED, UNKNOWN, OccupancyGrid

TREAD_GAP_M = 0.6
"""Between treads this near to each other there are only treads: seen from above at a flat angle,
parts of a flight are hidden, and what is nearer to the foot than this lies under the image."""

STEP_GAP_M = 0.4
"""Between the lowest tread and the floor, a riser and the shadow of an edge may be unseen."""

LOWEST_TREAD_M = 0.08
"""The first tread of a flight that leads up is at least this high; one that leads down begins on
the floor itself."""

FLIGHT_END_M = 0.3
"""Treads this much below the highest of a flight, or above its lowest, are not its end."""

HIDDEN_TREAD_M = 0.45
"""Who looks down a flight from its head sees the second tread before the first: two risers down."""

NEIGHBOURS = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 1.0], [0.0, 1.0, 0.0]])


def tread_heights(
    grid: OccupancyGrid, seen: NDArray[np.float32], stood: NDArray[np.float32], floor_z: float
) -> NDArray[np.float32] | None:
    """(N_x, N_y) heights of stairs over the floor, NaN where there are none; None without any.

    Where the agent stood tells only of cells in which no stairs were seen: the disc under its foot
    reaches over the edge of its tread.

    Args:
        grid: Says where the cells are.
        seen: (N, 3) points of stairs.
        stood: (M, 3) points under the agent's feet, above or below the floor.
        floor_z: Height of the floor, metres.
    """
    if not len(seen) and not len(stood):
        return None
    layers = []
    for points in (seen, stood):
        highest = np.full(grid.cells.shape, -np.inf, np.float32)
        cell = grid.index_of(points)
        np.maximum.at(highest, (cell[:, 0], cell[:, 1]), points[:, 2] - np.float32(floor_z))
        layers.append(np.where(np.isneginf(highest), np.float32(np.nan), highest))
    return np.where(np.isnan(layers[0]), layers[1], layers[0])


def beside_unknown(grid: OccupancyGrid, xy: NDArray[np.float64]) -> NDArray[np.bool_]:
    """(N,) which of (N, 2) places lie in cells with an unknown 4-neighbour."""
    unknown = np.pad(grid.cells == UNKNOWN, 1, constant_values=True)
    i, j = (grid.index_of(xy) + 1).T
    beside: NDArray[np.bool_] = (
        unknown[i - 1, j] | unknown[i + 1, j] | unknown[i, j - 1] | unknown[i, j + 1]
    )
    return beside


def ends_of_flights(grid: OccupancyGrid, xy: NDArray[np.float64]) -> NDArray[np.bool_]:
    """(N,) which of (N, 2) places are on the floor or at the end of a flight, not at its side."""
    assert grid.stairs is not None
    height = np.abs(np.nan_to_num(grid.stairs))
    flight, count = label(height > FLIGHT_END_M)
    farthest = np.append(0.0, maximum(height, flight, np.arange(1, count + 1)))
    i, j = grid.index_of(xy).T
    ends: NDArray[np.bool_] = (flight[i, j] == 0) | (
        height[i, j] >= farthest[flight[i, j]] - FLIGHT_END_M
    )
    return ends


def filled_flights(
    grid: OccupancyGrid, heights: NDArray[np.float32], floor: NDArray[np.bool_]
) -> tuple[NDArray[np.int8], NDArray[np.float32]]:
    """Cells and heights of stairs with their gaps closed, those at their foot and head, too.

    Beside treads, floor that no image showed is a guess that they make unlikely: it is a drop.
    """
    reach = round(0.5 * TREAD_GAP_M / grid.resolution)
    stairs = np.argwhere(np.isfinite(heights))
    low, high = np.maximum(stairs.min(axis=0) - 2 * reach, 0), stairs.max(axis=0) + 2 * reach + 1
    window = (slice(low[0], high[0]), slice(low[1], high[1]))
    filled_cells, filled_heights = grid.cells.copy(), heights.copy()
    filled_cells[window], filled_heights[window] = _fill(
        grid.cells[window], heights[window], floor[window], grid.resolution
    )
    return filled_cells, filled_heights


def _fill(
    cells: NDArray[np.int8],
    heights: NDArray[np.float32],
    floor: NDArray[np.bool_],
    resolution: float,
) -> tuple[NDArray[np.int8], NDArray[np.float32]]:
    """The same in a window about the stairs."""
    seen = np.isfinite(heights)
    floor = binary_opening(floor, np.ones((2, 2)))  # a line of cells is what a seam shows
    open_cells = ~floor & (cells != OCCUPIED)
    reach = round(0.5 * TREAD_GAP_M / resolution)
    filled = _closed(seen, reach) & ~seen & open_cells
    nearest = distance_transform_edt(~seen, return_distances=False, return_indices=True)
    heights = np.where(filled, heights[tuple(nearest)], heights)
    treads = seen | filled
    weight = treads.astype(np.float64)
    total = np.maximum(convolve(weight, NEIGHBOURS), 1.0)
    for _ in range(2 * reach):  # an even slope between the treads that were seen
        mean = convolve(np.where(treads, heights, 0.0), NEIGHBOURS) / total
        heights = np.where(filled, mean, heights).astype(np.float32)
    away, nearest = distance_transform_edt(~treads, return_indices=True)
    guessed = (cells == FREE) & ~floor & (away <= reach)
    tread = heights[tuple(nearest)]
    guessed &= (tread < LOWEST_TREAD_M) | (tread > FLIGHT_END_M)  # before a flight's foot is floor
    cells = np.where(guessed & ~treads, np.int8(DROP), cells)
    step = treads & (heights <= FLIGHT_END_M) & (heights >= -HIDDEN_TREAD_M)
    steps = round(0.5 * STEP_GAP_M / resolution)
    foot = _closed(step | (floor & (cells == FREE)), steps)
    away, nearest = distance_transform_edt(~step, return_indices=True)
    foot &= open_cells & (away <= 2 * steps)
    # A tread that no image showed is on the way from the floor to the next one.
    slope = heights[tuple(nearest)] * (1.0 - away / (2 * steps + 1))
    heights = np.where(foot & ~treads, slope.astype(np.float32), heights)
    return np.where(filled | foot, np.int8(FREE), cells), heights


def _closed(mask: NDArray[np.bool_], reach: int) -> NDArray[np.bool_]:
    """A (N_x, N_y) mask with its gaps of up to twice `reach` cells along straight lines closed."""
    padded = np.pad(mask, 2 * reach)
    diagonal = np.eye(2 * reach + 1, dtype=np.bool_)
    straight = np.zeros_like(diagonal)
    straight[reach] = True
    lines = (straight, straight.T, diagonal, diagonal[::-1])
    closed = np.any([binary_closing(padded, line) for line in lines], axis=0)
    return np.asarray(closed[2 * reach : -2 * reach, 2 * reach : -2 * reach])
