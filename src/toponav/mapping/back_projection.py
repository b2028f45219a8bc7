"""From depth pixels to voxels in one pass: eq. (1), eq. (2) and the sums of VoxelDownsample.

Neighbouring pixels mostly fall into the same voxel, so a row is summed run by run, and the runs of
one voxel are gathered over the rows before the map is looked up; no array of points is ever made.
What is done to every pixel is in loops without branches, which the compiler turns into vectors.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from toponav.errors import ObservationError
from toponav.mapping.voxels import VoxelCloud, VoxelSums, pack_key
from toponav.types import Observation

PixelBox = tuple[int, int, int, int]
"""(top, left, bottom, right) in pixels, ends exclusive."""

RECENT = 1024
"""Voxels that the gathering of runs keeps in sight, a power of two: more than a row passes, and
their keys fit into the nearest cache."""

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
    """An observation as the kernels see it, every `stride`-th row and column of it."""

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
        camera, step = observation.intrinsics, window.stride
        self._window = window
        self._frame = _Frame(
            depth=np.ascontiguousarray(observation.depth[::step, ::step]),
            rgb=np.ascontiguousarray(observation.rgb[::step, ::step]),
            ray_x=(np.arange(0, camera.width, step, dtype=np.float64) - camera.cx) / camera.fx,
            ray_y=(np.arange(0, camera.height, step, dtype=np.float64) - camera.cy) / camera.fy,
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
            counted = np.ones(frame.depth.shape, np.bool_)
            box = (0, 0, *frame.depth.shape)
        else:
            counted = np.ascontiguousarray(mask[:: window.stride, :: window.stride])
            box = _bounds(counted)
        top, left, bottom, right = box
        room = VoxelSums.empty((bottom - top) * (right - left))
        found = _sum_voxels(frame, window, counted, box, cloud.resolution, room)
        cloud.add_sums(room.first(found))

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


def _bounds(mask: NDArray[np.bool_]) -> PixelBox:
    """The smallest box that holds all marked pixels; empty when there is none."""
    rows = np.flatnonzero(mask.any(axis=1))
    if not len(rows):
        return (0, 0, 0, 0)
    top, bottom = int(rows[0]), int(rows[-1]) + 1
    columns = np.flatnonzero(mask[top:bottom].any(axis=0))
    return (top, int(columns[0]), bottom, int(columns[-1]) + 1)


class _Row(NamedTuple):
    """What is known of a row of W pixels.

    Attributes:
        points: (3, W) world coordinates, metres.
        voxels: (3, W) integer voxel coordinates.
        point_sums: (3, W + 1) sums of the coordinates of the pixels before one.
        color_sums: (3, W + 1) likewise.
        counts: (W,) bool whether a pixel counts.
        starts: (W + 1,) first pixels of the runs: neighbours in one voxel, or that do not count.
    """

    points: NDArray[np.float64]
    voxels: NDArray[np.float64]
    point_sums: NDArray[np.float64]
    color_sums: NDArray[np.uint32]
    counts: NDArray[np.bool_]
    starts: NDArray[np.int32]


@njit(cache=True)
def _sum_voxels(
    frame: _Frame,
    window: DepthWindow,
    mask: NDArray[np.bool_],
    box: PixelBox,
    resolution: float,
    sums: VoxelSums,
) -> int:
    """Sum the pixels of a box by voxel; a voxel may come up more than once. Returns how often."""
    top, left, bottom, right = box
    width = right - left
    row = _Row(
        np.empty((3, width)),
        np.empty((3, width)),
        np.zeros((3, width + 1)),
        np.zeros((3, width + 1), np.uint32),
        np.empty(width, np.bool_),
        np.empty(width + 1, np.int32),
    )
    recent_keys, recent_sums = np.full(RECENT, -1, np.int64), np.zeros(RECENT, np.int32)
    found = 0
    for v in range(top, bottom):
        depth = frame.depth[v, left:right]
        _where_counted(depth, mask[v, left:right], window, row.counts)
        for axis in range(3):
            # Eq. (1) in eq. (2): x_w = d (R [ray_x, ray_y, 1]^T) + t.
            slope = frame.rotation[axis, 0]
            start = frame.rotation[axis, 1] * frame.ray_y[v] + frame.rotation[axis, 2]
            line = (slope, start, frame.translation[axis])
            points, voxels = row.points[axis], row.voxels[axis]
            _locate(depth, frame.ray_x[left:right], line, resolution, points, voxels)
        _accumulate(row, frame.rgb[v, left:right])
        runs = _find_runs(row)
        found = _gather_runs(row, runs, resolution, (recent_keys, recent_sums), sums, found)
    return found


@njit(cache=True)
def _where_counted(
    depth: NDArray[np.float32],
    mask: NDArray[np.bool_],
    window: DepthWindow,
    counts: NDArray[np.bool_],
) -> None:
    for u in range(depth.size):
        counts[u] = mask[u] & (depth[u] > window.min_depth) & (depth[u] < window.max_depth)


@njit(cache=True, error_model="numpy")
def _locate(
    depth: NDArray[np.float32],
    ray_x: NDArray[np.float64],
    line: tuple[float, float, float],
    resolution: float,
    points: NDArray[np.float64],
    voxels: NDArray[np.float64],
) -> None:
    """One world coordinate of a row's points, and the voxel that it falls into."""
    slope, start, shift = line
    for u in range(depth.size):
        points[u] = float(depth[u]) * (slope * ray_x[u] + start) + shift
        voxels[u] = np.floor(points[u] / resolution)


@njit(cache=True)
def _find_runs(row: _Row) -> int:
    """Fill in where the runs start; returns their number."""
    voxel_x, voxel_y, voxel_z = row.voxels[0], row.voxels[1], row.voxels[2]
    counts, starts = row.counts, row.starts
    width = counts.size
    breaks = np.ones(width, np.bool_)
    for u in range(1, width):
        breaks[u] = (
            (voxel_x[u] != voxel_x[u - 1])
            | (voxel_y[u] != voxel_y[u - 1])
            | (voxel_z[u] != voxel_z[u - 1])
            | (counts[u] != counts[u - 1])
        )
    runs = 0
    for u in range(width):
        starts[runs] = u
        runs += int(breaks[u])
    starts[runs] = width
    return runs


@njit(cache=True)
def _accumulate(row: _Row, rgb: NDArray[np.uint8]) -> None:
    """Fill in the running sums: one loop, so that the six additions overlap."""
    x, y, z = row.points[0], row.points[1], row.points[2]
    x_sums, y_sums, z_sums = row.point_sums[0], row.point_sums[1], row.point_sums[2]
    red_sums, green_sums, blue_sums = row.color_sums[0], row.color_sums[1], row.color_sums[2]
    x_sum, y_sum, z_sum = 0.0, 0.0, 0.0
    red, green, blue = np.uint32(0), np.uint32(0), np.uint32(0)
    for u in range(x.size):
        x_sum += x[u]
        y_sum += y[u]
        z_sum += z[u]
        red += np.uint32(rgb[u, 0])
        green += np.uint32(rgb[u, 1])
        blue += np.uint32(rgb[u, 2])
        x_sums[u + 1], y_sums[u + 1], z_sums[u + 1] = x_sum, y_sum, z_sum
        red_sums[u + 1], green_sums[u + 1], blue_sums[u + 1] = red, green, blue


@njit(cache=True)
def _gather_runs(
    row: _Row,
    runs: int,
    resolution: float,
    recent: tuple[NDArray[np.int64], NDArray[np.int32]],
    sums: VoxelSums,
    found: int,
) -> int:
    """Add a row's runs to the sums of their voxels; returns the number of sums."""
    recent_keys, recent_sums = recent
    voxel_x, voxel_y, voxel_z = row.voxels[0], row.voxels[1], row.voxels[2]
    for run in range(runs):
        start, end = row.starts[run], row.starts[run + 1]
        if not row.counts[start]:
            continue
        ix, iy, iz = int(voxel_x[start]), int(voxel_y[start]), int(voxel_z[start])
        key = pack_key(ix, iy, iz)
        place = (73 * ix + 31 * iy + 177 * iz) & (RECENT - 1)
        if recent_keys[place] != key:
            recent_keys[place], recent_sums[place] = key, found
            sums.keys[found], sums.counts[found] = key, 0
            for axis in range(3):
                sums.offset_sums[found, axis], sums.color_sums[found, axis] = 0.0, 0
            found += 1
        total = recent_sums[place]
        sums.counts[total] += end - start
        for axis in range(3):
            corner = row.voxels[axis, start] * resolution
            points = row.point_sums[axis, end] - row.point_sums[axis, start]
            sums.offset_sums[total, axis] += points - (end - start) * corner
            color = row.color_sums[axis, end] - row.color_sums[axis, start]
            sums.color_sums[total, axis] += color
    return found
