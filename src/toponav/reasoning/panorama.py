"""Collecting V_t^panorama: the views that a decision rests on (Section III-E)."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from toponav.config_model import ConfigModel
from toponav.mapping.view import FrameUpdate, MapView
from toponav.reasoning.base import PanoramaView, SeenObject
from toponav.types import Detections, Observation

SPACING_REACHED = 0.75
"""Share of the spacing that counts as all of it: turns are never exact on a robot."""


class PanoramaConfig(ConfigModel):
    """How many views a panorama has and what they count."""

    views: int = Field(default=12, ge=1)
    """Views a panorama, taken by turning in place (Sec. IV-D)."""

    spacing_deg: float = Field(default=30.0, gt=0.0, lt=180.0)
    """Angle between neighbouring views: the protocol's turn, or a multiple of it for fewer views of
    the same circle."""

    frontier_range_m: float = 5.0
    """Frontier points farther than this from the agent belong to no view: the depth range."""


@dataclass(frozen=True, eq=False)
class Shot:
    """One view as taken, before the map is complete enough to count frontiers.

    Attributes:
        image: (H, W, 3) uint8.
        position: (x, y) of the camera, world frame, metres.
        bearing: World yaw of the optical axis, radians.
        seen: Detections by descending score.
        floor_points: (N, 3) floor points seen: S_dir when this view is chosen.
        floor_area_m2: Area of those points.
    """

    image: NDArray[np.uint8]
    position: tuple[float, float]
    bearing: float
    seen: tuple[SeenObject, ...]
    floor_points: NDArray[np.float32]
    floor_area_m2: float


class Panorama:
    """A panorama in the making: `add` while it is `collecting`, then `views`; then `begin` anew."""

    def __init__(self, config: PanoramaConfig, r_pcd: float) -> None:
        """Create an empty panorama; `r_pcd` is the voxel size of floor points in metres."""
        self._config = config
        self._cell_area_m2 = r_pcd * r_pcd
        self._shots: list[Shot] = []
        self._wanted = config.views

    @property
    def collecting(self) -> bool:
        """Whether views are still to be taken."""
        return len(self._shots) < self._wanted

    @property
    def shots(self) -> tuple[Shot, ...]:
        """The views taken so far, in order."""
        return tuple(self._shots)

    def begin(self, views: int | None = None) -> None:
        """Forget the views taken so far and want `views` new ones, by default a whole panorama."""
        self._shots.clear()
        self._wanted = self._config.views if views is None else views

    def add(self, observation: Observation, detections: Detections, update: FrameUpdate) -> bool:
        """Take a view, if the agent has turned far enough since the last one.

        The map must have integrated the observation already.

        Returns:
            Whether more views are to be taken.
        """
        forward = observation.world_from_camera.rotation[:, 2]
        bearing = math.atan2(forward[1], forward[0])
        if self._shots and not self._turned_enough(bearing):
            return self.collecting
        x, y, _ = observation.world_from_camera.translation
        self._shots.append(
            Shot(
                image=observation.rgb,
                position=(float(x), float(y)),
                bearing=bearing,
                seen=_seen_objects(observation.depth, detections),
                floor_points=update.navigable_points,
                floor_area_m2=len(update.navigable_points) * self._cell_area_m2,
            )
        )
        return self.collecting

    def views(self, map_view: MapView) -> tuple[PanoramaView, ...]:
        """The views as a reasoner gets them, with the frontiers that each looks at."""
        return tuple(
            PanoramaView(
                image=shot.image,
                bearing=shot.bearing,
                seen=shot.seen,
                navigable_area_m2=shot.floor_area_m2,
                frontier_count=self._frontiers_ahead(shot, map_view.frontiers),
            )
            for shot in self._shots
        )

    def direction_points(self, direction: int) -> NDArray[np.float32]:
        """S_dir: (N, 3) floor points seen in the chosen view."""
        return self._shots[direction].floor_points

    def _turned_enough(self, bearing: float) -> bool:
        turned = abs(math.remainder(bearing - self._shots[-1].bearing, math.tau))
        return turned >= SPACING_REACHED * math.radians(self._config.spacing_deg)

    def _frontiers_ahead(self, shot: Shot, frontiers: NDArray[np.float64]) -> int:
        """Frontier points in the view's share of the circle, so that views do not overlap."""
        offset = frontiers[:, :2] - np.asarray(shot.position)
        bearing = np.arctan2(offset[:, 1], offset[:, 0]) - shot.bearing
        off_axis = np.abs((bearing + np.pi) % (2.0 * np.pi) - np.pi)
        near = np.hypot(offset[:, 0], offset[:, 1]) <= self._config.frontier_range_m
        half_share = math.radians(self._config.spacing_deg) / 2.0
        return int(np.count_nonzero(near & (off_axis <= half_share)))


def _seen_objects(depth: NDArray[np.float32], detections: Detections) -> tuple[SeenObject, ...]:
    """Detections with their median range; infinite where the mask has no depth return."""
    seen = []
    for label, score, mask in zip(
        detections.labels, detections.scores, detections.masks, strict=True
    ):
        returns = depth[mask]
        returns = returns[returns > 0.0]
        range_m = float(np.median(returns)) if returns.size else math.inf
        seen.append(SeenObject(label, float(score), range_m))
    return tuple(sorted(seen, key=lambda item: (-item.score, item.range_m, item.label)))
