"""Bridging the gaps in M_nav between the agent and the floor that it sees (Section III-C)."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray


def interpolate(
    stand: NDArray[np.float64],
    targets: NDArray[np.float32],
    delta_step: float,
    delta: float,
    resolution: float,
) -> NDArray[np.float64]:
    """The points p_k from p_stand towards each navigable point, one a voxel.

    p_k = p_stand + k delta_step (x_i - p_stand) / |x_i - p_stand|, k = 1 .. floor(|x_i - p_stand| /
    delta_step), of which those with |z_k - z_floor| < delta count. Rays crowd near the agent, so of
    the points that fall into one voxel the first is kept.

    Args:
        stand: (3,) p_stand, at floor height.
        targets: (N, 3) the x_i.
        delta_step: Distance between interpolated points, metres.
        delta: Half the height of the navigable band, metres.
        resolution: r_pcd, metres.

    Returns:
        (M, 3) points in the order in which the rays reach them.
    """
    if not len(targets):
        return np.empty((0, 3))
    ends = np.vstack([targets[:, :2].min(axis=0), targets[:, :2].max(axis=0), stand[:2]])
    low = np.append(ends.min(axis=0), stand[2] - delta)
    high = np.append(ends.max(axis=0), stand[2] + delta)
    # One voxel of margin: rounding may carry the last point of a ray over the box of its ends.
    first = np.floor(low / resolution).astype(np.int64) - 1
    shape = np.floor(high / resolution).astype(np.int64) + 2 - first
    taken = np.zeros(shape, np.bool_)
    points = np.empty((taken.size, 3))
    count = _walk_rays(stand, targets, (delta_step, delta, resolution), (taken, first), points)
    return points[:count]


@njit(cache=True)
def _walk_rays(
    stand: NDArray[np.float64],
    targets: NDArray[np.float32],
    lengths: tuple[float, float, float],
    window: tuple[NDArray[np.bool_], NDArray[np.int64]],
    points: NDArray[np.float64],
) -> int:
    """Write the first point of each voxel of the window to `points`; returns how many."""
    delta_step, delta, resolution = lengths
    taken, first = window
    count = 0
    for row in range(targets.shape[0]):
        x = targets[row, 0] - stand[0]
        y = targets[row, 1] - stand[1]
        z = targets[row, 2] - stand[2]
        distance = np.sqrt(x * x + y * y + z * z)
        for k in range(1, int(distance / delta_step) + 1):
            share = k * delta_step / distance
            if abs(share * z) >= delta:
                break
            p_x, p_y, p_z = stand[0] + share * x, stand[1] + share * y, stand[2] + share * z
            i = int(np.floor(p_x / resolution)) - first[0]
            j = int(np.floor(p_y / resolution)) - first[1]
            l = int(np.floor(p_z / resolution)) - first[2]
            if not taken[i, j, l]:
                taken[i, j, l] = True
                points[count, 0], points[count, 1], points[count, 2] = p_x, p_y, p_z
                count += 1
    return count


def disc(center: NDArray[np.float64], radius: float, spacing: float) -> NDArray[np.float64]:
    """(K, 3) points of a level disc at `spacing`, the ground under an agent of that radius."""
    reach = int(radius / spacing)
    x, y = np.mgrid[-reach : reach + 1, -reach : reach + 1] * spacing
    inside = np.hypot(x, y) <= radius
    offsets = np.column_stack([x[inside], y[inside], np.zeros(np.count_nonzero(inside))])
    points: NDArray[np.float64] = center + offsets
    return points
