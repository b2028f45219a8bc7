"""A mapping pipeline of the usual kind, on Open3D: the measure of `toponav bench map`, no more.

What most systems of the field do with a frame: back-project it, transform it, add it to the merged
cloud, and downsample the merged cloud by voxel; likewise for every category, and for what is
navigable and what is in the way. What is navigable is interpolated from where the agent stands to
the floor that the frame shows, as InstructNav does at every step: its 25 points to each voxel of
floor, of which those near floor height count, downsampled by the grid before they are merged. Its
frontiers, its clustering of masks and its matching of objects by distances between their points,
all at every step too, are left out. The cost of a frame grows with the map. At a decision: the
matrix of distances from every navigable point to every point of each cloud that attracts or repels
it.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.distance import cdist

from toponav.errors import MissingExtraError
from toponav.mapping.semantic_map import MapConfig
from toponav.types import Detections, Observation

INTERPOLATED = 25
"""Points of InstructNav from where the agent stands to a point of floor (its `mapper.py`)."""


class Open3dPipeline:
    """M_scene, M_obj, M_nav and M_obs as merged clouds, downsampled after every frame."""

    def __init__(self, config: MapConfig) -> None:
        """Start with empty clouds.

        Raises:
            MissingExtraError: Open3D is not installed.
        """
        try:
            import open3d
        except (ImportError, OSError) as error:  # OSError: a system library is missing
            raise MissingExtraError(
                f"the comparison needs Open3D ({error}): pip install open3d, or leave --open3d out"
            ) from None
        self._open3d: Any = open3d
        self._config = config
        self._clouds: dict[str, Any] = {}

    def integrate(self, observation: Observation, detections: Detections) -> None:
        """Add one observation."""
        config = self._config
        whole = self._points(observation, observation.depth)
        self._merge("scene", whole)
        for label in dict.fromkeys(detections.labels):
            chosen = [k for k, name in enumerate(detections.labels) if name == label]
            mask = detections.masks[chosen].any(axis=0)
            seen = np.where(mask, observation.depth, np.float32(0.0))
            self._merge(f"object {label}", self._points(observation, seen))
        stand = observation.world_from_base.translation
        heights = np.asarray(whole.points)[:, 2] - stand[2]
        level = np.abs(heights) <= config.delta
        in_the_way = (heights > config.delta) & (heights < config.obstacle_top_m)
        floor = whole.select_by_index(np.flatnonzero(level))
        self._merge("navigable", self._interpolated(stand, floor.voxel_down_sample(config.r_pcd)))
        self._merge("obstacles", whole.select_by_index(np.flatnonzero(in_the_way)))

    def pair_distances(self, targets: Sequence[NDArray[np.floating]]) -> None:
        """What affordances are made of: from M_nav to the nearest of (N, 3) targets, and of M_obs.

        By point-pair distance matrices, as is usual; Open3D's own search of the nearest neighbours
        would be the faster way.
        """
        navigable, obstacles = (
            np.asarray(self._clouds[name].points) for name in ("navigable", "obstacles")
        )
        for points in (*targets, obstacles):
            cdist(navigable, points).min(axis=1)

    def _points(self, observation: Observation, depth: NDArray[np.float32]) -> Any:
        """The points of a depth image, in colour, in the world frame."""
        geometry, camera = self._open3d.geometry, observation.intrinsics
        image = geometry.RGBDImage.create_from_color_and_depth(
            geometry.Image(observation.rgb),
            geometry.Image(np.ascontiguousarray(depth)),
            depth_scale=1.0,
            depth_trunc=self._config.max_depth_m,
            convert_rgb_to_intensity=False,
        )
        intrinsic = self._open3d.camera.PinholeCameraIntrinsic(
            camera.width, camera.height, camera.fx, camera.fy, camera.cx, camera.cy
        )
        cloud = geometry.PointCloud.create_from_rgbd_image(image, intrinsic)
        return cloud.transform(observation.world_from_camera.matrix)

    def _interpolated(self, stand: NDArray[np.float64], floor: Any) -> Any:
        """Points from where the agent stands to the floor that it sees, downsampled by the grid."""
        seen = np.asarray(floor.points)
        points = np.linspace(np.broadcast_to(stand, seen.shape), seen, INTERPOLATED).reshape(-1, 3)
        points = points[np.abs(points[:, 2] - stand[2]) <= self._config.delta]
        cloud = self._open3d.geometry.PointCloud(self._open3d.utility.Vector3dVector(points))
        cloud.paint_uniform_color((0.4, 0.4, 0.4))
        return cloud.voxel_down_sample(self._config.r_g)

    def _merge(self, name: str, new: Any) -> None:
        known = self._clouds.get(name)
        merged = new if known is None else known + new
        self._clouds[name] = merged.voxel_down_sample(self._config.r_pcd)
