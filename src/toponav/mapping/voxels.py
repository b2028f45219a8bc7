"""VoxelDownsample(M U new, r) of Section III-C, at the cost of the new points alone.

A voxel keeps the mean of all points that ever fell into it, and an update touches only the voxels
that the new points touch. Means are moved, not worked out anew from sums: that takes half the
memory, and nothing has to follow before the map can be looked at. Voxels are found through a hash
table with open addressing: integer coordinates packed into one key, linear probing.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple, TypeVar

import numpy as np
from numba import njit
from numpy.typing import NDArray

from toponav.errors import ObservationError
from toponav.mapping.storage import filled, lengthened
from toponav.mapping.view import PointCloud

Scalar = TypeVar("Scalar", bound=np.generic)

AXIS_BITS = 21
"""Bits of a packed key for each coordinate: three fit into 63."""

AXIS_OFFSET = 1 << (AXIS_BITS - 1)
"""Added to a coordinate to make it non-negative: a map reaches 2^20 voxels from its origin."""

AXIS_MASK = (1 << AXIS_BITS) - 1

SETTLED_COUNT = 1 << 24
"""A voxel that averages this many points takes no more: long before, one more point no longer moves
its mean."""

COLOR_STEPS = 256
"""A mean colour is kept in steps of 1 / 256: a rounded byte, and what rounding left."""

EMPTY = -1
"""What an unused entry of the hash table holds instead of a slot."""

GOLDEN = np.uint64(0x9E3779B97F4A7C15)
"""2^64 / golden ratio, the multiplier of Fibonacci hashing."""

INITIAL_CAPACITY = 1 << 10
"""Voxels that a new cloud has room for."""

BATCH = 1 << 16
"""Points that are added at a time: room is made for as many voxels."""

GROWTH = 1.25
"""Factor by which the storage grows."""

FULLEST = 0.5
"""Share of the hash table's entries in use, at most, so that probes stay short."""

VOXELS, TOUCHED = 0, 1
"""Entries of `VoxelArrays.sizes`."""

RECORD = np.dtype(
    [
        ("keys", "i8"),
        ("points", "f4", 3),
        ("counts", "i4"),
        ("colors", "u1", 3),
        ("color_rests", "i1", 3),
        ("is_touched", "?"),
        ("unused", "u1"),
    ]
)
"""What is known of a voxel, side by side, so that a look at it fetches one line of the cache and
not six: half of one, 32 bytes."""


class VoxelArrays(NamedTuple):
    """The storage of a `VoxelCloud` as kernels see it; C is the capacity, T the table's size.

    What has an entry a slot is a view of one array of `RECORD`.

    Attributes:
        table: (T,) int32 slot or EMPTY; T is a power of two.
        keys: (C,) int64 packed key of each slot; slots are numbered by first observation.
        points: (C, 3) float32 centroids.
        counts: (C,) int32 points averaged; 0 for a voxel that was emptied.
        colors: (C, 3) uint8 mean colours.
        color_rests: (C, 3) int8 what was left when they were rounded, in `COLOR_STEPS`.
        is_touched: (C,) bool whether a slot was touched since the last refresh.
        touched: (K,) int32 those slots, in order; K is as many as may be touched.
        sizes: (2,) int64 numbers of VOXELS and of TOUCHED slots.
    """

    table: NDArray[np.int32]
    keys: NDArray[np.int64]
    points: NDArray[np.float32]
    counts: NDArray[np.int32]
    colors: NDArray[np.uint8]
    color_rests: NDArray[np.int8]
    is_touched: NDArray[np.bool_]
    touched: NDArray[np.int32]
    sizes: NDArray[np.int64]


class VoxelSums(NamedTuple):
    """Sums of points by voxel, to be added to a cloud; a voxel may come up more than once.

    Attributes:
        keys: (N,) int64 packed key of the voxel.
        offset_sums: (N, 3) float64 sums of the points' offsets from the voxel's lower corner.
        color_sums: (N, 3) uint32.
        counts: (N,) int32 points summed.
    """

    keys: NDArray[np.int64]
    offset_sums: NDArray[np.float64]
    color_sums: NDArray[np.uint32]
    counts: NDArray[np.int32]


KEPT = ("keys", "points", "counts", "colors", "color_rests")
"""Those that make a cloud, in the order that `VoxelCloud.from_arrays` takes them."""

EVERY_POINT = np.zeros(0, np.uint32)
"""No labels: all sums are added."""


class VoxelCloud:
    """A point cloud downsampled to one centroid a voxel, grown point by point.

    Attributes:
        resolution: Edge of a voxel, metres.
        has_gaps: Whether slots were emptied.
    """

    def __init__(self, resolution: float) -> None:
        """Create an empty cloud of voxels with edges of `resolution` metres (r_pcd)."""
        self.resolution = resolution
        self._records = np.zeros(0, RECORD)
        self._arrays = VoxelArrays(
            table=np.zeros(0, np.int32),
            touched=np.zeros(0, np.int32),
            sizes=np.zeros(2, np.int64),
            **_views(self._records),
        )
        self.reserve(INITIAL_CAPACITY)
        self.has_gaps = False
        self._without_gaps: PointCloud | None = None

    @classmethod
    def from_arrays(cls, resolution: float, kept: Sequence[NDArray[Any]]) -> VoxelCloud:
        """A cloud from the arrays of another: those that `KEPT` names, of as many voxels.

        Raises:
            ValueError: The arrays do not belong together.
        """
        cloud = cls(resolution)
        size = len(kept[0])
        cloud.reserve(size)
        arrays = cloud._arrays
        for name, values in zip(KEPT, kept, strict=True):
            own = getattr(arrays, name)
            if values.shape != (size, *own.shape[1:]):
                raise ValueError("the arrays of a cloud do not belong together")
            own[:size] = values
        if (arrays.counts[:size] < 1).any():
            raise ValueError("the arrays of a cloud do not belong together")
        if len(np.unique(arrays.keys[:size])) != size:
            raise ValueError("a cloud holds a voxel twice")
        arrays.sizes[VOXELS] = size
        _rehash(arrays.table, arrays.keys, size)
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
        arrays = self._arrays
        return self._records.nbytes + arrays.table.nbytes + arrays.touched.nbytes

    def reserve(self, voxels: int) -> None:
        """Make room for that many further voxels, touched too; grows storage that is too small."""
        arrays = self._arrays
        needed, capacity = len(self) + voxels, len(arrays.keys)
        if needed > capacity:
            capacity = max(needed, int(GROWTH * capacity))
            self._records = lengthened(self._records, capacity)
            arrays = arrays._replace(**_views(self._records))
        if needed > FULLEST * len(arrays.table):
            entries = 1 << int(needed / FULLEST).bit_length()
            arrays = arrays._replace(table=filled(entries, np.int32(EMPTY)))
            _rehash(arrays.table, arrays.keys, len(self))
        may_be_touched = int(arrays.sizes[TOUCHED]) + voxels
        if may_be_touched > len(arrays.touched):
            room = max(may_be_touched, 2 * len(arrays.touched))
            arrays = arrays._replace(touched=lengthened(arrays.touched, room))
        self._arrays = arrays

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
        self._without_gaps = None
        for start in range(0, len(xyz), BATCH):
            batch = xyz[start : start + BATCH]
            self.reserve(len(batch))
            keys = _keys_of(batch, self.resolution)
            slots = _claim_slots(self._arrays, keys, EVERY_POINT, 0)
            _add_points(self._arrays, slots, batch, rgb[start : start + BATCH])

    def add_sums(
        self, sums: VoxelSums, labels: NDArray[np.uint32] = EVERY_POINT, label: int = 0
    ) -> int:
        """Add points that are summed already, with keys as `pack_key` makes them.

        Args:
            sums: N of them.
            labels: (N,) labels of the sums, a bit each; empty to add them all.
            label: The bit of the label whose sums are added.

        Returns:
            How many were added.
        """
        chosen = len(sums.keys) if labels is EVERY_POINT else _count_labelled(labels, label)
        if chosen:
            self._without_gaps = None
            self.reserve(chosen)
            slots = _claim_slots(self._arrays, sums.keys, labels, label)
            _add_sums(self._arrays, slots, self.resolution, sums)
        return chosen

    def one_of_each(self, slots: NDArray[np.int32]) -> VoxelSums:
        """A point of each voxel, its centroid, for another cloud of the same resolution."""
        arrays = self._arrays
        keys = arrays.keys[slots]
        corners = unpack_keys(keys) * self.resolution
        return VoxelSums(
            keys=keys,
            offset_sums=arrays.points[slots] - corners,
            color_sums=arrays.colors[slots].astype(np.uint32),
            counts=np.ones(len(slots), np.int32),
        )

    def clear(self, slots: NDArray[np.int32]) -> None:
        """Empty voxels; their slots stay, and take points again when some come."""
        if not len(slots):
            return
        self.has_gaps, self._without_gaps = True, None
        self._arrays.counts[slots] = 0

    def find(self, keys: NDArray[np.int64]) -> NDArray[np.int32]:
        """(N,) slots of the voxels of (N,) keys; EMPTY for those not in the cloud."""
        return _find_slots(self._arrays.table, self._arrays.keys, keys)

    def refresh(self) -> NDArray[np.int32]:
        """The slots touched since the last call, in that order, each once."""
        arrays = self._arrays
        slots = arrays.touched[: arrays.sizes[TOUCHED]].copy()
        _untouch(arrays.is_touched, slots)
        arrays.sizes[TOUCHED] = 0
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


def lowest_of(keys: NDArray[np.int64]) -> float:
    """Least integer z of the voxels of (N,) keys; infinite without any."""
    if not len(keys):
        return np.inf
    return float((keys & AXIS_MASK).min() - AXIS_OFFSET)


def _views(records: NDArray[np.void]) -> dict[str, NDArray[Any]]:
    """The arrays of `VoxelArrays` that have an entry a slot."""
    return {name: records[name] for name in RECORD.names or () if name != "unused"}


@njit(cache=True)
def pack_key(ix: int, iy: int, iz: int) -> int:
    """The key of voxel (ix, iy, iz)."""
    return (
        ((ix + AXIS_OFFSET) << (2 * AXIS_BITS))
        | ((iy + AXIS_OFFSET) << AXIS_BITS)
        | (iz + AXIS_OFFSET)
    )


@njit(cache=True)
def column_of(key: int) -> tuple[int, int]:
    """Integer x and y of the voxel of a key."""
    x = ((key >> (2 * AXIS_BITS)) & AXIS_MASK) - AXIS_OFFSET
    return x, ((key >> AXIS_BITS) & AXIS_MASK) - AXIS_OFFSET


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
def _claim_slots(
    arrays: VoxelArrays, wanted: NDArray[np.int64], labels: NDArray[np.uint32], label: int
) -> NDArray[np.int32]:
    """(N,) slots of voxels by key, made if they are new, and marked as touched.

    There must be room. Where there are labels, only those with the label are looked at; the others
    get `EMPTY`. All in one loop: an array that is handed to a function is counted up and down,
    which in a loop can cost ten times what is done with it.
    """
    table, keys, _, _, _, _, is_touched, touched, sizes = arrays
    slots = np.full(wanted.size, EMPTY, np.int32)
    mask = np.uint32(1) << np.uint32(label)
    size, touched_size = sizes[VOXELS], sizes[TOUCHED]
    for row in range(wanted.size):
        if labels.size and not labels[row] & mask:
            continue
        entry = _entry_of(table, keys, wanted[row])
        slot = table[entry]
        if slot == EMPTY:
            slot = size
            size += 1
            table[entry], keys[slot] = slot, wanted[row]
        if not is_touched[slot]:
            is_touched[slot] = True
            touched[touched_size] = slot
            touched_size += 1
        slots[row] = slot
    sizes[VOXELS], sizes[TOUCHED] = size, touched_size
    return slots


@njit(cache=True)
def _untouch(is_touched: NDArray[np.bool_], slots: NDArray[np.int32]) -> None:
    """Unmark slots: several times as fast as by an index."""
    for slot in slots:
        is_touched[slot] = False


@njit(cache=True)
def _rehash(table: NDArray[np.int32], keys: NDArray[np.int64], size: int) -> None:
    for slot in range(size):
        table[_entry_of(table, keys, keys[slot])] = slot


@njit(cache=True)
def _keys_of(points: NDArray[np.float64], resolution: float) -> NDArray[np.int64]:
    """(N,) keys of the voxels that (N, 3) points lie in."""
    keys = np.empty(points.shape[0], np.int64)
    for row in range(points.shape[0]):
        ix = int(np.floor(points[row, 0] / resolution))
        iy = int(np.floor(points[row, 1] / resolution))
        iz = int(np.floor(points[row, 2] / resolution))
        keys[row] = pack_key(ix, iy, iz)
    return keys


@njit(cache=True, error_model="numpy")
def _add_points(
    arrays: VoxelArrays,
    slots: NDArray[np.int32],
    new: NDArray[np.float64],
    new_colors: NDArray[np.uint8],
) -> None:
    _, _, points, counts, colors, color_rests, _, _, _ = arrays
    for row in range(slots.size):
        slot = slots[row]
        total = counts[slot] + 1
        if total > SETTLED_COUNT:
            continue
        counts[slot] = total
        for axis in range(3):
            known = 0.0 if total == 1 else float(points[slot, axis])
            points[slot, axis] = known + (new[row, axis] - known) / total
            colors[slot, axis], color_rests[slot, axis] = _mixed(
                colors[slot, axis], color_rests[slot, axis], new_colors[row, axis], 1.0 / total
            )


@njit(cache=True)
def _count_labelled(labels: NDArray[np.uint32], label: int) -> int:
    """How many have a label."""
    count = 0
    for index in range(labels.size):
        count += int((labels[index] >> np.uint32(label)) & np.uint32(1))
    return count


@njit(cache=True, error_model="numpy")
def _add_sums(
    arrays: VoxelArrays, slots: NDArray[np.int32], resolution: float, sums: VoxelSums
) -> None:
    """Add the sums that have a slot."""
    _, _, points, counts, colors, color_rests, _, _, _ = arrays
    new_keys, offset_sums, color_sums, new_counts = sums
    for row in range(slots.size):
        slot, new = slots[row], new_counts[row]
        if slot == EMPTY or counts[slot] + new > SETTLED_COUNT:
            continue
        counts[slot] += new
        share, weight = 1.0 / new, new / counts[slot]
        for axis in range(3):
            index = ((new_keys[row] >> (AXIS_BITS * (2 - axis))) & AXIS_MASK) - AXIS_OFFSET
            mean = index * resolution + offset_sums[row, axis] * share
            known = float(points[slot, axis])
            points[slot, axis] = mean if weight == 1.0 else known + (mean - known) * weight
            colors[slot, axis], color_rests[slot, axis] = _mixed(
                colors[slot, axis],
                color_rests[slot, axis],
                color_sums[row, axis] * share,
                weight,
            )


@njit(cache=True)
def _mixed(color: int, rest: int, other: float, weight: float) -> tuple[int, int]:
    """A mean colour and its rest, moved towards another by that other's weight."""
    known = float(color * COLOR_STEPS + rest)
    steps = int(known + (COLOR_STEPS * other - known) * weight + 0.5)
    rounded = (steps + COLOR_STEPS // 2) // COLOR_STEPS
    return rounded, steps - rounded * COLOR_STEPS
