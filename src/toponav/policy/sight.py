"""Whether a spot is close to the target and sees it, judged on the map alone."""

from __future__ import annotations

import math
from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import Field
from scipy.spatial import cKDTree

from toponav.config_model import ConfigModel

Metres = Annotated[float, Field(gt=0.0, allow_inf_nan=False)]


class SightConfig(ConfigModel):
    """What hides what."""

    radius_m: Metres = 0.06
    """A mapped point this near to the line of sight hides what is behind it: more than the
    0.035 m by which a line through a wall of 0.05 m voxels can miss their centres."""

    own_radius_m: Metres = 0.08
    """Points this near to the target do not hide it (its edges, what it stands on): less than the
    thickness of a wall that it hangs on."""

    samples: Annotated[int, Field(ge=1)] = 12
    """How many of the target's near points are tried; one in sight is enough."""


class TargetSight:
    """Answers for one map and one target; the trees over the points are built once."""

    def __init__(
        self,
        target_points: NDArray[np.floating],
        scene_points: NDArray[np.floating],
        max_distance_m: float,
        config: SightConfig,
    ) -> None:
        """Keep the mapped points that can hide the target.

        Args:
            target_points: (N, 3) the target, world frame, metres.
            scene_points: (M, 3) everything mapped, the target included.
            max_distance_m: The largest distance that will be asked for.
            config: What hides what.
        """
        self._target = np.asarray(target_points, dtype=np.float64)
        self._config = config
        if len(self._target):
            margin = max_distance_m + config.radius_m
            low, high = self._target.min(axis=0) - margin, self._target.max(axis=0) + margin
            around = (scene_points[:, :2] >= low[:2]) & (scene_points[:, :2] <= high[:2])
            nearby = np.asarray(scene_points[around.all(axis=1)], dtype=np.float64)
            own, _ = cKDTree(self._target).query(nearby)
            nearby = nearby[own > config.own_radius_m]
        else:
            nearby = np.zeros((0, 3))
        self._hiding = cKDTree(nearby)

    def within_reach(self, eye: ArrayLike, distance_m: float) -> bool:
        """Whether a (3,) eye sees a point of the target that is so near, measured on the floor."""
        position = np.asarray(eye, dtype=np.float64)
        distance = np.hypot(*(self._target[:, :2] - position[:2]).T)
        near = np.flatnonzero(distance <= distance_m)
        near = near[np.argsort(distance[near], kind="stable")]
        stride = max(1, len(near) // self._config.samples)
        tried = self._target[near[::stride][: self._config.samples]]
        return any(self._sees(position, point) for point in tried)

    def _sees(self, eye: NDArray[np.float64], point: NDArray[np.float64]) -> bool:
        """Whether no hiding point lies near the segment; sampled every half radius."""
        length = float(np.linalg.norm(point - eye))
        pieces = max(1, math.ceil(2.0 * length / self._config.radius_m))
        line = eye + np.linspace(0.0, 1.0, pieces + 1)[:, None] * (point - eye)
        distance, _ = self._hiding.query(line, distance_upper_bound=self._config.radius_m)
        return not bool(np.isfinite(distance).any())
