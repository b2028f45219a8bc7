"""VoxelDownsample(M U new, r) of Section III-C, at the cost of the new points alone.

A voxel keeps the sums of all points that ever fell into it, so its centroid is exact and an update
touches only the voxels that the new points touch. Voxels are found through a hash table with open
addressing: integer coordinates packed into one key, linear probing.
"""

from __future__ import annotations

from typing import NamedTuple, TypeVar

import numpy as np
from numba import njit
from numpy.typing import NDArray

from toponav.errors import ObservationError
from toponav.mapping.view import PointCloud

Scalar = TypeVar("Scalar", bound=np.generic)

AXIS_BITS = 21
"""Bits of a packed key for each coordinate: three fit into 63."""

AXIS_OFFSET = 1 << (AXIS_BITS - 1)
"""Added to a coordinate to make it non-negative: a map reaches 2^20 voxels from its origin."""

AXIS_MASK = (1 << AXIS_BITS) - 1

SETTLED_COUNT = 1 << 24
"""A voxel that averages this many points takes no more: 2^24 * 255 is the last colour sum that
32 bits hold, and by then one more point no longer moves the mean."""

EMPTY = -1
"""What an unused entry of the hash table holds instead of a slot."""

GOLDEN = np.uint64(0x9E3779B97F4A7C15)
"""2^64 / golden ratio, the multiplier of Fibonacci hashing."""

INITIAL_CAPACITY = 1 << 10
"""Voxels that a new cloud has room for."""

GROWTH = 1.5
"""Factor by which the storage grows."""

ENTRIES_PER_VOXEL = 2
"""Least number of hash table entries a voxel: at most half full, so that probes stay short."""

VOXELS, TOUCHED = 0, 1
"""Entries of `VoxelArrays.sizes`."""


class VoxelArrays(NamedTuple):
    """The storage of a `VoxelCloud` as kernels see it; C is the capacity, T the table's size.

    Attributes:
        table: (T,) int32 slot or EMPTY; T is a power of two.
        keys: (C,) int64 packed key of each slot; slots are numbered by first observation.
        offset_sums: (C, 3) float64 sums of the points' offsets from the voxel's lower corner.
        color_sums: (C, 3) uint32.
        counts: (C,) int32 points summed.
        points: (C, 3) float32 centroids, up to date except for the touched slots.
        colors: (C, 3) uint8 mean colours, likewise.
        touched: (C,) int32 slots touched since the last refresh, in order.
        is_touched: (C,) bool whether a slot is among them.
        sizes: (2,) int64 numbers of VOXELS and of TOUCHED slots.
    """

    table: NDArray[np.int32]
    keys: NDArray[np.int64]
    offset_sums: NDArray[np.float64]
    color_sums: NDArray[np.uint32]
    counts: NDArray[np.int32]
    points: NDArray[np.float32]
    colors: NDArray[np.uint8]
    touched: NDArray[np.int32]
    is_touched: NDArray[np.bool_]
    sizes: NDArray[np.int64]


class VoxelSums(NamedTuple):
    """Sums of points by voxel, to be added to a cloud; a voxel may come up more than once.

    Attributes:
        keys: (N,) int64 packed key of the voxel.
        offset_sums: (N, 3) float64, as in `VoxelArrays`.
        color_sums: (N, 3) uint32.
        counts: (N,) int32 points summed.
    """

    keys: NDArray[np.int64]
    offset_sums: NDArray[np.float64]
    color_sums: NDArray[np.uint32]
    counts: NDArray[np.int32]


PER_SLOT = tuple(name for name in VoxelArrays._fields if name not in ("table", "sizes"))
"""The arrays of `VoxelArrays` that have an entry a slot."""


class VoxelCloud:
    """A point cloud downsampled to one centroid a voxel, grown point by point.

    Attributes:
        resolution: Edge of a voxel, metres.
        has_gaps: Whether slots were emptied.
    """

    def __init__(self, resolution: float) -> None:
        """Create an empty cloud of voxels with edges of `resolution` metres (r_pcd)."""
        self.resolution = resolution
        self._arrays = _allocate(INITIAL_CAPACITY)
        self.has_gaps = False
        self._without_gaps: PointCloud | None = None

    @classmethod
    def from_sums(
        cls,
        resolution: float,
        keys: NDArray[np.int64],
        offset_sums: NDArray[np.float64],
        color_sums: NDArray[np.uint32],
        counts: NDArray[np.int32],
    ) -> VoxelCloud:
        """A cloud from the arrays of another, as `VoxelArrays` describes them.

        Raises:
            ValueError: The arrays do not belong together.
        """
        shapes = (keys.shape, offset_sums.shape, color_sums.shape, counts.shape)
        size = len(keys)
        if shapes != ((size,), (size, 3), (size, 3), (size,)) or (counts < 1).any():
            raise ValueError("the arrays of a cloud do not belong together")
        if len(np.unique(keys)) != size:
            raise ValueError("a cloud holds a voxel twice")
        cloud = cls(resolution)
        cloud.reserve(size)
        arrays = cloud._arrays
        arrays.keys[:size], arrays.counts[:size] = keys, counts
        arrays.offset_sums[:size], arrays.color_sums[:size] = offset_sums, color_sums
        arrays.sizes[:] = size
        arrays.touched[:size], arrays.is_touched[:size] = np.arange(size), True
        _rehash(arrays)
        cloud.refresh()
        return cloud

    def __len__(self) -> int:
        """Slots, which are voxels but for those that `clear` emptied."""
        return int(self._arrays.sizes[VOXELS])

    @property
    def arrays(self) -> VoxelArrays:
        """The storage, for kernels; `reserve` and growth replace it."""
        return self._arrays

    @property
    def nbytes(self) -> int:
        """Memory held, bytes."""
        return sum(array.nbytes for array in self._arrays)

    def reserve(self, voxels: int) -> None:
        """Make room for that many further voxels; grows the storage when it is too small."""
        needed, capacity = len(self) + voxels, len(self._arrays.keys)
        if needed > capacity:
            self._arrays = _grown(self._arrays, max(needed, int(GROWTH * capacity)))

    def add(self, points: NDArray[np.floating], colors: NDArray[np.uint8] | None = None) -> None:
        """Average points into their voxels.

        Args:
            points: (N, 3) world frame, metres.
            colors: (N, 3); black when left out.

        Raises:
            ObservationError: A coordinate is not finite or out of reach.
        """
        xyz = np.ascontiguousarray(points, dtype=np.float64)
        rgb = np.zeros(xyz.shape, np.uint8) if colors is None else np.ascontiguousarray(colors)
        reach = reach_m(self.resolution)
        if len(xyz) and not np.abs(xyz).max() < reach:
            raise ObservationError(
                f"points must be finite and within {reach:.0f} m of the map's origin: "
                "move the world frame's origin nearer"
            )
        start = 0
        while start < len(xyz):
            self.reserve(min(len(xyz) - start, INITIAL_CAPACITY))
            start = _add_points(self._arrays, self.resolution, xyz, rgb, start)

    def add_sums(self, sums: VoxelSums) -> None:
        """Add points that are summed already, with keys as `pack_key` makes them."""
        self.reserve(len(sums.keys))
        _add_sums(self._arrays, sums)

    def clear(self, slots: NDArray[np.int32]) -> None:
        """Empty voxels; their slots stay, and take points again when some come."""
        if not len(slots):
            return
        arrays = self._arrays
        self.has_gaps, self._without_gaps = True, None
        arrays.counts[slots] = 0
        arrays.offset_sums[slots], arrays.color_sums[slots] = 0.0, 0

    def find(self, keys: NDArray[np.int64]) -> NDArray[np.int32]:
        """(N,) slots of the voxels of (N,) keys; EMPTY for those not in the cloud."""
        return _find_slots(self._arrays.table, self._arrays.keys, keys)

    def refresh(self) -> NDArray[np.int32]:
        """Bring the centroids of the touched voxels up to date.

        Returns:
            Their slots, in the order in which they were touched, each once.
        """
        count = int(self._arrays.sizes[TOUCHED])
        if count:
            self._without_gaps = None
        slots = self._arrays.touched[:count].copy()
        _update_centroids(self._arrays, self.resolution)
        return slots

    def cloud(self) -> PointCloud:
        """All centroids in order of first observation.

        Mostly read-only views of the live storage, which further points may change in place; copy
        what must not change.
        """
        slots = self.slots()
        if not self.has_gaps:
            return slots
        if self._without_gaps is None:
            kept = slots.counts > 0
            points, colors, counts = slots.points[kept], slots.colors[kept], slots.counts[kept]
            self._without_gaps = PointCloud(frozen(points), frozen(colors), frozen(counts))
        return self._without_gaps

    def slots(self) -> PointCloud:
        """All slots, with a count of 0 for those that were emptied: views of the live storage."""
        self.refresh()
        size, arrays = len(self), self._arrays
        return PointCloud(
            frozen(arrays.points[:size]),
            frozen(arrays.colors[:size]),
            frozen(arrays.counts[:size]),
        )


def reach_m(resolution: float) -> float:
    """Largest absolute coordinate that a cloud of such voxels can hold, metres."""
    return (AXIS_OFFSET - 1) * resolution


def frozen(array: NDArray[Scalar]) -> NDArray[Scalar]:
    """A read-only view of an array."""
    view = array.view()
    view.setflags(write=False)
    return view


def unpack_keys(keys: NDArray[np.int64]) -> NDArray[np.int64]:
    """(N, 3) integer voxel coordinates of (N,) keys."""
    shifts = np.array([2 * AXIS_BITS, AXIS_BITS, 0])
    coordinates: NDArray[np.int64] = ((keys[:, None] >> shifts) & AXIS_MASK) - AXIS_OFFSET
    return coordinates


def columns_of(keys: NDArray[np.int64]) -> NDArray[np.int64]:
    """(N, 2) integer x and y of the voxels of (N,) keys."""
    return unpack_keys(keys)[:, :2]


def _allocate(capacity: int) -> VoxelArrays:
    """Empty storage for `capacity` voxels."""
    entries = 1 << (ENTRIES_PER_VOXEL * capacity - 1).bit_length()
    return VoxelArrays(
        table=np.full(entries, EMPTY, np.int32),
        keys=np.zeros(capacity, np.int64),
        offset_sums=np.zeros((capacity, 3), np.float64),
        color_sums=np.zeros((capacity, 3), np.uint32),
        counts=np.zeros(capacity, np.int32),
        points=np.zeros((capacity, 3), np.float32),
        colors=np.zeros((capacity, 3), np.uint8),
        touched=np.zeros(capacity, np.int32),
        is_touched=np.zeros(capacity, np.bool_),
        sizes=np.zeros(2, np.int64),
    )


def _grown(old: VoxelArrays, capacity: int) -> VoxelArrays:
    """A copy of the storage with a larger capacity."""
    new = _allocate(capacity)
    size = int(old.sizes[VOXELS])
    for name in PER_SLOT:
        getattr(new, name)[:size] = getattr(old, name)[:size]
    new.sizes[:] = old.sizes
    _rehash(new)
    return new


@njit(cache=True)
def pack_key(ix: int, iy: int, iz: int) -> int:
    """The key of voxel (ix, iy, iz)."""
    return (
        ((ix + AXIS_OFFSET) << (2 * AXIS_BITS))
        | ((iy + AXIS_OFFSET) << AXIS_BITS)
        | (iz + AXIS_OFFSET)
    )


@njit(cache=True)
def _entry_of(table: NDArray[np.int32], keys: NDArray[np.int64], key: int) -> int:
    """The table entry that holds `key`, or the empty one where it belongs.

    Two rounds of Fibonacci hashing (Knuth, TAOCP vol. 3, 6.4): after one, ix, which lies in the
    key's top bits, would hardly reach the bits that choose the entry.
    """
    mixed = np.uint64(key) * GOLDEN
    mixed = (mixed ^ (mixed >> np.uint64(32))) * GOLDEN
    mask = table.size - 1
    entry = int(np.int64(mixed >> np.uint64(32))) & mask
    while table[entry] != EMPTY and keys[table[entry]] != key:
        entry = (entry + 1) & mask
    return entry


@njit(cache=True)
def find_slot(table: NDArray[np.int32], keys: NDArray[np.int64], key: int) -> int:
    """The slot of a voxel, or EMPTY."""
    return int(table[_entry_of(table, keys, key)])


@njit(cache=True)
def _find_slots(
    table: NDArray[np.int32], keys: NDArray[np.int64], wanted: NDArray[np.int64]
) -> NDArray[np.int32]:
    found = np.empty(wanted.size, np.int32)
    for row in range(wanted.size):
        found[row] = table[_entry_of(table, keys, wanted[row])]
    return found


@njit(cache=True)
def claim_slot(
    table: NDArray[np.int32],
    keys: NDArray[np.int64],
    touched: NDArray[np.int32],
    is_touched: NDArray[np.bool_],
    sizes: NDArray[np.int64],
    key: int,
) -> int:
    """The slot of a voxel, made if it is new, and marked as touched. There must be room.

    Takes the arrays one by one: passing the tuple costs a kernel's inner loop a third of its time.
    """
    entry = _entry_of(table, keys, key)
    slot = int(table[entry])
    if slot == EMPTY:
        slot = int(sizes[VOXELS])
        sizes[VOXELS] += 1
        table[entry] = slot
        keys[slot] = key
    if not is_touched[slot]:
        is_touched[slot] = True
        touched[sizes[TOUCHED]] = slot
        sizes[TOUCHED] += 1
    return slot


@njit(cache=True)
def _rehash(arrays: VoxelArrays) -> None:
    for slot in range(arrays.sizes[VOXELS]):
        arrays.table[_entry_of(arrays.table, arrays.keys, arrays.keys[slot])] = slot


@njit(cache=True)
def _add_points(
    arrays: VoxelArrays,
    resolution: float,
    points: NDArray[np.float64],
    colors: NDArray[np.uint8],
    start: int,
) -> int:
    """Add points from `start` on while there is room; returns the first that was not added."""
    table, keys, offset_sums, color_sums, counts, _, _, touched, is_touched, sizes = arrays
    stop = int(min(points.shape[0], start + keys.size - sizes[VOXELS]))
    for index in range(start, stop):
        x, y, z = points[index, 0], points[index, 1], points[index, 2]
        ix = int(np.floor(x / resolution))
        iy = int(np.floor(y / resolution))
        iz = int(np.floor(z / resolution))
        slot = claim_slot(table, keys, touched, is_touched, sizes, pack_key(ix, iy, iz))
        if counts[slot] < SETTLED_COUNT:
            counts[slot] += 1
            offset_sums[slot, 0] += x - ix * resolution
            offset_sums[slot, 1] += y - iy * resolution
            offset_sums[slot, 2] += z - iz * resolution
            for channel in range(3):
                color_sums[slot, channel] += colors[index, channel]
    return stop


@njit(cache=True)
def _add_sums(arrays: VoxelArrays, sums: VoxelSums) -> None:
    table, keys, offset_sums, color_sums, counts, _, _, touched, is_touched, sizes = arrays
    for index in range(sums.keys.size):
        slot = claim_slot(table, keys, touched, is_touched, sizes, sums.keys[index])
        if counts[slot] + sums.counts[index] <= SETTLED_COUNT:
            counts[slot] += sums.counts[index]
            for axis in range(3):
                offset_sums[slot, axis] += sums.offset_sums[index, axis]
                color_sums[slot, axis] += sums.color_sums[index, axis]


@njit(cache=True)
def _update_centroids(arrays: VoxelArrays, resolution: float) -> None:
    """Recompute the touched slots' centroids and colours, and clear the list."""
    for position in range(arrays.sizes[TOUCHED]):
        slot = arrays.touched[position]
        key, count = arrays.keys[slot], int(arrays.counts[slot])
        arrays.is_touched[slot] = False
        if count == 0:
            continue
        for axis in range(3):
            index = ((key >> (AXIS_BITS * (2 - axis))) & AXIS_MASK) - AXIS_OFFSET
            offset = arrays.offset_sums[slot, axis] / count
            arrays.points[slot, axis] = index * resolution + offset
            color_sum = int(arrays.color_sums[slot, axis])
            arrays.colors[slot, axis] = (2 * color_sum + count) // (2 * count)
    arrays.sizes[TOUCHED] = 0
