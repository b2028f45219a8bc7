"""The map of Section III-C by brute force: every point kept, every cloud computed from scratch.

One floor at a time; slow, and simple enough to be checked by reading.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from toponav.mapping.semantic_map import MapConfig
from toponav.types import Detections, Observation

Voxel = tuple[int, int, int]


def voxels_of(points: NDArray[np.float64], resolution: float) -> list[Voxel]:
    return [tuple(row) for row in np.floor(points / resolution).astype(int).tolist()]


@dataclass
class ReferenceCloud:
    """Points by voxel, in order of first observation."""

    resolution: float
    members: dict[Voxel, list[NDArray[np.float64]]] = field(default_factory=dict)
    colors: dict[Voxel, list[NDArray[np.uint8]]] = field(default_factory=dict)

    def add(self, points: NDArray[np.float64], colors: NDArray[np.uint8] | None = None) -> None:
        colors = np.zeros((len(points), 3), np.uint8) if colors is None else colors
        for voxel, point, color in zip(
            voxels_of(points, self.resolution), points, colors, strict=True
        ):
            self.members.setdefault(voxel, []).append(point)
            self.colors.setdefault(voxel, []).append(color)

    @property
    def voxels(self) -> list[Voxel]:
        return list(self.members)

    def centroids(self) -> NDArray[np.float64]:
        return np.array([np.mean(group, axis=0) for group in self.members.values()]).reshape(-1, 3)

    def mean_colors(self) -> NDArray[np.float64]:
        return np.array([np.mean(group, axis=0) for group in self.colors.values()]).reshape(-1, 3)

    def counts(self) -> NDArray[np.int64]:
        return np.array([len(group) for group in self.members.values()], int)


def world_points(
    observation: Observation, config: MapConfig, mask: NDArray[np.bool_] | None = None
) -> tuple[NDArray[np.float64], NDArray[np.uint8]]:
    """Eq. (1) and (2), pixel by pixel in raster order."""
    camera, depth = observation.intrinsics, observation.depth.astype(np.float64)
    valid = (depth > config.min_depth_m) & (depth < config.max_depth_m)
    kept = np.zeros_like(valid)
    kept[:: config.pixel_stride, :: config.pixel_stride] = True
    valid &= kept
    if mask is not None:
        valid &= mask
    v, u = np.nonzero(valid)
    rays = np.column_stack(
        [(u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy, np.ones(len(u))]
    )
    in_camera = depth[v, u, None] * rays
    return observation.world_from_camera.apply(in_camera), observation.rgb[v, u]


class ReferenceMap:
    """M_scene, M_obj, M_nav, M_obs and G of one floor."""

    def __init__(self, config: MapConfig, floor_z: float) -> None:
        self.config = config
        self.floor_z = floor_z
        self.scene = ReferenceCloud(config.r_pcd)
        self.objects: dict[str, ReferenceCloud] = {}
        self.bridges: dict[Voxel, NDArray[np.float64]] = {}

    def integrate(self, observation: Observation, detections: Detections) -> NDArray[np.float64]:
        """Add a frame; returns its navigable points."""
        points, colors = world_points(observation, self.config)
        self.scene.add(points, colors)
        labels = np.array(detections.labels, np.str_)
        for label in dict.fromkeys(detections.labels):
            union = detections.masks[labels == label].any(axis=0)
            cloud = self.objects.setdefault(label, ReferenceCloud(self.config.r_pcd))
            cloud.add(*world_points(observation, self.config, union))
        seen = list(dict.fromkeys(voxels_of(points, self.config.r_pcd)))
        navigable = self.observed_navigable()
        targets = [navigable[voxel] for voxel in seen if voxel in navigable]
        self._bridge(observation.world_from_base.translation, targets, navigable)
        return np.array(targets).reshape(-1, 3)

    def stairs(self) -> set[Voxel]:
        categories = [c for c in self.config.navigable_categories if c in self.objects]
        return {voxel for category in categories for voxel in self.objects[category].members}

    def observed_navigable(self) -> dict[Voxel, NDArray[np.float64]]:
        stairs, delta = self.stairs(), self.config.delta
        return {
            voxel: point
            for voxel, point in zip(self.scene.voxels, self.scene.centroids(), strict=True)
            if voxel in stairs or abs(point[2] - self.floor_z) <= delta
        }

    def navigable(self) -> dict[Voxel, NDArray[np.float64]]:
        observed = self.observed_navigable()
        columns = {voxel[:2] for voxel in observed}
        bridges = {v: p for v, p in self.bridges.items() if v[:2] not in columns}
        return {**bridges, **observed}

    def obstacles(self) -> dict[Voxel, NDArray[np.float64]]:
        stairs = self.stairs()
        low, high = self.floor_z + self.config.delta, self.floor_z + self.config.obstacle_top_m
        return {
            voxel: point
            for voxel, point in zip(self.scene.voxels, self.scene.centroids(), strict=True)
            if voxel not in stairs and low < point[2] < high
        }

    def cells(self) -> dict[tuple[int, int], int]:
        """G by world cell index, without the unknown."""
        free = [self._cell(voxel) for voxel in self.navigable()]
        support: dict[tuple[int, int], int] = {}
        for voxel in self.obstacles():
            support[self._cell(voxel)] = support.get(self._cell(voxel), 0) + 1
        blocked = [c for c, n in support.items() if n >= self.config.min_obstacle_voxels]
        return {**dict.fromkeys(free, 1), **dict.fromkeys(blocked, -1)}

    def _cell(self, voxel: Voxel) -> tuple[int, int]:
        return (voxel[0] // self.config.columns_per_cell, voxel[1] // self.config.columns_per_cell)

    def _bridge(
        self,
        foot: NDArray[np.float64],
        targets: Sequence[NDArray[np.float64]],
        navigable: dict[Voxel, NDArray[np.float64]],
    ) -> None:
        config = self.config
        points = []
        steps = int(config.standing_radius_m / config.r_pcd)
        for i in range(-steps, steps + 1):
            for j in range(-steps, steps + 1):
                offset = np.array([i * config.r_pcd, j * config.r_pcd, 0.0])
                if np.hypot(offset[0], offset[1]) <= config.standing_radius_m:
                    points.append(foot + offset)
        stand = np.array([foot[0], foot[1], self.floor_z])
        aimed_at: set[tuple[int, int]] = set()
        for target in targets:
            cell = self._cell(voxels_of(target[None], config.r_pcd)[0])
            if cell in aimed_at:
                continue
            aimed_at.add(cell)
            distance = float(np.linalg.norm(target - stand))
            for k in range(1, int(distance / config.delta_step) + 1):
                point = stand + k * config.delta_step / distance * (target - stand)
                if abs(point[2] - self.floor_z) < config.delta:
                    points.append(point)
        covered = {voxel[:2] for voxel in navigable} | {voxel[:2] for voxel in self.bridges}
        for voxel, point in zip(voxels_of(np.array(points), config.r_pcd), points, strict=True):
            if voxel[:2] not in covered:
                covered.add(voxel[:2])
                self.bridges[voxel] = point
