"""Where the target was seen beyond the range of the depth camera: a bearing, and a guess how far.

A detector sees farther than the depth camera measures. Such a glimpse puts nothing into the map,
but it says which way to go: to the place where the line of sight to the target's lower edge meets
the floor, or, for what hangs on a wall, some metres beyond the camera's range.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from toponav.config_model import ConfigModel
from toponav.types import Detections, Observation

Positive = Annotated[float, Field(gt=0.0)]


class GlimpseConfig(ConfigModel):
    """What counts as a glimpse, and how long it is followed."""

    unmeasured: Annotated[float, Field(gt=0.0, le=1.0)] = 0.7
    """Share of a mask's pixels that must be without depth."""

    range_m: tuple[Positive, Positive] = (4.5, 11.0)
    """Nearest and farthest that a glimpsed target stands, horizontally, metres."""

    hanging_m: Positive = 6.5
    """How far off what does not seem to stand within that range is taken to be: it may hang on a
    wall, or something hides its lower edge."""

    storey_m: tuple[float, float] = (-0.5, 2.5)
    """What would be lower or higher than this over the floor is on another storey."""

    same_m: Positive = 1.5
    """A line of sight that passes this near to a place is one more glimpse of it."""

    looked_m: Positive = 3.5
    """From this near, a place in view without a target speaks against it, metres."""

    looks: Annotated[int, Field(ge=1)] = 2
    """So many looks in vain end it."""

    decisions: Annotated[int, Field(ge=1)] = 6
    """It is followed for so many decisions."""


@dataclass(frozen=True, eq=False)
class Glimpse:
    """One place where the target seemed to be.

    Attributes:
        place: (2,) the guess of where, world frame, metres.
        floor_z: Height of the floor that the agent stood on, metres.
        score: The best of its detections' scores.
        misses: Looks from nearby that did not show the target.
        decisions: For how many it was followed.
    """

    place: NDArray[np.float64]
    floor_z: float
    score: float
    misses: int = 0
    decisions: int = 0


class Glimpses:
    """The glimpses of one target that neither led to a candidate nor proved to be nothing."""

    def __init__(self, config: GlimpseConfig, target: str) -> None:
        """Know of none yet."""
        self._config = config
        self._target = target
        self._open: list[Glimpse] = []
        self.fresh = False

    def pursue(self, floor_z: float) -> tuple[Glimpse, ...]:
        """Those on a storey, for one more decision; those that were followed enough are dropped."""
        self._open = [g for g in self._open if g.decisions < self._config.decisions]
        here = [abs(g.floor_z - floor_z) <= self._config.storey_m[1] / 2.0 for g in self._open]
        self._open = [
            replace(g, decisions=g.decisions + is_here)
            for g, is_here in zip(self._open, here, strict=True)
        ]
        return tuple(g for g, is_here in zip(self._open, here, strict=True) if is_here)

    def observe(self, observation: Observation, detections: Detections) -> None:
        """Take a frame; `fresh` then says whether it held a glimpse of a place not known before."""
        self.fresh = False
        looked = [self._look_at(glimpse, observation) for glimpse in self._open]
        self._open = [g for g in looked if g.misses < self._config.looks]
        for k, label in enumerate(detections.labels):
            mask = detections.masks[k]
            if label != self._target or not mask.any():
                continue
            measured = np.count_nonzero(observation.depth[mask])
            if measured > (1.0 - self._config.unmeasured) * np.count_nonzero(mask):
                self._forget_along(observation, mask)
            else:
                self._add(observation, mask, float(detections.scores[k]))

    def _add(self, observation: Observation, mask: NDArray[np.bool_], score: float) -> None:
        """One more glimpse of a known place, or one of a new place."""
        place = self._place(observation, mask)
        if place is None:
            return
        eye = observation.world_from_camera.translation[:2]
        floor_z = float(observation.world_from_base.translation[2])
        known = [g for g in self._open if _off_line(g.place, eye, place) <= self._config.same_m]
        self.fresh = self.fresh or not known
        self._open = [g for g in self._open if g not in known]
        score = max([score, *(g.score for g in known)])
        decisions = max((g.decisions for g in known), default=0)
        self._open.append(Glimpse(place, floor_z, score, decisions=decisions))

    def _forget_along(self, observation: Observation, mask: NDArray[np.bool_]) -> None:
        """The target is measured now: what was glimpsed in that direction is a candidate."""
        eye = observation.world_from_camera.translation[:2]
        beyond = eye + self._config.range_m[1] * _bearing(observation, mask)
        self._open = [
            g for g in self._open if _off_line(g.place, eye, beyond) > self._config.same_m
        ]

    def _place(
        self, observation: Observation, mask: NDArray[np.bool_]
    ) -> NDArray[np.float64] | None:
        """(2,) where the target of a mask stands; None if it is on another storey."""
        nearest, farthest = self._config.range_m
        eye = observation.world_from_camera.translation
        height = eye[2] - observation.world_from_base.translation[2]
        rows, columns = np.nonzero(mask)
        lower = _direction(observation, float(columns.mean()), float(rows.max()))
        distance = height / -lower[2] * np.hypot(*lower[:2]) if lower[2] < 0.0 else math.inf
        if not nearest <= distance <= farthest:
            distance = self._config.hanging_m
        middle = _direction(observation, float(columns.mean()), float(rows.mean()))
        over_floor = height + middle[2] / np.hypot(*middle[:2]) * distance
        lowest, highest = self._config.storey_m
        if not lowest <= over_floor <= highest:
            return None
        place: NDArray[np.float64] = eye[:2] + distance * _bearing(observation, mask)
        return place

    def _look_at(self, glimpse: Glimpse, observation: Observation) -> Glimpse:
        """The glimpse after a frame that may show its place."""
        eye, camera = observation.world_from_camera, observation.intrinsics
        point = np.array([*glimpse.place, eye.translation[2]])
        distance = float(np.hypot(*(point - eye.translation)[:2]))
        x, _, z = eye.inverse().apply(point).tolist()
        if distance > self._config.looked_m or z <= 0.0:
            return glimpse
        column = round(camera.fx * x / z + camera.cx)
        if not 0 <= column < camera.width:
            return glimpse
        depth = observation.depth[:, column]
        if depth.min() > 0.0 and depth.max() < z - self._config.same_m / 2.0:
            return glimpse  # hidden by something as high as the image
        return replace(glimpse, misses=glimpse.misses + 1)


def _direction(observation: Observation, column: float, row: float) -> NDArray[np.float64]:
    """(3,) of a pixel's line of sight, world frame."""
    ray = observation.intrinsics.ray(column, row)
    direction: NDArray[np.float64] = observation.world_from_camera.rotation @ ray
    return direction


def _bearing(observation: Observation, mask: NDArray[np.bool_]) -> NDArray[np.float64]:
    """(2,) unit vector on the floor towards the middle of a mask."""
    rows, columns = np.nonzero(mask)
    direction = _direction(observation, float(columns.mean()), float(rows.mean()))[:2]
    unit: NDArray[np.float64] = direction / np.hypot(*direction)
    return unit


def _off_line(
    point: NDArray[np.float64], start: NDArray[np.float64], end: NDArray[np.float64]
) -> float:
    """Distance of a (2,) point from the line between two, which ends beyond its range."""
    along = end - start
    t = max(0.0, float((point - start) @ along / (along @ along)))
    return float(np.hypot(*(point - start - t * along)))
