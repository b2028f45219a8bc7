"""Floors, and which part of the scene belongs to which (Section III-C).

A voxel of M_scene belongs to the highest floor whose band it reaches from below, and there to one
of the paper's layers by the height of its centroid:

    navigable  |z - z_floor| <= delta
    obstacle   z_floor + delta < z < z_floor + obstacle_top
    stairs     labelled with a category of C_nav: navigable at any height, never an obstacle,
               on the floor that it rises from and on the one that it leads to
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum

import numpy as np
from numba import njit
from numpy.typing import NDArray

from toponav.mapping.frontiers import FrontierMap
from toponav.mapping.occupancy import FloorGrid
from toponav.mapping.storage import lengthened
from toponav.mapping.voxels import EMPTY, VoxelCloud, column_of, find_slot


class Layer(IntEnum):
    """What a voxel is to its floor."""

    NAVIGABLE = 0
    OBSTACLE = 1
    STAIRS = 2


NAVIGABLE, OBSTACLE, STAIRS = (int(layer) for layer in Layer)
LAYERS = len(Layer)
"""A voxel's code is its floor's index times LAYERS plus its layer."""

NO_LAYER = -1
"""Code of a voxel that concerns no floor: over an agent's head, or under the lowest floor."""


@dataclass(frozen=True, eq=False)
class Floor:
    """One storey.

    Attributes:
        index: Number in the order of discovery; stable.
        z: z_floor, metres.
        grid: G.
        frontiers: M_fro.
        bridges: Interpolated points of M_nav, and those under the agent's feet.
        treads: Where the agent stood above or below the floor's height.
    """

    index: int
    z: float
    grid: FloorGrid
    frontiers: FrontierMap
    bridges: VoxelCloud
    treads: VoxelCloud


class FloorLayers:
    """Keeps the floor and layer of every scene voxel, and with them the grids of the floors."""

    def __init__(self, scene: VoxelCloud, delta: float, obstacle_top: float) -> None:
        """Start without floors.

        Args:
            scene: M_scene; its slots are what this class speaks of.
            delta: Half the height of the navigable band, metres.
            obstacle_top: Height over the floor from which on nothing is in the way, metres.
        """
        self._scene = scene
        self._heights = (delta, obstacle_top)
        self._floors: list[Floor] = []
        self._counted: list[tuple[NDArray[np.bool_], NDArray[np.bool_]]] = []
        """Of each floor, which codes are navigable and which are in the way there."""
        self._ascending = (np.empty(0), np.empty(0, np.int64))
        """Heights and indices of the floors, the lowest first."""
        self._codes = np.empty(0, np.int16)
        self._is_stairs = np.empty(0, np.bool_)
        self._stairs = np.empty(0, np.int64)

    @property
    def floors(self) -> tuple[Floor, ...]:
        """All floors, in the order of discovery."""
        return tuple(self._floors)

    @property
    def codes(self) -> NDArray[np.int16]:
        """A code a slot, of the scene's storage."""
        return self._codes

    @property
    def nbytes(self) -> int:
        """Memory held, bytes."""
        parts = ((f.grid, f.frontiers, f.bridges, f.treads) for f in self._floors)
        floors = sum(part.nbytes for floor in parts for part in floor)
        return self._codes.nbytes + self._is_stairs.nbytes + floors

    def add_floor(self, floor: Floor) -> None:
        """Add a floor, and sort the whole scene anew, which costs what the map holds.

        Args:
            floor: Its index is the number of floors so far.
        """
        self._follow_storage()
        everything = np.arange(len(self._scene), dtype=np.int32)
        before = self._codes[everything]
        self._codes[everything] = NO_LAYER
        self._count(everything, before, self._codes[everything])
        self._floors.append(floor)
        self._counted = [
            (
                self._wanted(self._navigable_codes(other)),
                self._wanted([_code(other, Layer.OBSTACLE)]),
            )
            for other in self._floors
        ]
        ascending = sorted(self._floors, key=lambda other: other.z)
        self._ascending = (
            np.array([other.z for other in ascending]),
            np.array([other.index for other in ascending]),
        )
        self.update(everything)

    def mark_stairs(self, keys: NDArray[np.int64]) -> None:
        """Label scene voxels, by key, as belonging to C_nav; `update` makes it count."""
        self._follow_storage()
        arrays = self._scene.arrays
        new = _mark(arrays.table, arrays.keys, keys, self._is_stairs)
        self._stairs = np.append(self._stairs, new)

    def update(self, slots: NDArray[np.int32]) -> None:
        """Sort scene voxels whose centroid or label changed, or that were emptied."""
        self._follow_storage()
        arrays = self._scene.arrays
        moved, before = _classify(
            slots,
            (arrays.points, arrays.counts, self._is_stairs),
            *self._ascending,
            self._heights,
            self._codes,
        )
        if len(moved):
            self._count(moved, before, self._codes[moved])

    def navigable(self, floor: Floor) -> NDArray[np.int64]:
        """Slots of the scene voxels in M_nav of a floor, in order of first observation."""
        return _slots_with(
            self._codes, len(self._scene), self._wanted(self._navigable_codes(floor))
        )

    def obstacles(self, floor: Floor) -> NDArray[np.int64]:
        """Slots of M_obs of a floor, in order of first observation."""
        wanted = self._wanted([_code(floor, Layer.OBSTACLE)])
        return _slots_with(self._codes, len(self._scene), wanted)

    def stairs(self, floor: Floor) -> NDArray[np.int64]:
        """Slots of the stairs that rise from a floor or lead up to it."""
        wanted = self._wanted(self._stairs_codes(floor))
        found: NDArray[np.int64] = self._stairs[wanted[self._codes[self._stairs]]]
        return found

    def are_navigable(self, slots: NDArray[np.integer], floor: Floor) -> NDArray[np.bool_]:
        """(N,) which scene voxels are in M_nav of a floor."""
        navigable: NDArray[np.bool_] = self._counted[floor.index][0][self._codes[slots]]
        return navigable

    def _count(
        self, slots: NDArray[np.int32], before: NDArray[np.int16], after: NDArray[np.int16]
    ) -> None:
        """Take voxels of one code off the floors' grids, and put them there with another."""
        keys = self._scene.arrays.keys
        for floor, counted in zip(self._floors, self._counted, strict=True):
            floor.grid.change(*_changes(keys, slots, (before, after), counted))

    def _navigable_codes(self, floor: Floor) -> list[int]:
        """Its own floor and stairs, and the stairs that rise from the floor below."""
        return [_code(floor, Layer.NAVIGABLE), *self._stairs_codes(floor)]

    def _stairs_codes(self, floor: Floor) -> list[int]:
        codes = [_code(floor, Layer.STAIRS)]
        lower = [other for other in self._floors if other.z < floor.z]
        if lower:
            codes.append(_code(max(lower, key=lambda other: other.z), Layer.STAIRS))
        return codes

    def _wanted(self, codes: list[int]) -> NDArray[np.bool_]:
        """Look-up table from a code to whether it is among `codes`; NO_LAYER is its last entry."""
        wanted = np.zeros(LAYERS * len(self._floors) + 1, np.bool_)
        wanted[codes] = True
        return wanted

    def _follow_storage(self) -> None:
        """Keep one code a slot as the scene's storage grows."""
        known, slots = len(self._codes), len(self._scene.arrays.keys)
        if slots > known:
            self._codes = lengthened(self._codes, slots)
            self._codes[known:] = NO_LAYER
            self._is_stairs = lengthened(self._is_stairs, slots)


def _code(floor: Floor, layer: Layer) -> int:
    return floor.index * LAYERS + layer


@njit(cache=True)
def _classify(
    slots: NDArray[np.int32],
    voxels: tuple[NDArray[np.float32], NDArray[np.int32], NDArray[np.bool_]],
    floor_z: NDArray[np.float64],
    floor_index: NDArray[np.int64],
    heights: tuple[float, float],
    codes: NDArray[np.int16],
) -> tuple[NDArray[np.int32], NDArray[np.int16]]:
    """Write the codes of voxels; returns those whose code changed, and what it was before.

    The floors are in ascending order of height.
    """
    points, counts, is_stairs = voxels
    delta, obstacle_top = heights
    moved, before = np.empty(slots.size, np.int32), np.empty(slots.size, np.int16)
    changed = 0
    for row in range(slots.size):
        slot = slots[row]
        z = points[slot, 2]
        below = -1
        while below + 1 < floor_z.size and z >= floor_z[below + 1] - delta:
            below += 1
        code = NO_LAYER
        if counts[slot] == 0:
            code = NO_LAYER
        elif is_stairs[slot]:
            code = floor_index[max(below, 0)] * LAYERS + STAIRS
        elif below >= 0 and z <= floor_z[below] + delta:
            code = floor_index[below] * LAYERS + NAVIGABLE
        elif below >= 0 and z < floor_z[below] + obstacle_top:
            code = floor_index[below] * LAYERS + OBSTACLE
        if codes[slot] != code:
            moved[changed], before[changed] = slot, codes[slot]
            codes[slot] = code
            changed += 1
    return moved[:changed], before[:changed]


@njit(cache=True)
def _changes(
    keys: NDArray[np.int64],
    slots: NDArray[np.int32],
    codes: tuple[NDArray[np.int16], NDArray[np.int16]],
    wanted: tuple[NDArray[np.bool_], NDArray[np.bool_]],
) -> tuple[NDArray[np.int64], NDArray[np.int8], NDArray[np.int8]]:
    """What changes on a floor, as `FloorGrid.change` takes it.

    Args:
        keys: Of all voxels.
        slots: (N,) those that have changed.
        codes: (N,) each, before and after.
        wanted: Look-up tables of the codes that are navigable and in the way there.
    """
    before, after = codes
    is_navigable, is_obstacle = wanted
    columns = np.empty((slots.size, 2), np.int64)
    navigable, obstacles = np.empty(slots.size, np.int8), np.empty(slots.size, np.int8)
    count = 0
    for row in range(slots.size):
        old, new = before[row], after[row]
        navigable[count] = np.int8(is_navigable[new]) - np.int8(is_navigable[old])
        obstacles[count] = np.int8(is_obstacle[new]) - np.int8(is_obstacle[old])
        if navigable[count] or obstacles[count]:
            columns[count, 0], columns[count, 1] = column_of(keys[slots[row]])
            count += 1
    return columns[:count], navigable[:count], obstacles[:count]


@njit(cache=True)
def _slots_with(
    codes: NDArray[np.int16], size: int, wanted: NDArray[np.bool_]
) -> NDArray[np.int64]:
    """Those of the first `size` slots whose code is wanted, ascending."""
    found = np.empty(size, np.int64)
    count = 0
    for slot in range(size):
        found[count] = slot
        count += wanted[codes[slot]]
    return found[:count]


@njit(cache=True)
def _mark(
    table: NDArray[np.int32],
    keys: NDArray[np.int64],
    wanted: NDArray[np.int64],
    marks: NDArray[np.bool_],
) -> NDArray[np.int64]:
    """Mark the slots of keys; returns those that were not marked before."""
    new = np.empty(wanted.size, np.int64)
    count = 0
    for row in range(wanted.size):
        slot = find_slot(table, keys, wanted[row])
        if slot != EMPTY and not marks[slot]:
            marks[slot] = True
            new[count] = slot
            count += 1
    return new[:count]
