"""From depth pixels to voxels in one pass: eq. (1), eq. (2) and the sums of VoxelDownsample.

Neighbouring pixels mostly fall into the same voxel, so a row is summed run by run and each run
costs one look-up; no array of points is ever made.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from toponav.errors import ObservationError
from toponav.mapping.voxels import (
    SETTLED_COUNT,
    VOXELS,
    VoxelArrays,
    VoxelCloud,
    claim_slot,
    pack_key,
)
from toponav.types import Observation

PixelBox = tuple[int, int, int, int]
"""(top, left, bottom, right) in pixels, ends exclusive."""

BORDER = 1e-6
"""Points nearer than this share of an edge to their voxel's border are located by division anew:
there, rounding decides, and it must decide as `floor(x / r)` does."""


CROSSING_STRIDE = 2
"""Every how many rows and columns a line of sight is followed below the floor."""


class DepthWindow(NamedTuple):
    """Which pixels count.

    Attributes:
        min_depth: Depths at or under it are no returns, metres.
        max_depth: Depths at or over it are no returns, metres.
        stride: Every how many rows and columns a pixel is used.
    """

    min_depth: float
    max_depth: float
    stride: int


class _Frame(NamedTuple):
    """An observation as the kernel sees it."""

    depth: NDArray[np.float32]
    rgb: NDArray[np.uint8]
    ray_x: NDArray[np.float64]
    ray_y: NDArray[np.float64]
    rotation: NDArray[np.float64]
    translation: NDArray[np.float64]


class FrameScatter:
    """Adds the pixels of one observation to voxel clouds."""

    def __init__(self, observation: Observation, window: DepthWindow) -> None:
        """Prepare an observation; its pixels outside `window` are ignored."""
        camera = observation.intrinsics
        self._window = window
        self._frame = _Frame(
            depth=np.ascontiguousarray(observation.depth),
            rgb=np.ascontiguousarray(observation.rgb),
            ray_x=(np.arange(camera.width, dtype=np.float64) - camera.cx) / camera.fx,
            ray_y=(np.arange(camera.height, dtype=np.float64) - camera.cy) / camera.fy,
            rotation=np.ascontiguousarray(observation.world_from_camera.rotation),
            translation=np.ascontiguousarray(observation.world_from_camera.translation),
        )

    def into(self, cloud: VoxelCloud, mask: NDArray[np.bool_] | None = None) -> None:
        """Add the frame's points, or those under a (H, W) mask, to a cloud.

        Raises:
            ObservationError: The camera is too far from the map's origin.
        """
        frame, window = self._frame, self._window
        farthest_ray = np.linalg.norm([np.abs(frame.ray_x).max(), np.abs(frame.ray_y).max(), 1.0])
        farthest = np.abs(frame.translation).max() + farthest_ray * window.max_depth
        if not farthest < cloud.reach:
            raise ObservationError(
                f"the camera must stay within {cloud.reach:.0f} m of the map's origin: "
                "move the world frame's origin nearer"
            )
        if mask is None:
            mask = np.ones(frame.depth.shape, np.bool_)
            box = (0, 0, frame.depth.shape[0], frame.depth.shape[1])
        else:
            box = _bounds(mask)
        row = _next_multiple(box[0], window.stride)
        while row < box[2]:
            cloud.reserve(frame.depth.shape[1])  # a row makes at most one voxel a pixel
            row = _scatter_rows(
                frame, window, mask, (row, *box[1:]), cloud.arrays, cloud.resolution
            )

    def columns_seen_through(
        self, plane_z: float, depth_below_m: float, resolution: float
    ) -> NDArray[np.int64]:
        """Where lines of sight cross a plane and go on below it.

        Pixels without a return say nothing: what they show may be too near or too far.

        Args:
            plane_z: Height of the plane, metres, below the camera.
            depth_below_m: A line of sight must reach this far below the plane, metres.
            resolution: Edge of a column, metres.

        Returns:
            (N, 2) world indices of the columns, each once.
        """
        heights = (plane_z, plane_z - depth_below_m)
        columns = _crossings(self._frame, self._window, heights, resolution)
        return np.unique(columns, axis=0)


@njit(cache=True)
def _crossings(
    frame: _Frame, window: DepthWindow, heights: tuple[float, float], resolution: float
) -> NDArray[np.int64]:
    """(N, 2) columns in which lines of sight cross the first height and end below the second."""
    plane_z, below_z = heights
    depth, _, ray_x, ray_y, R, t = frame
    height, width = depth.shape
    found = np.empty((height * width // CROSSING_STRIDE**2 + height + width, 2), np.int64)
    count = 0
    for v in range(0, height, CROSSING_STRIDE):
        for u in range(0, width, CROSSING_STRIDE):
            fall = R[2, 0] * ray_x[u] + R[2, 1] * ray_y[v] + R[2, 2]
            if fall >= 0.0:
                continue
            d = float(depth[v, u])
            if d <= window.min_depth or d >= window.max_depth:
                continue
            if t[2] + d * fall > below_z:
                continue
            d = (plane_z - t[2]) / fall
            x = d * (R[0, 0] * ray_x[u] + R[0, 1] * ray_y[v] + R[0, 2]) + t[0]
            y = d * (R[1, 0] * ray_x[u] + R[1, 1] * ray_y[v] + R[1, 2]) + t[1]
            found[count, 0] = int(np.floor(x / resolution))
            found[count, 1] = int(np.floor(y / resolution))
            count += 1
    return found[:count]


@njit(cache=True)
def _bounds(mask: NDArray[np.bool_]) -> PixelBox:
    """The smallest box that holds all marked pixels; empty when there is none."""
    rows, columns = mask.shape
    marked_columns = np.zeros(columns, np.bool_)
    top, bottom = rows, 0
    for v in range(rows):
        marked = False
        for u in range(columns):
            marked |= mask[v, u]
            marked_columns[u] |= mask[v, u]
        if marked:
            top, bottom = min(top, v), v + 1
    left, right = columns, 0
    for u in range(columns):
        if marked_columns[u]:
            left, right = min(left, u), u + 1
    return top, left, bottom, right


@njit(cache=True)
def _next_multiple(value: int, step: int) -> int:
    return (value + step - 1) // step * step


@njit(cache=True)
def _scatter_rows(
    frame: _Frame,
    window: DepthWindow,
    mask: NDArray[np.bool_],
    box: PixelBox,
    arrays: VoxelArrays,
    resolution: float,
) -> int:
    """Add the rows of a box while there is room for a whole row; returns the next row."""
    depth, rgb, ray_x, ray_y, R, t = frame
    table, keys, offset_sums, color_sums, counts, _, _, touched, is_touched, sizes = arrays
    sums = (counts, offset_sums, color_sums)
    width = depth.shape[1]
    v, left, bottom, right = box
    left = _next_multiple(left, window.stride)
    inside = BORDER * resolution
    while v < bottom and sizes[VOXELS] + width <= keys.size:
        # Eq. (1) in eq. (2): x_w = d (R [ray_x, ray_y, 1]^T) + t. The row's share of the bracket:
        row_x = R[0, 1] * ray_y[v] + R[0, 2]
        row_y = R[1, 1] * ray_y[v] + R[1, 2]
        row_z = R[2, 1] * ray_y[v] + R[2, 2]
        slot, run = 0, 0
        low_x, low_y, low_z = 0.0, 0.0, 0.0
        sum_x, sum_y, sum_z = 0.0, 0.0, 0.0
        red, green, blue = 0, 0, 0
        for u in range(left, right, window.stride):
            d = float(depth[v, u])
            if not mask[v, u] or d <= window.min_depth or d >= window.max_depth:
                continue
            x = d * (R[0, 0] * ray_x[u] + row_x) + t[0]
            y = d * (R[1, 0] * ray_x[u] + row_y) + t[1]
            z = d * (R[2, 0] * ray_x[u] + row_z) + t[2]
            same_voxel = (
                inside <= x - low_x < resolution - inside
                and inside <= y - low_y < resolution - inside
                and inside <= z - low_z < resolution - inside
            )
            if run == 0 or not same_voxel:
                if run > 0:
                    _add_run(sums, slot, run, (sum_x, sum_y, sum_z), (red, green, blue))
                ix = int(np.floor(x / resolution))
                iy = int(np.floor(y / resolution))
                iz = int(np.floor(z / resolution))
                slot = claim_slot(table, keys, touched, is_touched, sizes, pack_key(ix, iy, iz))
                low_x, low_y, low_z = ix * resolution, iy * resolution, iz * resolution
                run, sum_x, sum_y, sum_z, red, green, blue = 0, 0.0, 0.0, 0.0, 0, 0, 0
            run += 1
            sum_x += x - low_x
            sum_y += y - low_y
            sum_z += z - low_z
            red += rgb[v, u, 0]
            green += rgb[v, u, 1]
            blue += rgb[v, u, 2]
        if run > 0:
            _add_run(sums, slot, run, (sum_x, sum_y, sum_z), (red, green, blue))
        v += window.stride
    return v


@njit(cache=True)
def _add_run(
    sums: tuple[NDArray[np.int32], NDArray[np.float64], NDArray[np.uint32]],
    slot: int,
    run: int,
    offsets: tuple[float, float, float],
    colors: tuple[int, int, int],
) -> None:
    """Add the sums of `run` neighbouring points to their voxel."""
    counts, offset_sums, color_sums = sums
    if counts[slot] + run <= SETTLED_COUNT:
        counts[slot] += run
        for axis in range(3):
            offset_sums[slot, axis] += offsets[axis]
            color_sums[slot, axis] += colors[axis]
