"""The objects near places, remembered for as long as nothing changes about a place.

A decision asks for what is near every node and every frontier, and a panorama changes the
surroundings of few of them: the answers for the others are those of the decision before. Voxels
are found again through blocks of voxels that were first seen one after the other, and so mostly
side by side: a block that lies elsewhere is passed over whole.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numba import njit
from numpy.typing import NDArray

from toponav.mapping.nearby import NearObjects, near_objects
from toponav.mapping.storage import lengthened
from toponav.mapping.voxels import VoxelCloud, column_of

BLOCK = 128
"""Voxels of a block."""

MOST_CHANGES = 64
"""Boxes of change that are kept apart, a few panoramas' worth; of more, the one around them all."""

MOST_PLACES = 2000
"""Places that are remembered; those asked for first go first."""

Box = tuple[float, float, float, float]
"""x and y of the lower corner, then of the upper one, metres."""

_Question = tuple[float, float, float, tuple[float, float]]
"""x, y, radius and heights."""


class Surroundings:
    """An `ObjectSearch` over M_obj of a map that grows."""

    def __init__(self, objects: Mapping[str, VoxelCloud]) -> None:
        """Search clouds, by category, that others go on changing.

        Args:
            objects: Live; whoever changes a cloud notes where (`changed`).
        """
        self._objects = objects
        self._blocks: dict[str, VoxelBlocks] = {}
        self._answers: dict[_Question, NearObjects] = {}
        self._changes: list[Box] = []

    @property
    def nbytes(self) -> int:
        """Memory that the blocks hold, bytes."""
        return sum(blocks.nbytes for blocks in self._blocks.values())

    def changed(self, points: NDArray[np.float32], slots: NDArray[np.int32]) -> None:
        """Note that voxels were added, moved or taken away.

        Args:
            points: (N, 3) centroids.
            slots: (M,) which of them.
        """
        if not len(slots):
            return
        self._changes.append(_box_around(points, slots))
        if len(self._changes) > MOST_CHANGES:
            low_x, low_y, high_x, high_y = zip(*self._changes, strict=True)
            self._changes = [(min(low_x), min(low_y), max(high_x), max(high_y))]

    def near(
        self, places: NDArray[np.floating], radius_m: float, heights_m: tuple[float, float]
    ) -> list[NearObjects]:
        """What is near each of (K, 2) places; see `ObjectSearch`."""
        self._forget_changed()
        asked = [(float(x), float(y), radius_m, heights_m) for x, y in places]
        new = [k for k, question in enumerate(asked) if question not in self._answers]
        if new:
            box = _grown(_box_of(places[new]), radius_m)
            around = {name: self._points_within(name, box) for name in self._objects}
            found = near_objects(around, places[new], radius_m, heights_m)
            self._answers |= zip((asked[k] for k in new), found, strict=True)
        answers = [self._answers[question] for question in asked]
        for question in list(self._answers)[:-MOST_PLACES]:
            del self._answers[question]
        return answers

    def _forget_changed(self) -> None:
        """Forget the answers about places where something has changed."""
        if self._changes and self._answers:
            x, y, radius, _ = zip(*self._answers, strict=True)
            reach = np.array(radius)
            # A centroid moves within its voxel.
            reach += max((cloud.resolution for cloud in self._objects.values()), default=0.0)
            changes = np.array(self._changes)[:, :, None]
            low_x, low_y, high_x, high_y = np.moveaxis(changes, 1, 0)
            is_near = (low_x - reach <= x) & (x <= high_x + reach)
            is_near &= (low_y - reach <= y) & (y <= high_y + reach)
            for question, stale in zip(list(self._answers), is_near.any(axis=0), strict=True):
                if stale:
                    del self._answers[question]
        self._changes.clear()

    def _points_within(self, category: str, box: Box) -> NDArray[np.float32]:
        blocks = self._blocks.setdefault(category, VoxelBlocks())
        return blocks.points_within(self._objects[category], box)


class VoxelBlocks:
    """Where the voxels of a growing cloud lie, block by block."""

    def __init__(self) -> None:
        """Know of none."""
        self._bounds = np.zeros(0, np.int32)
        self._voxels = 0

    @property
    def nbytes(self) -> int:
        """Memory held, bytes."""
        return self._bounds.nbytes

    def points_within(self, cloud: VoxelCloud, box: Box) -> NDArray[np.float32]:
        """(N, 3) the centroids in a box, and maybe others up to a voxel around it.

        Args:
            cloud: Always the same, which has only grown since the last call, or been emptied here
                and there.
            box: Metres.
        """
        size, arrays = len(cloud), cloud.arrays
        blocks = -(-size // BLOCK)
        if 4 * blocks > len(self._bounds):
            self._bounds = lengthened(self._bounds, max(4 * blocks, 2 * len(self._bounds)))
        bounds = self._bounds.reshape(-1, 4)
        _extend(bounds, arrays.keys, self._voxels, size)
        self._voxels = size
        window = np.floor(np.array(box) / cloud.resolution).astype(np.int64)
        within: NDArray[np.float32] = _gathered(
            bounds[:blocks], window, (arrays.keys, arrays.points, arrays.counts), size
        )
        return within


def _box_of(places: NDArray[np.floating]) -> Box:
    """The tightest box around (N, 2) places, N >= 1."""
    (low_x, low_y), (high_x, high_y) = places.min(axis=0).tolist(), places.max(axis=0).tolist()
    return low_x, low_y, high_x, high_y


def _grown(box: Box, margin: float) -> Box:
    return box[0] - margin, box[1] - margin, box[2] + margin, box[3] + margin


@njit(cache=True)
def _box_around(points: NDArray[np.float32], slots: NDArray[np.int32]) -> Box:
    """The tightest box around chosen points, one or more."""
    low_x = high_x = float(points[slots[0], 0])
    low_y = high_y = float(points[slots[0], 1])
    for slot in slots:
        x, y = float(points[slot, 0]), float(points[slot, 1])
        low_x, high_x = min(low_x, x), max(high_x, x)
        low_y, high_y = min(low_y, y), max(high_y, y)
    return low_x, low_y, high_x, high_y


@njit(cache=True)
def _extend(bounds: NDArray[np.int32], keys: NDArray[np.int64], start: int, end: int) -> None:
    """Put the voxels of slots from `start` to `end` into their blocks' bounds.

    Bounds are least and greatest integer x and y, both included.
    """
    for slot in range(start, end):
        bound = bounds[slot // BLOCK]
        x, y = column_of(keys[slot])
        if slot % BLOCK == 0:
            bound[0], bound[1], bound[2], bound[3] = x, y, x, y
        else:
            bound[0], bound[1] = min(bound[0], x), min(bound[1], y)
            bound[2], bound[3] = max(bound[2], x), max(bound[3], y)


@njit(cache=True)
def _gathered(
    bounds: NDArray[np.int32],
    window: NDArray[np.int64],
    voxels: tuple[NDArray[np.int64], NDArray[np.float32], NDArray[np.int32]],
    size: int,
) -> NDArray[np.float32]:
    """(N, 3) centroids of the voxels in a window of columns that were not emptied."""
    keys, points, counts = voxels
    low_x, low_y, high_x, high_y = window
    near = np.empty(len(bounds), np.int64)
    count = 0
    for block in range(len(bounds)):
        bound = bounds[block]
        near[count] = block
        count += int(
            (bound[0] <= high_x) & (bound[1] <= high_y) & (bound[2] >= low_x) & (bound[3] >= low_y)
        )
    within = np.empty((count * BLOCK, 3), np.float32)
    found = 0
    for block in near[:count]:
        for slot in range(block * BLOCK, min(size, (block + 1) * BLOCK)):
            x, y = column_of(keys[slot])
            if counts[slot] and low_x <= x <= high_x and low_y <= y <= high_y:
                for axis in range(3):
                    within[found, axis] = points[slot, axis]
                found += 1
    return within[:found]
