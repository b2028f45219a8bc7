"""The voxels that a row of pixels falls into, each as one number.

This is done to every pixel of every frame, in loops that the compiler turns into vectors.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

SPAN = 1 << 17
"""Voxels that a frame may reach along an axis, half of them on either side of the camera: three
such numbers make one code that a double holds exactly."""

NOWHERE = -np.inf
"""Code of a pixel that does not count."""

DOUBT = 1e-8
"""Nearer than this to an integer, in voxels, a product may lie on the other side of it than the
quotient that it stands for: many times the rounding of numbers up to 2^20."""

Lines = tuple[tuple[float, float, float], tuple[float, float, float], tuple[float, float, float]]
"""For each axis of the world slope, start and shift: x_w = d (slope ray_x + start) + shift."""

Lattice = tuple[NDArray[np.float64], float]
"""The voxel from which codes count, (3,) whole numbers, and the edge of a voxel, metres."""


@njit(cache=True)
def encode(
    depth: NDArray[np.float32],
    ray_x: NDArray[np.float64],
    lines: Lines,
    space: tuple[Lattice, tuple[float, float]],
    codes: NDArray[np.float64],
) -> None:
    """Write the voxels of a row as codes, `NOWHERE` for pixels that do not count.

    Args:
        depth: (W,) metres.
        ray_x: (W,) tangents of the pixels' rays.
        lines: The row's rays in the world.
        space: The lattice, within `SPAN` / 2 voxels of all points, and the depths between which
            pixels count, both excluded.
        codes: (W,) are overwritten.
    """
    if not _encode_quickly(depth, ray_x, lines, space, codes):
        _encode_exactly(depth, ray_x, lines, space, codes)


@njit(cache=True)
def decoded(code: float) -> tuple[int, int, int]:
    """The voxel of a code, from that of the lattice on."""
    rest = int(code)
    k = (rest + SPAN // 2) % SPAN - SPAN // 2
    rest = (rest - k) // SPAN
    j = (rest + SPAN // 2) % SPAN - SPAN // 2
    return (rest - j) // SPAN, j, k


@njit(cache=True, fastmath={"contract"})
def _encode_quickly(
    depth: NDArray[np.float32],
    ray_x: NDArray[np.float64],
    lines: Lines,
    space: tuple[Lattice, tuple[float, float]],
    codes: NDArray[np.float64],
) -> bool:
    """As `encode`; returns whether the codes are those that division gives.

    To multiply by 1 / resolution costs a fraction of dividing, and may end up in the neighbouring
    voxel only where the quotient is an integer but for rounding. Coordinates are those from half
    of `DOUBT` before the camera's voxel: then what is doubtful has the least fractions.
    """
    (slope_x, start_x, t_x), (slope_y, start_y, t_y), (slope_z, start_z, t_z) = lines
    (camera, resolution), (min_depth, max_depth) = space
    per_m = 1.0 / resolution
    slope_x, slope_y, slope_z = slope_x * per_m, slope_y * per_m, slope_z * per_m
    start_x, start_y, start_z = start_x * per_m, start_y * per_m, start_z * per_m
    shift_x = t_x * per_m - camera[0] + 0.5 * DOUBT
    shift_y = t_y * per_m - camera[1] + 0.5 * DOUBT
    shift_z = t_z * per_m - camera[2] + 0.5 * DOUBT
    doubtful = 0
    for u in range(depth.size):
        d, r = float(depth[u]), ray_x[u]
        x = d * (slope_x * r + start_x) + shift_x
        y = d * (slope_y * r + start_y) + shift_y
        z = d * (slope_z * r + start_z) + shift_z
        i, j, k = np.floor(x), np.floor(y), np.floor(z)
        is_inside = (d > min_depth) & (d < max_depth)
        codes[u] = (i * SPAN + j) * SPAN + k if is_inside else NOWHERE
        doubtful += int((min(x - i, y - j, z - k) < DOUBT) & is_inside)
    return doubtful == 0


@njit(cache=True, error_model="numpy")
def _encode_exactly(
    depth: NDArray[np.float32],
    ray_x: NDArray[np.float64],
    lines: Lines,
    space: tuple[Lattice, tuple[float, float]],
    codes: NDArray[np.float64],
) -> None:
    """As `encode`, by division."""
    (camera, resolution), (min_depth, max_depth) = space
    codes[:] = 0.0
    for axis in range(3):
        slope, start, shift = lines[axis]
        first = camera[axis]
        for u in range(depth.size):
            x = float(depth[u]) * (slope * ray_x[u] + start) + shift
            codes[u] = codes[u] * SPAN + (np.floor(x / resolution) - first)
    for u in range(depth.size):
        is_inside = (depth[u] > min_depth) & (depth[u] < max_depth)
        codes[u] = codes[u] if is_inside else NOWHERE
