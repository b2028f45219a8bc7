"""A noise model of object detection: true labels with the errors of a real open-set detector.

With true labels nothing can be said of what confirms a target; independent errors in every frame
would average away over the dozen frames that see an object. Real errors persist: an object that is
missed is missed again from the next pose, and what looks like a television does so for the whole
room. So every draw is made once for an object (or a patch of a surface) and a side from which it is
seen, with a part that all sides of the object share and a part of the single image. `docs/noise.md`
gives the origin of every rate.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, field_validator
from scipy.ndimage import binary_dilation, binary_erosion
from scipy.special import ndtr, ndtri

from toponav.categories import canonical
from toponav.config_model import ConfigModel
from toponav.errors import InputError
from toponav.perception.base import Detector, DetectorContext, detectors
from toponav.perception.draws import Draws, blended, key_of
from toponav.perception.eyesight import FAULTLESS, Eyesight
from toponav.perception.lookalikes import lookalikes
from toponav.perception.sightings import Side, Sighting, side_of, witness
from toponav.types import Detections, SemanticFrame, SemanticSource

PATCH_M = 0.8
"""Edge of the cells of space of which each may hold one deceptive patch a category."""

PATCH_COLUMNS = 80
"""Patches are looked for, and their masks drawn, in an image of about so many columns."""

LEAST_PIXELS_PER_MEGAPIXEL = 80.0
"""Smaller masks are never detected, as by the oracle: 25 pixels of a 640 x 480 image."""

BOUNDARY_WIDTH = 640
"""Image width for which the error of a mask's boundary is given."""


class NoisyDetectorConfig(ConfigModel):
    """How often a detector errs; see docs/noise.md for where the figures are from."""

    sight: Eyesight = Field(default_factory=Eyesight)
    """What is missed."""

    score_side_share: float = Field(default=0.7, ge=0.0, le=1.0)
    """Share of the chance in a score that the views from one side have in common."""

    confusion: float = Field(default=1.0, ge=0.0)
    """Factor on the rates of `lookalikes`; 0 for no confusions."""

    forced_confusion: float = Field(default=2.0, ge=0.0)
    """Further factor where the true category was not asked for: the best that is left is said."""

    patch_rate: float = Field(default=6e-4, ge=0.0, le=1.0)
    """Share of cells of space (0.8 m) that hold a patch which looks like a category; for each
    category on its own."""

    patch_radius_m: tuple[float, float] = (0.15, 0.45)
    """Least and largest radius of such a patch, metres."""

    patch_side_rate: float = Field(default=0.5, ge=0.0, le=1.0)
    """Share of the sides from which a patch deceives."""

    least_score: float = Field(default=0.4, ge=0.0, le=1.0)
    """Detections below are not reported; recall is that of the reported ones."""

    right_score: tuple[float, float] = (0.62, 0.14)
    """Mean and standard deviation of the score of a right label, before it is cut off."""

    wrong_score: tuple[float, float] = (0.42, 0.1)
    """The same for a wrong label."""

    boundary_px: float = Field(default=2.0, ge=0.0)
    """Standard deviation of how far a mask's boundary is off, pixels of a 640 pixel wide image."""

    @field_validator("patch_radius_m")
    @classmethod
    def _check_radii(cls, radii: tuple[float, float]) -> tuple[float, float]:
        if not 0.0 < radii[0] <= radii[1]:
            raise ValueError("two radii above 0, the least first")
        return radii


PERFECT = NoisyDetectorConfig(sight=FAULTLESS, confusion=0.0, patch_rate=0.0, boundary_px=0.0)
"""No errors but in the scores: the oracle's labels, boxes and masks."""


@dataclass(frozen=True, eq=False)
class _Seen:
    """One detection in the making: a mask within a window of the image."""

    label: str
    score: float
    window: tuple[slice, slice]
    mask: NDArray[np.bool_]


class NoisyDetector:
    """The oracle's labels with misses, confusions, false positives, scores and ragged masks."""

    def __init__(
        self, source: SemanticSource, seed: int, config: NoisyDetectorConfig | None = None
    ) -> None:
        """Take the handle on the ground truth.

        Args:
            source: Labels of the image last observed.
            seed: Of the episode; another seed misses other objects.
            config: The rates.
        """
        self._source = source
        self._config = config or NoisyDetectorConfig()
        self._draws = Draws(seed)

    def detect(self, rgb: NDArray[np.uint8], vocabulary: Sequence[str]) -> Detections:
        """What the detector believes to see: objects by instance id, then what is none.

        Raises:
            InputError: The labels are not those of an image of this size.
        """
        height, width = rgb.shape[:2]
        frame = self._source.semantic_frame()
        if frame.instance_ids.shape != (height, width):
            raise InputError(
                f"the true labels are {frame.instance_ids.shape}, the image is {(height, width)}: "
                "detect on the image last observed"
            )
        wanted = {canonical(name): name for name in vocabulary}
        look = _Look(frame, tuple(wanted), self._config, self._draws)
        found = [*look.objects(), *look.patches()]
        if not found:
            return Detections.empty(height, width)
        masks = np.zeros((len(found), height, width), np.bool_)
        for mask, seen in zip(masks, found, strict=True):
            mask[seen.window] = seen.mask
        return Detections(
            labels=tuple(wanted[seen.label] for seen in found),
            scores=np.array([seen.score for seen in found], np.float32),
            boxes=np.array([_box(seen) for seen in found], np.float32),
            masks=masks,
        )


class _Look:
    """One image and what is asked of it."""

    def __init__(
        self,
        frame: SemanticFrame,
        wanted: tuple[str, ...],
        config: NoisyDetectorConfig,
        draws: Draws,
    ) -> None:
        self._frame = frame
        self._wanted = wanted
        self._config = config
        self._draws = draws
        self._stride = max(1, frame.instance_ids.shape[1] // PATCH_COLUMNS)
        self._image = key_of(frame.world_from_camera.matrix.tobytes())

    def objects(self) -> list[_Seen]:
        """Those of the objects in view that are found, each under the label that it gets."""
        return [seen for seen in map(self._object, self._sightings()) if seen is not None]

    def patches(self) -> list[_Seen]:
        """False positives: patches of surface that look like a category from here."""
        if not self._wanted or self._config.patch_rate == 0.0:
            return []
        cells = self._cells()
        labels = np.array([key_of(name) for name in self._wanted])
        x, y, z = cells.T[:, :, None]
        deceptive = self._draws.uniform("patch", x, y, z, labels) < self._config.patch_rate
        found = (
            self._patch(cells[row], self._wanted[column]) for row, column in np.argwhere(deceptive)
        )
        return [seen for seen in found if seen is not None]

    def _sightings(self) -> tuple[Sighting, ...]:
        least = LEAST_PIXELS_PER_MEGAPIXEL * 1e-6 * self._frame.instance_ids.size
        return witness(self._frame, max(1.0, least)).sightings

    def _object(self, sighting: Sighting) -> _Seen | None:
        """The detection of an object, if it is one of something that is asked for."""
        category, key, side = sighting.instance.category, (sighting.instance.id,), sighting.side
        label = self._label(sighting)
        sight = self._config.sight
        recall = sight.recall(sighting.relative_size, sighting.range_m, cut=sighting.cut)
        if label is None or not sight.happens(self._draws, key, side, self._image, recall):
            return None
        score = self._score(key, side, right=label == category)
        return _Seen(label, score, *self._ragged(sighting))

    def _label(self, sighting: Sighting) -> str | None:
        """What the object is taken for, among what is asked for; None for none of it."""
        category, config = sighting.instance.category, self._config
        asked = category in self._wanted
        factor = config.confusion * (1.0 if asked else config.forced_confusion)
        draw = float(self._draws.uniform("label", sighting.instance.id, *sighting.side))
        for other, rate in lookalikes(category).items():
            if other in self._wanted:
                draw -= factor * rate
                if draw < 0.0:
                    return other
        return category if asked else None

    def _score(self, key: tuple[int, ...], side: Side, *, right: bool) -> float:
        """Score of a detection, alike in all images from one side."""
        config, draws = self._config, self._draws
        mean, deviation = config.right_score if right else config.wrong_score
        luck = blended(
            (config.score_side_share, 1.0 - config.score_side_share),
            (
                draws.normal("score from a side", *key, *side),
                draws.normal("score in an image", *key, self._image),
            ),
        )
        floor = ndtr((config.least_score - mean) / deviation)  # lower scores are not reported
        score = mean + deviation * float(ndtri(floor + (1.0 - floor) * luck))
        return min(score, 1.0)

    def _ragged(self, sighting: Sighting) -> tuple[tuple[slice, slice], NDArray[np.bool_]]:
        """A window and the object's mask in it, whose boundary lies a little off."""
        ids = self._frame.instance_ids
        luck = float(self._draws.normal("boundary", sighting.instance.id, *sighting.side))
        off = round(luck * self._config.boundary_px * ids.shape[1] / BOUNDARY_WIDTH)
        rows, columns = (
            slice(max(part.start - max(off, 0), 0), part.stop + max(off, 0))
            for part in sighting.window
        )
        mask = ids[rows, columns] == sighting.instance.id
        if off > 0:
            mask = binary_dilation(mask, iterations=off)
        elif off < 0:
            eroded = binary_erosion(mask, iterations=-off)
            mask = eroded if eroded.any() else mask
        return (rows, columns), mask

    def _patch(self, cell: NDArray[np.int64], label: str) -> _Seen | None:
        """The detection of a deceptive patch, if enough of it is in view and it deceives here."""
        config, draws = self._config, self._draws
        key = (*cell.tolist(), key_of(label))
        center = (cell + [float(draws.uniform(f"patch: {axis}", *key)) for axis in "xyz"]) * PATCH_M
        least, largest = config.patch_radius_m
        radius = least + (largest - least) * float(draws.uniform("patch: radius", *key))
        points, ids = self._coarse
        coarse = (np.square(points - center).sum(axis=-1) < radius * radius) & (ids >= 0)
        shown = {self._frame.instances[k].category for k in np.unique(ids[coarse])}
        if not coarse.any() or label in shown:
            return None
        range_m = float(np.linalg.norm(center - self._frame.world_from_camera.translation))
        side = side_of(center - self._frame.world_from_camera.translation)
        recall = config.sight.recall(math.sqrt(float(coarse.mean())), range_m)
        if draws.uniform("patch: side", *key, *side) >= config.patch_side_rate:
            return None
        if not config.sight.happens(draws, key, side, self._image, recall):
            return None
        mask = coarse.repeat(self._stride, axis=0).repeat(self._stride, axis=1)
        height, width = self._frame.instance_ids.shape
        return _Seen(
            label,
            self._score(key, side, right=False),
            (slice(0, height), slice(0, width)),
            mask[:height, :width],
        )

    def _cells(self) -> NDArray[np.int64]:
        """(N, 3) cells of space of which some surface is seen, each once."""
        points, ids = self._coarse
        cells = np.floor(points[ids >= 0] / PATCH_M).astype(np.int64)
        if not len(cells):
            return cells
        low = cells.min(axis=0)
        sides = tuple(cells.max(axis=0) - low + 1)
        occupied = np.unique(np.ravel_multi_index(tuple((cells - low).T), sides))
        return np.asarray(np.stack(np.unravel_index(occupied, sides), axis=1) + low)

    @cached_property
    def _coarse(self) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
        """World points and instances of every few pixels: (h, w, 3) and (h, w)."""
        frame, every = self._frame, slice(None, None, self._stride)
        height, width = frame.instance_ids.shape
        rows, columns = np.mgrid[0 : height : self._stride, 0 : width : self._stride]
        in_camera = frame.intrinsics.ray(columns, rows) * frame.depth[every, every, None]
        return frame.world_from_camera.apply(in_camera), frame.instance_ids[every, every]


def _box(seen: _Seen) -> tuple[int, int, int, int]:
    """x_min, y_min, x_max, y_max of a mask that is not empty, max exclusive."""
    rows = np.flatnonzero(seen.mask.any(axis=1)) + seen.window[0].start
    columns = np.flatnonzero(seen.mask.any(axis=0)) + seen.window[1].start
    return columns[0], rows[0], columns[-1] + 1, rows[-1] + 1


@detectors.register("noisy")
def _noisy(context: DetectorContext) -> Detector:
    if context.source is None:
        raise InputError("the noisy detector needs a simulator; choose another --detector")
    return NoisyDetector(context.source, context.seed, context.config.noisy)
