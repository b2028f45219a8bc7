"""The target in the map: is it there, is it seen from here, and when to stop."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
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

    sight_radius_m: float = 0.08
    """A mapped point this near to the line of sight hides what is behind it."""

    own_radius_m: float = 0.12
    """Points this near to the target's own point do not hide it: its edges, what it stands on."""

    sight_samples: int = 12
    """How many of the target's nearest points are tried; one in sight is enough."""


class GoalTracker:
    """Answers for S_sem, the target's part of the map; it keeps no state of its own."""

    def __init__(self, config: GoalConfig) -> None:
        """Take the thresholds."""
        self.config = config

    def points(self, view: MapView, target: str) -> NDArray[np.float32]:
        """S_sem: (N, 3) points of M_obj[target] within the current storey."""
        cloud = view.objects.get(target)
        if cloud is None:
            return np.zeros((0, 3), dtype=np.float32)
        height = cloud.points[:, 2] - view.floor_z
        on_floor = (height > self.config.min_height_m) & (height < self.config.max_height_m)
        return cloud.points[on_floor]

    def is_mapped(self, view: MapView, target: str) -> bool:
        """Whether T_target is in O."""
        return len(self.points(view, target)) >= self.config.min_points

    def reached(self, world_from_camera: Pose, view: MapView, target: str) -> bool:
        """Whether the agent stands within the stop distance of the target and sees it.

        The distance alone is not enough: the target may stand behind a wall.
        """
        points = self.points(view, target)
        if len(points) < self.config.min_points:
            return False
        return self.within_reach(world_from_camera.translation, points, view)

    def within_reach(self, eye: ArrayLike, points: NDArray[np.floating], view: MapView) -> bool:
        """Whether any of (N, 3) target points is within the stop distance of (3,) eye, in sight."""
        position = np.asarray(eye, dtype=np.float64)
        distance = np.hypot(points[:, 0] - position[0], points[:, 1] - position[1])
        near = np.flatnonzero(distance <= self.config.stop_distance_m)
        if not len(near):
            return False
        nearest = near[np.argsort(distance[near], kind="stable")]
        step = max(1, len(nearest) // self.config.sight_samples)
        samples = points[nearest[::step][: self.config.sight_samples]]
        hiding = self._points_around(position, view)
        return any(self._in_sight(position, sample, hiding) for sample in samples)

    def _points_around(self, eye: NDArray[np.float64], view: MapView) -> NDArray[np.float64]:
        """Mapped points that could hide something within the stop distance."""
        points = view.scene.points
        reach = self.config.stop_distance_m + self.config.sight_radius_m
        near = (np.abs(points[:, 0] - eye[0]) <= reach) & (np.abs(points[:, 1] - eye[1]) <= reach)
        return points[near].astype(np.float64)

    def _in_sight(
        self, eye: NDArray[np.float64], target: NDArray[np.floating], hiding: NDArray[np.float64]
    ) -> bool:
        """Whether no mapped point lies on the segment from the eye to a target point."""
        segment = np.asarray(target, dtype=np.float64) - eye
        along = np.clip((hiding - eye) @ segment / max(float(segment @ segment), 1e-9), 0.0, 1.0)
        off_line = np.linalg.norm(hiding - (eye + along[:, None] * segment), axis=1)
        off_target = np.linalg.norm(hiding - target, axis=1)
        hides = (off_line < self.config.sight_radius_m) & (off_target > self.config.own_radius_m)
        return not hides.any()


def horizontal_distance(
    points: NDArray[np.floating], targets: NDArray[np.floating]
) -> NDArray[np.float64]:
    """(N,) horizontal distance of each of (N, 2 or 3) points to the nearest of (M, 2 or 3)."""
    distance, _ = cKDTree(targets[:, :2]).query(points[:, :2])
    return np.asarray(distance, dtype=np.float64)
