"""From boxes to objects: what in a box is the thing, told by the depth image.

A box also holds the floor before the thing, the wall behind it and whatever stands in front. The
thing is taken to be the connected surface, without jumps in depth, that fills most of the middle of
the box and reaches to its sides, which what stands in front does not; the floor under it, the wall
behind it (`toponav.perception.walls`) and what lies deeper than a thing of its kind can be are left
out.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_erosion, find_objects, label

from toponav.geometry import back_project
from toponav.perception.walls import on_walls
from toponav.types import Detections, Observation

Scalar = TypeVar("Scalar", bound=np.generic)

FLOOR_M = 0.06
"""Points lower than this above the floor are floor, unless the thing is as flat as a rug."""

FLAT = frozenset({"rug"})
"""Categories that lie on the floor."""

ON_WALLS = frozenset({
    "tv_monitor", "picture", "mirror", "towel", "window", "door", "whiteboard", "fireplace",
    "cabinet", "counter", "shower", "clothes",
})  # fmt: skip
"""Categories that hang on a wall or are built into one: what lies in it may be theirs."""

LEAST_LEFT = 0.05
"""Where less of a box is no wall, the wall is the thing after all: a wardrobe seen from beside."""

LOOSE = frozenset({"plant"})
"""Categories of many small surfaces with gaps between: all of them are the thing."""

LOOSE_M = 0.25
"""How far the other surfaces of a loose thing lie before or behind the main one, metres."""

FRINGE = (2.0, 98.0)
"""Percentiles of the main surface's depths between which it lies."""

THIN = 0.3
"""What would lose more than all but this share with its edge is not eroded: leaves, chair legs."""

JUMP_M = 0.05
JUMP_PER_M = 0.03
"""Neighbouring pixels farther apart in depth than this, and this more a metre of depth, belong to
different surfaces: a floor seen at a flat angle from 0.9 m high still counts as one."""

MIDDLE = 0.25
"""The middle of a box begins at this share of its sides."""

REACH = 2.0
"""Power of the share of the box that a surface's extents have: a coffee table in front of a sofa
fills the middle of the sofa's box, but not the box."""

LARGEST_M = {
    "bed": 2.4, "sofa": 2.6, "table": 2.6, "bathtub": 2.0, "counter": 3.0, "bench": 2.0,
    "piano": 1.8, "desk": 2.0, "wardrobe": 2.2, "cabinet": 2.0, "bookshelf": 2.0,
    "chair": 1.1, "toilet": 1.0, "plant": 1.3, "tv_monitor": 1.5, "sink": 1.0, "fridge": 1.2,
    "oven": 1.0, "microwave": 0.8, "laptop": 0.6, "book": 0.5, "picture": 1.5,
}  # fmt: skip
"""Largest extent along the line of sight that one meets in homes, metres."""

LARGEST_OTHER_M = 2.0

FRONT = 5.0
"""Percentile of a surface's depths that counts as its front."""

MIN_PIXELS_PER_MEGAPIXEL = 80.0
"""A smaller rest is no support for an object: 25 pixels of a 640 x 480 image."""

EROSION_PER_COLUMN = 1 / 320
"""Pixels by which masks are eroded, where depths of two surfaces mix, a column of the image."""


def object_masks(observation: Observation, detections: Detections) -> Detections:
    """Detections with masks of their objects; those that have such masks are left as they are.

    Args:
        observation: The frame that the detections are of.
        detections: With masks that are filled boxes, or not.

    Returns:
        The same detections in the same order. Where the depth camera measures nothing in a box, the
        box remains: it may still tell a direction.
    """
    if not detections.masks_are_boxes or not len(detections):
        return detections
    points = observation.world_from_camera.apply(
        back_project(observation.depth, observation.intrinsics).reshape(-1, 3)
    ).reshape(*observation.depth.shape, 3)
    foot_z = float(observation.world_from_base.translation[2])
    masks = [
        _object_mask(observation.depth, points, foot_z, box, name)
        for box, name in zip(detections.masks, detections.labels, strict=True)
    ]
    return replace(detections, masks=np.stack(masks), masks_are_boxes=False)


def _object_mask(
    depth: NDArray[np.float32],
    points: NDArray[np.float64],
    foot_z: float,
    box: NDArray[np.bool_],
    name: str,
) -> NDArray[np.bool_]:
    """(H, W) the object in one filled box."""
    rows, columns = np.flatnonzero(box.any(axis=1)), np.flatnonzero(box.any(axis=0))
    mask = np.zeros_like(box)
    if not len(rows):
        return mask
    window = (slice(rows[0], rows[-1] + 1), slice(columns[0], columns[-1] + 1))
    near = depth[window]
    if not (near > 0.0).any():
        return box
    standing = (depth > 0.0) & ((points[..., 2] > foot_z + FLOOR_M) | (name in FLAT))
    solid = standing[window]
    if name not in ON_WALLS | FLAT:
        free = solid & ~on_walls(points, depth, standing, window)
        if np.count_nonzero(free) >= LEAST_LEFT * np.count_nonzero(solid):
            solid = free
    surface = _main_surface(near, solid)
    if surface.any():
        if name in LOOSE:
            first, last = np.percentile(near[surface], FRINGE)
            surface = solid & (near >= first - LOOSE_M) & (near <= last + LOOSE_M)
        front = float(np.percentile(near[surface], FRONT))
        surface &= near <= front + LARGEST_M.get(name, LARGEST_OTHER_M)
    surface = _without_edge(surface, max(1, round(depth.shape[1] * EROSION_PER_COLUMN)))
    if np.count_nonzero(surface) >= MIN_PIXELS_PER_MEGAPIXEL * 1e-6 * depth.size:
        mask[window] = surface
    return mask


def _without_edge(surface: NDArray[np.bool_], width: int) -> NDArray[np.bool_]:
    """(h, w) a surface, eroded by so many pixels unless little would be left of it."""
    inner: NDArray[np.bool_] = binary_erosion(surface, iterations=width)
    enough = np.count_nonzero(inner) > THIN * np.count_nonzero(surface)
    return inner if enough else surface


def _main_surface(depth: NDArray[np.float32], solid: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """(h, w) the connected surface that fills most of the middle and reaches farthest."""
    jump = JUMP_M + JUMP_PER_M * depth
    smooth = solid.copy()
    for axis in (0, 1):
        step = np.abs(np.diff(depth, axis=axis))
        limit = np.minimum(*_pair(jump, axis))
        both = np.logical_and(*_pair(solid, axis))
        broken = both & (step > limit)
        nearer_first = np.less(*_pair(depth, axis))
        first, second = _pair(smooth, axis)
        second[broken & nearer_first] = False  # of two surfaces the farther one ends at the edge
        first[broken & ~nearer_first] = False
    pieces, count = label(smooth)
    if not count:
        return smooth
    height, width = depth.shape
    top, left = int(MIDDLE * height), int(MIDDLE * width)
    middle = pieces[top : height - top, left : width - left]
    votes = np.bincount(middle.ravel(), minlength=count + 1)[1:]
    if not votes.any():
        votes = np.bincount(pieces.ravel(), minlength=count + 1)[1:]
    reach = [np.prod([side.stop - side.start for side in sides]) for sides in find_objects(pieces)]
    return np.asarray(pieces == 1 + int(np.argmax(votes * (np.array(reach) / depth.size) ** REACH)))


def _pair(array: NDArray[np.generic], axis: int) -> tuple[NDArray[np.generic], NDArray[np.generic]]:
    """Views of all but the last and of all but the first along an axis."""
    if axis == 0:
        return array[:-1], array[1:]
    return array[:, :-1], array[:, 1:]
