"""What one observation adds to the map: points by voxel, and where it looks below the floor."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from toponav.errors import ObservationError
from toponav.mapping.frame_sums import (
    DepthWindow,
    Frame,
    FrameSums,
    Masks,
    Scratch,
    sum_frame,
)
from toponav.mapping.voxel_codes import SPAN
from toponav.mapping.voxels import reach_m
from toponav.types import Observation

CROSSING_STRIDE = 2
"""Every how many rows and columns a line of sight is followed below the floor."""


class PosedFrame:
    """One observation, as the map takes it."""

    def __init__(self, observation: Observation, window: DepthWindow) -> None:
        """Prepare an observation; its pixels outside `window` are ignored."""
        camera, step = observation.intrinsics, window.stride
        self._window = window
        self._frame = Frame(
            depth=np.ascontiguousarray(observation.depth[::step, ::step]),
            rgb=np.ascontiguousarray(observation.rgb[::step, ::step]),
            ray_x=(np.arange(0, camera.width, step, dtype=np.float64) - camera.cx) / camera.fx,
            ray_y=(np.arange(0, camera.height, step, dtype=np.float64) - camera.cy) / camera.fy,
            rotation=np.ascontiguousarray(observation.world_from_camera.rotation),
            translation=np.ascontiguousarray(observation.world_from_camera.translation),
        )

    @property
    def images(self) -> Frame:
        """What kernels see of it."""
        return self._frame

    def sums(self, resolution: float, masks: Masks, scratch: Scratch) -> FrameSums:
        """The frame's points, summed by voxel and by which masks they lie under.

        Args:
            resolution: Edge of a voxel, metres.
            masks: Of the whole image, and their labels.
            scratch: Holds the sums until it is used again.

        Raises:
            ObservationError: The camera is too far from the map's origin, or sees too far.
        """
        frame, window = self._frame, self._window
        farthest_ray = np.linalg.norm([np.abs(frame.ray_x).max(), np.abs(frame.ray_y).max(), 1.0])
        range_m = farthest_ray * window.max_depth
        if not np.abs(frame.translation).max() + range_m < reach_m(resolution):
            raise ObservationError(
                f"the camera must stay within {reach_m(resolution):.0f} m of the map's origin: "
                "move the world frame's origin nearer"
            )
        if not range_m < (SPAN // 2 - 1) * resolution:
            raise ObservationError(
                f"voxels of {resolution:g} m are too small for depths of up to "
                f"{window.max_depth:g} m: raise map.r_pcd or lower map.max_depth_m"
            )
        step = window.stride
        pixels = np.ascontiguousarray(masks.pixels[:, ::step, ::step])
        return sum_frame(frame, window, Masks(pixels, masks.bits), resolution, scratch)

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
        columns: NDArray[np.int64] = _crossings(self._frame, self._window, heights, resolution)
        return columns


@njit(cache=True, error_model="numpy")
def _crossings(
    frame: Frame, window: DepthWindow, heights: tuple[float, float], resolution: float
) -> NDArray[np.int64]:
    """(N, 2) columns in which lines of sight cross the first height and end below the second."""
    plane_z, below_z = heights
    depth, _, ray_x, ray_y, R, t = frame
    height, width = depth.shape
    steepest = max(abs(ray_x[0]), abs(ray_x[-1])) + max(abs(ray_y[0]), abs(ray_y[-1])) + 1.0
    reach = int(np.ceil(window.max_depth * steepest / resolution)) + 1
    corner_i = int(np.floor(t[0] / resolution)) - reach
    corner_j = int(np.floor(t[1] / resolution)) - reach
    is_found = np.zeros((2 * reach + 1, 2 * reach + 1), np.bool_)
    found = np.empty((height * width // CROSSING_STRIDE**2 + height + width, 2), np.int64)
    count = 0
    for v in range(0, height, CROSSING_STRIDE):
        slope, start = R[2, 0], R[2, 1] * ray_y[v] + R[2, 2]
        if not _reaches_below(depth[v], ray_x, (slope, start, t[2]), window, below_z):
            continue
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
            i, j = int(np.floor(x / resolution)), int(np.floor(y / resolution))
            if not is_found[i - corner_i, j - corner_j]:
                is_found[i - corner_i, j - corner_j] = True
                found[count, 0], found[count, 1] = i, j
                count += 1
    return found[:count]


@njit(cache=True)
def _reaches_below(
    depth: NDArray[np.float32],
    ray_x: NDArray[np.float64],
    line: tuple[float, float, float],
    window: DepthWindow,
    below_z: float,
) -> bool:
    """Whether anything in a row may lie below a height: a loop that becomes vectors."""
    slope, start, t_z = line
    margin = 1e-6  # rounds otherwise than the exact look that follows
    count = 0
    for u in range(depth.size):
        is_below = t_z + float(depth[u]) * (slope * ray_x[u] + start) <= below_z + margin
        count += int(is_below & (depth[u] < window.max_depth))
    return count > 0
