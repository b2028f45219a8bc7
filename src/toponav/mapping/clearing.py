"""What has gone: voxels that a frame looks through are taken out of the map.

Not in the paper, whose scenes stand still. The middle of a voxel, its footprint, is projected into
the image. Where everything that the image shows there lies well behind it, and no pixel of the
image falls into the voxel, nothing can be there any more; after enough such frames in a row it
goes. Where the image shows something as near as it, it stays; where something nearer hides it, or
a pixel of the footprint has no return, the frame says nothing. The pixel in the middle settles
most of them, and most tiles of the map are not in the image at all: a frame costs what it shows.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray
from pydantic import Field

from toponav.config_model import ConfigModel
from toponav.mapping.floors import LAYERS, STAIRS
from toponav.mapping.frame_sums import Frame

TILE_M = 1.0
"""Voxels are looked up by square tiles this wide."""

NONE = -1
"""No slot."""

SHOWN = 255
"""Instead of a number of frames: this frame has points in the voxel, it is there, however thin."""

FOOTPRINT_SAMPLES = 5
"""Pixels along each side of a footprint that are looked at."""

LEAST_LEVEL = 0.3
"""Sine of the angle between the camera's axis and the vertical under which it looks up or down."""


class ClearingConfig(ConfigModel):
    """When a voxel has gone."""

    frames: int = Field(default=2, ge=1, lt=SHOWN)
    """Frames in a row that must look through it: more than the noise of one."""

    margin_m: float = Field(default=0.12, gt=0.0)
    """How far behind it everything must lie, metres: more than its diagonal."""

    margin_per_m2: float = Field(default=0.01, ge=0.0)
    """More for each square metre of the squared depth, as the noise of depth cameras grows."""

    footprint: float = Field(default=0.5, gt=0.0)
    """Width of the footprint in voxels; wider ones take the things beside a voxel for it."""

    range_m: float = Field(default=4.0, gt=0.0)
    """Voxels farther off are left alone, metres."""


class Voxels(NamedTuple):
    """A cloud's slots.

    Attributes:
        points: (N, 3) centroids, metres.
        counts: (N,) points averaged; with 0 there is no voxel.
        layers: (N,) or more, codes of `FloorLayers`: stairs stay where they are.
    """

    points: NDArray[np.float32]
    counts: NDArray[np.int32]
    layers: NDArray[np.int16]


class _Tiles(NamedTuple):
    """Lists of slots by tile.

    Attributes:
        corner: (2,) index of the first tile.
        first: (T_x, T_y) int32 last slot of a tile, or `NONE`.
        after: (C,) int32 the slot before it in the same tile, or `NONE`.
    """

    corner: NDArray[np.int64]
    first: NDArray[np.int32]
    after: NDArray[np.int32]


class Clearing:
    """Watches the voxels of a cloud for those that have gone."""

    def __init__(self, config: ClearingConfig) -> None:
        """Watch none yet."""
        self._config = config
        self._tiles = _Tiles(
            np.zeros(2, np.int64), np.empty((0, 0), np.int32), np.empty(0, np.int32)
        )
        self._watched = 0
        self._misses = np.zeros(0, np.uint8)

    @property
    def nbytes(self) -> int:
        """Memory held, bytes."""
        return sum(array.nbytes for array in (*self._tiles, self._misses))

    def watch(self, points: NDArray[np.float32]) -> None:
        """Take note of the slots that are new since the last call.

        Args:
            points: (N, 3) centroids of all slots, metres.
        """
        if len(points) == self._watched:
            return
        low, end = _tiles_about(points[self._watched :])
        self._make_room(low, end, len(points))
        _link(self._tiles, points, self._watched)
        self._watched = len(points)

    def look(
        self,
        frame: Frame,
        voxels: Voxels,
        resolution: float,
        touched: NDArray[np.int32],
    ) -> NDArray[np.int32]:
        """The slots that have gone with this frame.

        Args:
            frame: The images and the pose.
            voxels: All slots.
            resolution: Edge of a voxel, metres.
            touched: (K,) slots that the frame itself shows.
        """
        self._misses[touched] = SHOWN
        gone = _look(frame, voxels, self._misses, self._tiles, self._rules(resolution))
        self._misses[touched] = 0
        self._misses[gone] = 0
        return gone

    def _rules(self, resolution: float) -> _Rules:
        config = self._config
        return _Rules(
            config.frames,
            config.margin_m,
            config.margin_per_m2,
            0.5 * config.footprint * resolution,
            config.range_m,
        )

    def _make_room(self, low: NDArray[np.int64], high: NDArray[np.int64], slots: int) -> None:
        corner, first, after = self._tiles
        if not first.size:
            corner, first = low, np.full(high - low, NONE, np.int32)
        before = np.maximum(corner - low, 0)
        behind = np.maximum(high - corner - first.shape, 0)
        if before.any() or behind.any():
            first = np.pad(first, tuple(zip(before, behind, strict=True)), constant_values=NONE)
        if slots > len(after):
            room = max(slots, 2 * len(after)) - len(after)
            after = np.append(after, np.full(room, NONE, np.int32))
            self._misses = np.append(self._misses, np.zeros(room, np.uint8))
        self._tiles = _Tiles(corner - before, first, after)


class _Rules(NamedTuple):
    """`ClearingConfig` as the kernel sees it; `half_m` is half the width of a footprint."""

    frames: int
    margin_m: float
    margin_per_m2: float
    half_m: float
    range_m: float


@njit(cache=True)
def _tiles_about(points: NDArray[np.float32]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """(2,) indices of the first tile that holds a point, and of the one after the last."""
    low, end = np.full(2, np.iinfo(np.int64).max), np.full(2, np.iinfo(np.int64).min)
    for row in range(points.shape[0]):
        for axis in range(2):
            tile = int(np.floor(points[row, axis] / TILE_M))
            low[axis], end[axis] = min(low[axis], tile), max(end[axis], tile + 1)
    return low, end


@njit(cache=True)
def _link(tiles: _Tiles, points: NDArray[np.float32], start: int) -> None:
    """Put slots from `start` on into the lists of their tiles."""
    for slot in range(start, points.shape[0]):
        i = int(np.floor(points[slot, 0] / TILE_M)) - tiles.corner[0]
        j = int(np.floor(points[slot, 1] / TILE_M)) - tiles.corner[1]
        tiles.after[slot] = tiles.first[i, j]
        tiles.first[i, j] = slot


class _Sight(NamedTuple):
    """What can be in an image, seen from above; tangents grow to the camera's left.

    Attributes:
        forward: (2,) unit vector, or zeros where the camera looks almost straight up or down: then
            everything around it can be.
        tangents: Least and greatest, from `forward`.
    """

    forward: NDArray[np.float64]
    tangents: tuple[float, float]


@njit(cache=True)
def _sight_of(frame: Frame) -> _Sight:
    R = frame.rotation
    level = np.hypot(R[0, 2], R[1, 2])
    forward = np.zeros(2)
    low, high = np.inf, -np.inf
    if level < LEAST_LEVEL:
        return _Sight(forward, (low, high))
    x, y = R[0, 2] / level, R[1, 2] / level
    for ray_x in (frame.ray_x[0], frame.ray_x[-1]):
        for ray_y in (frame.ray_y[0], frame.ray_y[-1]):
            east = R[0, 0] * ray_x + R[0, 1] * ray_y + R[0, 2]
            north = R[1, 0] * ray_x + R[1, 1] * ray_y + R[1, 2]
            ahead = x * east + y * north
            if ahead <= 0.0:
                return _Sight(forward, (low, high))
            tangent = (x * north - y * east) / ahead
            low, high = min(low, tangent), max(high, tangent)
    forward[0], forward[1] = x, y
    return _Sight(forward, (low, high))


@njit(cache=True)
def _may_be_seen(sight: _Sight, east: float, north: float, range_m: float) -> bool:
    """Whether anything of a tile, its middle so far from the camera, can be in the image."""
    radius = np.sqrt(0.5) * TILE_M
    if np.hypot(east, north) > range_m + radius:
        return False
    x, y = sight.forward
    if x == 0.0 and y == 0.0:
        return True
    ahead, left = x * east + y * north, x * north - y * east
    low, high = sight.tangents
    may_be_seen: bool = (
        ahead > -radius
        and left - high * ahead < radius * np.hypot(1.0, high)
        and low * ahead - left < radius * np.hypot(1.0, low)
    )
    return may_be_seen


@njit(cache=True)
def _look(
    frame: Frame,
    voxels: Voxels,
    misses: NDArray[np.uint8],
    tiles: _Tiles,
    rules: _Rules,
) -> NDArray[np.int32]:
    """Count the frames that look through each voxel about; returns those looked through enough."""
    t, reach_m = frame.translation, rules.range_m
    low_i = max(0, int(np.floor((t[0] - reach_m) / TILE_M)) - tiles.corner[0])
    low_j = max(0, int(np.floor((t[1] - reach_m) / TILE_M)) - tiles.corner[1])
    high_i = int(np.floor((t[0] + reach_m) / TILE_M)) - tiles.corner[0] + 1
    high_j = int(np.floor((t[1] + reach_m) / TILE_M)) - tiles.corner[1] + 1
    sight, projection = _sight_of(frame), _projection_of(frame)
    gone, found = np.empty(0, np.int32), 0
    for i in range(low_i, min(high_i, tiles.first.shape[0])):
        for j in range(low_j, min(high_j, tiles.first.shape[1])):
            east = (tiles.corner[0] + i + 0.5) * TILE_M - t[0]
            north = (tiles.corner[1] + j + 0.5) * TILE_M - t[1]
            if not _may_be_seen(sight, east, north, reach_m):
                continue
            listed = (tiles.first[i, j], tiles.after)
            tile_gone = _look_at_tile(listed, (frame, projection), voxels, misses, rules)
            if tile_gone.size:
                gone = np.concatenate((gone[:found], tile_gone))
                found = gone.size
    return gone


@njit(cache=True, error_model="numpy")
def _look_at_tile(
    listed: tuple[int, NDArray[np.int32]],
    view: tuple[Frame, _Projection],
    voxels: Voxels,
    misses: NDArray[np.uint8],
    rules: _Rules,
) -> NDArray[np.int32]:
    """`_look` at the voxels of one tile; numbers are at hand and not in tuples, for the loop."""
    slot, after = listed
    points, counts, layers = voxels
    (image, _, _, _, R, t), (focal_u, focal_v, center_u, center_v) = view
    frames, margin_m, margin_per_m2, half_m, range_m = rules
    r00, r10, r20 = R[0, 0], R[1, 0], R[2, 0]
    r01, r11, r21 = R[0, 1], R[1, 1], R[2, 1]
    r02, r12, r22 = R[0, 2], R[1, 2], R[2, 2]
    t0, t1, t2 = t[0], t[1], t[2]
    last_v, last_u = image.shape[0] - 0.5, image.shape[1] - 0.5
    gone, found = np.empty(4, np.int32), 0
    while slot != NONE:
        this, slot = slot, after[slot]
        if counts[this] == 0 or misses[this] == SHOWN:
            continue
        x = float(points[this, 0]) - t0
        y = float(points[this, 1]) - t1
        z = float(points[this, 2]) - t2
        depth = r02 * x + r12 * y + r22 * z
        if depth < 2.0 * half_m or depth > range_m:
            continue
        # Half a pixel more, so that the integer part is the nearest pixel.
        nearness = 1.0 / depth
        per_u, per_v = focal_u * nearness, focal_v * nearness
        u = (r00 * x + r10 * y + r20 * z) * per_u + center_u
        v = (r01 * x + r11 * y + r21 * z) * per_v + center_v
        half_u, half_v = half_m * per_u, half_m * per_v
        if not (half_u + 0.5 <= u <= last_u - half_u and half_v + 0.5 <= v <= last_v - half_v):
            continue
        margin = margin_m + margin_per_m2 * depth * depth
        middle = image[int(v), int(u)]
        if middle <= depth + margin:
            if middle > max(0.0, depth - margin):
                misses[this] = 0
            continue
        if layers[this] >= 0 and layers[this] % LAYERS == STAIRS and misses[this] == 0:
            continue
        there = (depth - margin, depth + margin)
        seen = _through_footprint(image, (u, v), (half_u, half_v), there)
        if seen == THERE:
            misses[this] = 0
        elif seen == THROUGH and not (layers[this] >= 0 and layers[this] % LAYERS == STAIRS):
            misses[this] += 1
            if misses[this] >= frames:
                if found == gone.size:
                    gone = np.append(gone, np.empty(found, np.int32))
                gone[found] = this
                found += 1
    return gone[:found]


UNSEEN, THERE, THROUGH = 0, 1, 2
"""What a frame says of a voxel."""


class _Projection(NamedTuple):
    """From the world into the image: focal lengths and principal point, pixels."""

    focal_u: float
    focal_v: float
    center_u: float
    center_v: float


@njit(cache=True)
def _projection_of(frame: Frame) -> _Projection:
    # The rays' tangents are evenly spaced: a focal length in pixels is one over the spacing.
    focal_u = 1.0 / (frame.ray_x[1] - frame.ray_x[0])
    focal_v = 1.0 / (frame.ray_y[1] - frame.ray_y[0])
    return _Projection(
        focal_u, focal_v, -frame.ray_x[0] * focal_u + 0.5, -frame.ray_y[0] * focal_v + 0.5
    )


@njit(cache=True)
def _through_footprint(
    image: NDArray[np.float32],
    center: tuple[float, float],
    half: tuple[float, float],
    there: tuple[float, float],
) -> int:
    """What the whole footprint says; the depths `there` are the voxel's own, give or take."""
    seen = THROUGH
    for a in range(FOOTPRINT_SAMPLES):
        row = int(center[1] + half[1] * (2.0 * a / (FOOTPRINT_SAMPLES - 1) - 1.0))
        for b in range(FOOTPRINT_SAMPLES):
            column = int(center[0] + half[0] * (2.0 * b / (FOOTPRINT_SAMPLES - 1) - 1.0))
            depth = image[row, column]
            if depth <= 0.0 or depth < there[0]:
                return UNSEEN
            if depth <= there[1]:
                seen = THERE
    return seen
