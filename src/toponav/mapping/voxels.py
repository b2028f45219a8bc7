"""Voxel-downsampled clouds that grow point by point: VoxelDownsample(M u new, r) of Sec. III-C.

A voxel keeps the sum and the number of all points that ever fell into it, so its point is the exact
centroid whatever the order and batching of insertions. Storage is a hash table from voxel to slot;
slots are handed out in the order of first observation and never move.
"""

from __future__ import annotations

from typing import Any, NamedTuple, TypeVar

import numpy as np
from numba import njit
from numpy.typing import ArrayLike, NDArray

from toponav.mapping.view import PointCloud

INITIAL_CAPACITY = 1 << 13
TABLE_LOAD = 4
"""Table entries a slot: at most a quarter full, so probes stay short."""

COORDINATE_BITS = 18
"""Bits a voxel coordinate: 2^17 voxels of 5 cm each way are 6.5 km."""
TAG_BITS = 9
"""Bits of the tag (an object class) in a key."""
MAX_TAGS = 1 << TAG_BITS

_HALF = 1 << (COORDINATE_BITS - 1)
_MULTIPLIER = np.uint64(0x9E3779B97F4A7C15)
"""2^64 divided by the golden ratio: Fibonacci hashing."""
_HASH_SHIFT = np.uint64(20)


class VoxelStore(NamedTuple):
    """The arrays of a cloud, as kernels take them; C is the capacity.

    Attributes:
        keys: (TABLE_LOAD * C,) int64 voxel keys.
        slots: (TABLE_LOAD * C,) int32 slot of the key, -1 where the entry is empty.
        voxels: (C, 3) int32 voxel coordinates.
        tags: (C,) int16.
        sums: (C, 3) float64 summed offsets from the voxel's corner, metres.
        color_sums: (C, 3) int64.
        counts: (C,) int32.
        stamps: (C,) int32 number of the batch that touched the slot last.
        touched: (C,) int32 slots touched by the current batch.
        header: [slots in use, slots touched, number of the current batch], int64.
    """

    keys: NDArray[np.int64]
    slots: NDArray[np.int32]
    voxels: NDArray[np.int32]
    tags: NDArray[np.int16]
    sums: NDArray[np.float64]
    color_sums: NDArray[np.int64]
    counts: NDArray[np.int32]
    stamps: NDArray[np.int32]
    touched: NDArray[np.int32]
    header: NDArray[np.int64]


@njit(cache=True)
def _entry(store: VoxelStore, key: int) -> int:
    """Table entry of a key, or the empty one where it belongs."""
    mask = len(store.keys) - 1
    index = np.int64((np.uint64(key) * _MULTIPLIER) >> _HASH_SHIFT) & mask
    while store.slots[index] >= 0 and store.keys[index] != key:
        index = (index + 1) & mask
    return int(index)


@njit(cache=True)
def find_slot(store: VoxelStore, ix: int, iy: int, iz: int, tag: int) -> int:
    """Slot of a voxel, a new one if it has none; the caller has made sure that there is room."""
    key = (
        ((((ix + _HALF) << COORDINATE_BITS) | (iy + _HALF)) << COORDINATE_BITS) | (iz + _HALF)
    ) << TAG_BITS | tag
    index = _entry(store, key)
    slot = store.slots[index]
    if slot < 0:
        slot = store.header[0]
        store.header[0] += 1
        store.keys[index] = key
        store.slots[index] = slot
        store.voxels[slot, 0] = ix
        store.voxels[slot, 1] = iy
        store.voxels[slot, 2] = iz
        store.tags[slot] = tag
    return int(slot)


@njit(cache=True)
def insert_point(
    store: VoxelStore,
    point: tuple[float, float, float],
    color: tuple[int, int, int],
    tag: int,
    resolution: float,
) -> int:
    """Add one point to its voxel and mark the voxel as touched; returns the slot."""
    x, y, z = point
    ix = int(np.floor(x / resolution))
    iy = int(np.floor(y / resolution))
    iz = int(np.floor(z / resolution))
    slot = find_slot(store, ix, iy, iz, tag)
    store.sums[slot, 0] += x - ix * resolution
    store.sums[slot, 1] += y - iy * resolution
    store.sums[slot, 2] += z - iz * resolution
    store.color_sums[slot, 0] += color[0]
    store.color_sums[slot, 1] += color[1]
    store.color_sums[slot, 2] += color[2]
    store.counts[slot] += 1
    if store.stamps[slot] != store.header[2]:
        store.stamps[slot] = store.header[2]
        store.touched[store.header[1]] = slot
        store.header[1] += 1
    return slot


@njit(cache=True)
def _insert_points(
    store: VoxelStore,
    points: NDArray[np.float64],
    colors: NDArray[np.uint8],
    tag: int,
    resolution: float,
    start: int,
) -> int:
    """Insert points from `start` on; returns where it stopped for lack of room."""
    for i in range(start, len(points)):
        if store.header[0] >= len(store.counts):
            return i
        point = (points[i, 0], points[i, 1], points[i, 2])
        color = (int(colors[i, 0]), int(colors[i, 1]), int(colors[i, 2]))
        insert_point(store, point, color, tag, resolution)
    return len(points)


@njit(cache=True)
def _average_touched(
    store: VoxelStore, points: NDArray[np.float32], colors: NDArray[np.uint8], resolution: float
) -> None:
    """Refresh the centroids and mean colours of the touched slots."""
    for k in range(store.header[1]):
        slot = store.touched[k]
        n = store.counts[slot]
        for axis in range(3):
            corner = store.voxels[slot, axis] * resolution
            points[slot, axis] = corner + store.sums[slot, axis] / n
            colors[slot, axis] = (store.color_sums[slot, axis] + n // 2) // n


@njit(cache=True)
def _rehash(old: VoxelStore, new: VoxelStore) -> None:
    """Enter all of the old table's keys into the new one."""
    for k in range(len(old.keys)):
        if old.slots[k] >= 0:
            index = _entry(new, old.keys[k])
            new.keys[index] = old.keys[k]
            new.slots[index] = old.slots[k]


def _allocate(capacity: int) -> VoxelStore:
    return VoxelStore(
        keys=np.zeros(TABLE_LOAD * capacity, np.int64),
        slots=np.full(TABLE_LOAD * capacity, -1, np.int32),
        voxels=np.zeros((capacity, 3), np.int32),
        tags=np.zeros(capacity, np.int16),
        sums=np.zeros((capacity, 3), np.float64),
        color_sums=np.zeros((capacity, 3), np.int64),
        counts=np.zeros(capacity, np.int32),
        stamps=np.zeros(capacity, np.int32),
        touched=np.zeros(capacity, np.int32),
        header=np.array([0, 0, 1], np.int64),
    )


class VoxelCloud:
    """A growing, voxel-downsampled, coloured cloud whose points may carry a tag.

    Points with different tags never share a voxel, so that one cloud holds all object classes.
    A batch is: any number of insertions, then `finish`, which refreshes the points.
    """

    def __init__(self, resolution: float) -> None:
        """Start empty; `resolution` is r_pcd in metres."""
        self.resolution = resolution
        self.store = _allocate(INITIAL_CAPACITY)
        self._points = np.zeros((INITIAL_CAPACITY, 3), np.float32)
        self._colors = np.zeros((INITIAL_CAPACITY, 3), np.uint8)

    def __len__(self) -> int:
        return int(self.store.header[0])

    def add(self, points: ArrayLike, colors: ArrayLike | None = None, tag: int = 0) -> None:
        """Insert (N, 3) points in metres with (N, 3) uint8 colours, black by default."""
        xyz = np.ascontiguousarray(points, dtype=np.float64).reshape(-1, 3)
        rgb = np.zeros(xyz.shape, np.uint8) if colors is None else np.asarray(colors, np.uint8)
        done = 0
        while (done := _insert_points(self.store, xyz, rgb, tag, self.resolution, done)) < len(xyz):
            self.grow()
        self.finish()

    def make_room(self) -> None:
        """Grow if there is no room for one more voxel."""
        if len(self) >= len(self.store.counts):
            self.grow()

    def grow(self) -> None:
        """Double the capacity; slots keep their numbers."""
        old, size = self.store, len(self)
        capacity = 2 * len(old.counts)
        new = _allocate(capacity)
        for name in ("voxels", "tags", "sums", "color_sums", "counts", "stamps", "touched"):
            source = getattr(old, name)
            getattr(new, name)[: len(source)] = source
        new.header[:] = old.header
        _rehash(old, new)
        self.store = new
        points, colors = np.zeros((capacity, 3), np.float32), np.zeros((capacity, 3), np.uint8)
        points[:size], colors[:size] = self._points[:size], self._colors[:size]
        self._points, self._colors = points, colors

    def finish(self) -> NDArray[np.int32]:
        """End a batch of insertions; returns the touched slots, in the order of first touch."""
        _average_touched(self.store, self._points, self._colors, self.resolution)
        touched = self.store.touched[: self.store.header[1]].copy()
        self.store.header[1] = 0
        self.store.header[2] += 1
        return touched

    def at(self, slots: NDArray[np.integer]) -> PointCloud:
        """The points of some slots, copied."""
        return PointCloud(
            _read_only(self._points[slots]),
            _read_only(self._colors[slots]),
            _read_only(self.store.counts[slots]),
        )

    def cloud(self) -> PointCloud:
        """All points, as read-only views of the storage."""
        n = len(self)
        return PointCloud(
            _read_only(self._points[:n]),
            _read_only(self._colors[:n]),
            _read_only(self.store.counts[:n]),
        )

    def tagged(self, tag: int) -> PointCloud:
        """The points of one tag, copied."""
        return self.at(np.flatnonzero(self.store.tags[: len(self)] == tag))


ArrayT = TypeVar("ArrayT", bound=NDArray[Any])


def _read_only(array: ArrayT) -> ArrayT:
    view = array.view()
    view.setflags(write=False)
    return view
