"""The target in the map: is it there, where to stand, and when to stop."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from toponav.config_model import ConfigModel
from toponav.geometry import Pose
from toponav.mapping.view import MapView


class GoalConfig(ConfigModel):
    """When the target counts as mapped, and when the agent stops."""

    min_points: int = 4
    """Voxels of M_obj[target] before T_target counts as a member of O: one stray pixel is none."""

    stop_distance_m: float = 0.8
    """Stop within this horizontal distance of the target's cloud: the benchmark's viewpoints lie
    within 1 m of the object's surface, and the cloud may miss its nearest part."""

    min_height_m: float = 0.05
    """Points lower than this above the floor are floor that bled into the mask."""

    max_height_m: float = 2.5
    """Points higher than this belong to the next storey."""


class GoalTracker:
    """Answers for S_sem, the target's part of the map; it keeps no state of its own."""

    def __init__(self, config: GoalConfig) -> None:
        """Take the thresholds."""
        self._config = config

    def points(self, view: MapView, target: str) -> NDArray[np.float32]:
        """S_sem: (N, 3) points of M_obj[target] within the current storey."""
        cloud = view.objects.get(target)
        if cloud is None:
            return np.zeros((0, 3), dtype=np.float32)
        height = cloud.points[:, 2] - view.floor_z
        on_floor = (height > self._config.min_height_m) & (height < self._config.max_height_m)
        return cloud.points[on_floor]

    def is_mapped(self, view: MapView, target: str) -> bool:
        """Whether T_target is in O."""
        return len(self.points(view, target)) >= self._config.min_points

    def reached(self, world_from_base: Pose, view: MapView, target: str) -> bool:
        """Whether the agent stands within the stop distance of the mapped target."""
        points = self.points(view, target)
        if len(points) < self._config.min_points:
            return False
        distance, _ = cKDTree(points[:, :2]).query(world_from_base.translation[:2])
        return bool(distance <= self._config.stop_distance_m)
