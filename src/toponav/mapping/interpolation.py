"""Bridging the gaps in M_nav between the agent and the floor that it sees (Section III-C)."""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from toponav.mapping.occupancy import FloorGrid


class Spacing(NamedTuple):
    """Distances of the interpolation, metres.

    Attributes:
        delta_step: Between the points of a ray.
        delta: Half the height of the navigable band.
        r_pcd: Edge of a voxel.
        columns_per_cell: r_g / r_pcd.
    """

    delta_step: float
    delta: float
    r_pcd: float
    columns_per_cell: int


def interpolate(
    stand: NDArray[np.float64],
    targets: NDArray[np.float32],
    grid: FloorGrid,
    spacing: Spacing,
) -> NDArray[np.float64]:
    """The points p_k from p_stand towards the navigable points of a frame, where they fill a gap.

    p_k = p_stand + k delta_step (x_i - p_stand) / |x_i - p_stand|, k = 1 .. floor(|x_i - p_stand| /
    delta_step), of which those with |z_k - z_floor| < delta count. The paper draws a ray to every
    x_i and downsamples by voxel. Here the first x_i of each cell of G gets one, since rays 10 cm
    apart at their ends leave no gap in G, and a p_k counts when it is the first in a column of
    voxels without any navigable point: more would only thicken M_nav over the same ground.

    Args:
        stand: (3,) p_stand, at floor height.
        targets: (N, 3) the x_i.
        grid: The floor's grid, which knows the columns that are navigable.
        spacing: Distances.

    Returns:
        (M, 3) points, one a column, in the order in which the rays reach them.
    """
    if not len(targets):
        return np.empty((0, 3))
    ends = np.vstack([targets[:, :2].min(axis=0), targets[:, :2].max(axis=0), stand[:2]])
    # One column of margin: rounding may carry the last point of a ray over the box of its ends.
    first = np.floor(ends.min(axis=0) / spacing.r_pcd).astype(np.int64) - 1
    shape = np.floor(ends.max(axis=0) / spacing.r_pcd).astype(np.int64) + 2 - first
    covered = grid.covered(first, shape)
    points = np.empty((covered.size, 3))
    count = _walk_rays(stand, targets, spacing, (covered, first), points)
    return points[:count]


@njit(cache=True, error_model="numpy")
def _walk_rays(
    stand: NDArray[np.float64],
    targets: NDArray[np.float32],
    spacing: Spacing,
    window: tuple[NDArray[np.bool_], NDArray[np.int64]],
    points: NDArray[np.float64],
) -> int:
    """Write the first point in each uncovered column to `points`; returns how many."""
    covered, first = window
    step, r_pcd, per_cell = spacing.delta_step, spacing.r_pcd, spacing.columns_per_cell
    aimed_at = np.zeros(
        (covered.shape[0] // per_cell + 2, covered.shape[1] // per_cell + 2), np.bool_
    )
    count = 0
    for row in range(targets.shape[0]):
        a = int(np.floor(targets[row, 0] / r_pcd)) // per_cell - first[0] // per_cell
        b = int(np.floor(targets[row, 1] / r_pcd)) // per_cell - first[1] // per_cell
        if aimed_at[a, b]:
            continue
        aimed_at[a, b] = True
        x = targets[row, 0] - stand[0]
        y = targets[row, 1] - stand[1]
        z = targets[row, 2] - stand[2]
        distance = np.sqrt(x * x + y * y + z * z)
        for k in range(1, int(distance / step) + 1):
            share = k * step / distance
            if abs(share * z) >= spacing.delta:
                break
            p_x, p_y = stand[0] + share * x, stand[1] + share * y
            i = int(np.floor(p_x / r_pcd)) - first[0]
            j = int(np.floor(p_y / r_pcd)) - first[1]
            if not covered[i, j]:
                covered[i, j] = True
                points[count, 0], points[count, 1], points[count, 2] = (
                    p_x,
                    p_y,
                    stand[2] + share * z,
                )
                count += 1
    return count


def disc(center: NDArray[np.float64], radius: float, spacing: float) -> NDArray[np.float64]:
    """(K, 3) points of a level disc at `spacing`, the ground under an agent of that radius."""
    points: NDArray[np.float64] = center + _disc_about_origin(radius, spacing)
    return points


@cache
def _disc_about_origin(radius: float, spacing: float) -> NDArray[np.float64]:
    reach = int(radius / spacing)
    x, y = np.mgrid[-reach : reach + 1, -reach : reach + 1] * spacing
    inside = np.hypot(x, y) <= radius
    return np.column_stack([x[inside], y[inside], np.zeros(np.count_nonzero(inside))])
