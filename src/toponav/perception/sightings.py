"""What an image truly shows: the ground truth behind the noise models of detector and VLM."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import find_objects

from toponav.perception.base import Detector
from toponav.types import Detections, Instance, SemanticFrame, SemanticSource

SURFACES = frozenset({"wall", "floor", "ceiling"})
"""What is no object, however one looks at it."""

SECTOR_RAD = math.radians(45.0)
"""An object looks alike from within such a sector of bearings."""

RANGE_RATIO = 1.5
"""An object looks alike at ranges of which the larger is at most so many times the smaller."""

NEAREST_M = 0.1
"""Nearer things are no nearer."""

PLACE_M, PLACE_RAD = 0.5, math.radians(30.0)
"""Images taken so near to each other, looking so much the same way, show the same."""


Side = tuple[int, int]
"""From which side and how far a thing is seen: sector of the bearing and bin of the range."""


@dataclass(frozen=True, eq=False)
class Sighting:
    """One object in one image.

    Attributes:
        instance: The object.
        window: Rows and columns that enclose its pixels.
        pixels: How many it has.
        relative_size: Side of a square of as many pixels, as a share of the image's.
        range_m: Median distance of its pixels along the optical axis, metres.
        cut: Whether the border of the image cuts it off.
        side: From which side and how far it is seen; it looks alike in all images with the same.
    """

    instance: Instance
    window: tuple[slice, slice]
    pixels: int
    relative_size: float
    range_m: float
    cut: bool
    side: Side


@dataclass(frozen=True, eq=False)
class Witness:
    """What one image shows.

    Attributes:
        sightings: Its objects, by instance id; walls, floors and ceilings are left out.
        place: (4,) integers: where and whereto the camera looked, coarsely.
    """

    sightings: tuple[Sighting, ...]
    place: NDArray[np.int64]


def witness(frame: SemanticFrame, least_pixels: float = 1.0) -> Witness:
    """The objects of an image that have at least so many pixels."""
    eye, axis = frame.world_from_camera.translation, frame.world_from_camera.rotation[:, 2]
    yaw = math.atan2(axis[1], axis[0])
    place = np.floor([*(eye / PLACE_M), yaw / PLACE_RAD]).astype(np.int64)
    windows = find_objects(frame.instance_ids + 1, max_label=len(frame.instances))
    seen = (
        _sighting(frame, instance, window)
        for instance, window in zip(frame.instances, windows, strict=True)
        if window is not None and instance.category not in SURFACES
    )
    return Witness(tuple(s for s in seen if s.pixels >= least_pixels), place)


def side_of(offset: NDArray[np.float64]) -> Side:
    """The side from which something at a (3,) offset from the camera is seen, world axes."""
    bearing = math.atan2(offset[1], offset[0]) % math.tau
    range_m = max(float(np.linalg.norm(offset)), NEAREST_M)
    return math.floor(bearing / SECTOR_RAD), math.floor(math.log(range_m, RANGE_RATIO))


def _sighting(frame: SemanticFrame, instance: Instance, window: tuple[slice, slice]) -> Sighting:
    (height, width), (rows, columns) = frame.instance_ids.shape, window
    mask = frame.instance_ids[window] == instance.id
    pixels = int(np.count_nonzero(mask))
    range_m = float(np.median(frame.depth[window][mask]))
    middle = [(part.start + part.stop - 1) / 2.0 for part in (columns, rows)]
    offset = frame.world_from_camera.rotation @ frame.intrinsics.ray(*middle) * range_m
    return Sighting(
        instance=instance,
        window=window,
        pixels=pixels,
        relative_size=math.sqrt(pixels / (height * width)),
        range_m=range_m,
        cut=0 in (rows.start, columns.start) or rows.stop == height or columns.stop == width,
        side=side_of(offset),
    )


class SightLog:
    """What the last images truly showed, for who must judge an image by the image alone.

    It remembers nothing until someone asks it to.
    """

    def __init__(self, source: SemanticSource) -> None:
        """Take the handle on the ground truth."""
        self._source = source
        self._images: deque[tuple[NDArray[np.uint8], Witness]] = deque(maxlen=0)

    def keep(self, images: int) -> None:
        """Remember that many images from now on."""
        self._images = deque(self._images, maxlen=images)

    def look(self, rgb: NDArray[np.uint8]) -> None:
        """Take the image last observed."""
        if self._images.maxlen:
            self._images.append((rgb, witness(self._source.semantic_frame())))

    def of(self, image: NDArray[np.uint8]) -> Witness | None:
        """What an image shows, which must be the array itself; None if it is not remembered."""
        for rgb, shown in reversed(self._images):
            if rgb is image:
                return shown
        return None


class WitnessedDetector:
    """A detector whose images a log takes down."""

    def __init__(self, detector: Detector, log: SightLog) -> None:
        """Pass images on to `detector`."""
        self._detector = detector
        self._log = log

    def detect(self, rgb: NDArray[np.uint8], vocabulary: Sequence[str]) -> Detections:
        """The detector's answer."""
        self._log.look(rgb)
        return self._detector.detect(rgb, vocabulary)
