"""The semantic point cloud map of Section III-C: M_scene, M_obj, M_nav, M_obs, M_fro and G.

Incremental: a frame costs what the frame holds, not what the map holds. Where the paper is silent
or is departed from:

- the height bands are applied to points before downsampling; that differs from the paper only in
  voxels that straddle a band's edge;
- obstacles end at `obstacle_top_m` above the floor: a ceiling, a lamp or a lintel is no obstacle
  for an agent of 0.88 m;
- points of C_nav (stairs) are never obstacles, or their steps would bar the way that they are;
- a frontier point is the centre of its cell, not the corner.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from toponav.config_model import ConfigModel
from toponav.mapping.floors import FloorTracker
from toponav.mapping.frontiers import frontier_cells
from toponav.mapping.integration import NO_LABEL, integrate_frame, interpolate_to
from toponav.mapping.occupancy import OccupancyCounts
from toponav.mapping.view import FrameUpdate, MapView, OccupancyGrid, PointCloud
from toponav.mapping.voxels import MAX_TAGS, VoxelCloud
from toponav.types import Detections, Observation


class MapConfig(ConfigModel):
    """Parameters of the map, by the paper's symbols where it has one."""

    r_pcd: float = Field(default=0.05, gt=0.0)
    """Voxel size of all clouds, metres (InstructNav's, on which the paper builds)."""

    r_g: float = Field(default=0.1, gt=0.0)
    """Cell size of the grid G, metres; a whole multiple of r_pcd."""

    delta: float = Field(default=0.15, gt=0.0)
    """Half-height of the floor band, metres: below the protocol's climb of 0.2 m."""

    delta_step: float = Field(default=0.1, gt=0.0)
    """Spacing of the points interpolated from the standing point, metres."""

    obstacle_top_m: float = Field(default=1.0, gt=0.0)
    """Points higher above the floor are no obstacle: the agent's 0.88 m and a margin."""

    max_depth_m: float = Field(default=5.0, gt=0.0)
    """Depth at or beyond this is no return (PROTOCOL)."""

    navigable_categories: tuple[str, ...] = ("stairs",)
    """C_nav: classes whose points are navigable whatever their height."""

    min_obstacle_voxels: int = Field(default=1, ge=1)
    """Voxels of M_obs that make a cell an obstacle; more for noisy depth."""

    min_frontier_cells: int = Field(default=4, ge=1)
    """Smaller clusters of frontier cells are dropped."""

    frontier_clearance_cells: int = Field(default=1, ge=0)
    """Frontier cells keep this far from obstacles, cells."""

    standing_radius_m: float = Field(default=0.2, gt=0.0)
    """The disc under the agent is navigable, since it stands there; the camera never sees it."""

    @model_validator(mode="after")
    def _cells_hold_whole_voxels(self) -> MapConfig:
        ratio = self.r_g / self.r_pcd
        if abs(ratio - round(ratio)) > 1e-6 or round(ratio) < 1:
            raise ValueError(f"r_g ({self.r_g}) must be a whole multiple of r_pcd ({self.r_pcd})")
        return self


class _FloorLayer:
    """What is kept for each floor: M_nav, M_obs and G."""

    def __init__(self, floor_z: float, config: MapConfig) -> None:
        self.floor_z = floor_z
        self.navigable = VoxelCloud(config.r_pcd)
        self.obstacles = VoxelCloud(config.r_pcd)
        self.counts = OccupancyCounts(
            config.r_g, round(config.r_g / config.r_pcd), config.min_obstacle_voxels
        )
        self._counted = [0, 0]

    def count_new_voxels(self) -> bool:
        """Bring G up to date; says whether it changed."""
        new = []
        for k, cloud in enumerate((self.navigable, self.obstacles)):
            new.append(cloud.store.voxels[self._counted[k] : len(cloud)])
            self._counted[k] = len(cloud)
        return self.counts.add(*new)


class SemanticMap:
    """Builds the map frame by frame and hands out views of it."""

    def __init__(self, config: MapConfig | None = None) -> None:
        """Start with an empty map."""
        self.config = config or MapConfig()
        self._scene = VoxelCloud(self.config.r_pcd)
        self._objects = VoxelCloud(self.config.r_pcd)
        self._tags: dict[str, int] = {}
        self._object_clouds: dict[str, PointCloud] = {}
        self._floors = FloorTracker()
        self._layers: list[_FloorLayer] = []
        self._view: MapView | None = None
        self._grid: tuple[int, OccupancyGrid] | None = None
        self._frontiers = (np.zeros((0, 3)), np.zeros(0, np.int64))

    def integrate(self, observation: Observation, detections: Detections) -> FrameUpdate:
        """Add one posed RGB-D image with its detections.

        Where masks overlap, a pixel belongs to the detection of highest score.
        """
        floor = self._floors.update(observation.world_from_base.translation)
        while len(self._layers) <= floor:
            self._layers.append(_FloorLayer(self._floors.heights[len(self._layers)], self.config))
        layer = self._layers[floor]
        self._insert_frame(observation, detections, layer)
        self._scene.finish()
        self._forget_changed_clouds(self._objects.finish())
        seen = layer.navigable.at(layer.navigable.finish())
        layer.obstacles.finish()
        self._insert_standing_point(observation, seen, layer)
        layer.navigable.finish()
        if layer.count_new_voxels() or self._grid is None or self._grid[0] != floor:
            self._update_grid(floor, layer)
        self._view = None
        return FrameUpdate(seen.points, tuple(sorted(set(detections.labels))))

    def view(self) -> MapView:
        """The map on the agent's current floor; cheap, and valid until the next frame.

        Clouds are views of the map's storage: a later frame may refine their points.
        """
        if self._view is None:
            floor = self._floors.current
            layer = self._layers[floor]
            assert self._grid is not None
            self._view = MapView(
                scene=self._scene.cloud(),
                objects=self._classes(),
                navigable=layer.navigable.cloud(),
                obstacles=layer.obstacles.cloud(),
                frontiers=self._frontiers[0],
                frontier_labels=self._frontiers[1],
                grid=self._grid[1],
                floor_z=layer.floor_z,
                floor=floor,
            )
        return self._view

    def _insert_frame(
        self, observation: Observation, detections: Detections, layer: _FloorLayer
    ) -> None:
        """Run the fused pass, growing the clouds where they run out of room."""
        config, camera = self.config, observation.intrinsics
        clouds = (self._scene, self._objects, layer.navigable, layer.obstacles)
        labels = self._label_image(observation.depth.shape, detections)
        is_navigable = np.zeros(max(len(self._tags), 1), np.bool_)
        for category in config.navigable_categories:
            if category in self._tags:
                is_navigable[self._tags[category]] = True
        z = layer.floor_z
        limits = (config.max_depth_m, z - config.delta, z + config.delta, z + config.obstacle_top_m)
        done, total = 0, observation.depth.size
        while True:
            done = integrate_frame(
                observation.depth,
                observation.rgb,
                labels,
                (camera.fx, camera.fy, camera.cx, camera.cy),
                np.ascontiguousarray(observation.world_from_camera.matrix[:3]),
                limits,
                is_navigable,
                config.r_pcd,
                self._scene.store,
                self._objects.store,
                layer.navigable.store,
                layer.obstacles.store,
                done,
            )
            if done >= total:
                return
            for cloud in clouds:
                cloud.make_room()

    def _label_image(self, shape: tuple[int, ...], detections: Detections) -> NDArray[np.int16]:
        """(H, W) tag of each pixel, the detection of highest score on top."""
        labels = np.full(shape, NO_LABEL, np.int16)
        for k in np.argsort(detections.scores, kind="stable"):
            tag = self._tags.setdefault(detections.labels[k], len(self._tags))
            if tag >= MAX_TAGS:
                raise OverflowError(f"the map holds at most {MAX_TAGS} object classes")
            labels[detections.masks[k]] = tag
        return labels

    def _insert_standing_point(
        self, observation: Observation, seen: PointCloud, layer: _FloorLayer
    ) -> None:
        """Interpolate from p_stand to this frame's floor points, and add the disc underfoot."""
        config = self.config
        x, y, _ = (float(v) for v in observation.world_from_base.translation)
        done = 0
        while True:
            done = interpolate_to(
                layer.navigable.store,
                (x, y, layer.floor_z),
                seen.points,
                seen.colors,
                config.delta_step,
                (layer.floor_z - config.delta, layer.floor_z + config.delta),
                config.r_pcd,
                done,
            )
            if done >= len(seen):
                break
            layer.navigable.grow()
        reach = np.arange(-config.standing_radius_m, config.standing_radius_m + 1e-9, config.r_pcd)
        dx, dy = (offset.ravel() for offset in np.meshgrid(reach, reach, indexing="ij"))
        inside = np.hypot(dx, dy) <= config.standing_radius_m
        disc = np.column_stack([x + dx, y + dy, np.full(dx.shape, layer.floor_z)])[inside]
        layer.navigable.add(disc)

    def _forget_changed_clouds(self, touched: NDArray[np.int32]) -> None:
        """Drop the cached clouds of the classes that this frame touched."""
        changed = set(np.unique(self._objects.store.tags[touched]).tolist())
        for category, tag in self._tags.items():
            if tag in changed:
                self._object_clouds.pop(category, None)

    def _classes(self) -> Mapping[str, PointCloud]:
        """M_obj^(c) of every class with a point, sorted by name."""
        for category, tag in self._tags.items():
            if category not in self._object_clouds:
                self._object_clouds[category] = self._objects.tagged(tag)
        return {
            c: self._object_clouds[c] for c in sorted(self._tags) if len(self._object_clouds[c])
        }

    def _update_grid(self, floor: int, layer: _FloorLayer) -> None:
        """Copy G and find its frontiers, re-projected to the floor's height."""
        config = self.config
        grid = layer.counts.grid()
        cells, labels = frontier_cells(
            grid, config.min_frontier_cells, config.frontier_clearance_cells
        )
        xy = grid.center_of(cells)
        points = np.column_stack([xy, np.full(len(xy), layer.floor_z)])
        self._grid = (floor, grid)
        self._frontiers = (points, labels)
