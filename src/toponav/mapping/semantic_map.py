"""The semantic point cloud map M_scene, M_obj, M_nav, M_obs, M_fro, frame by frame (Section III-C).

Where the paper is silent, or where it is departed from:

- z_floor is the height of the agent's foot point where it entered the floor; every floor has its
  own M_nav, M_obs, G and M_fro (`floors`).
- M_obs ends at `obstacle_top_m`, and voxels of C_nav (stairs) are never in it: else every lintel
  would close its doorway, and every stair bar the way that it is.
- The ground under the agent is navigable. Interpolated points only fill columns in which no floor
  was observed (`interpolation`), and never move the centroid of an observed voxel.
- A cell with points of both M_nav and M_obs is an obstacle.
- A frontier point is the centre of its cell, not the corner (`frontiers`).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from toponav.config_model import ConfigModel
from toponav.errors import ObservationError, StaleViewError
from toponav.mapping.back_projection import PosedFrame
from toponav.mapping.clearing import Clearing, ClearingConfig, Voxels
from toponav.mapping.flight_finder import FlightFinder
from toponav.mapping.flights import (
    beside_unknown,
    ends_of_flights,
    filled_flights,
    tread_heights,
)
from toponav.mapping.floors import Floor, FloorLayers
from toponav.mapping.frame_sums import MAX_LABELS, DepthWindow, FrameSums, Masks, Scratch
from toponav.mapping.frontiers import FrontierMap
from toponav.mapping.ground import height_of, heights_ahead, level_area_m2, points_near
from toponav.mapping.interpolation import Spacing, disc, interpolate
from toponav.mapping.occupancy import FloorGrid
from toponav.mapping.surroundings import Surroundings
from toponav.mapping.view import (
    FREE,
    DeferredCloud,
    FrameUpdate,
    MapView,
    OccupancyGrid,
    PointCloud,
)
from toponav.mapping.voxels import EMPTY, VoxelCloud, columns_of, frozen, lowest_of
from toponav.types import Detections, Observation

NEAR_END_M = 0.9
"""This far above the next floor the end of a flight is near: what the map knows of that floor
counts, and no single frame need show it. Above the foot, ceilings look like floors."""

HALF_WAY_M = 0.5
"""Half-way between two floors the agent stays on the one it comes from until it is this much nearer
to the other."""


class MapConfig(ConfigModel):
    """Resolutions and heights of the map.

    The paper names r_pcd, r_g, delta and Delta_step and gives no values; r_pcd and r_g are those of
    InstructNav, on which it builds.
    """

    r_pcd: float = Field(default=0.05, gt=0.0)
    """Edge of a voxel of the point clouds, metres."""

    r_g: float = Field(default=0.1, gt=0.0)
    """Edge of a cell of the grid G, metres; a whole multiple of r_pcd."""

    delta: float = Field(default=0.15, gt=0.0)
    """Floor irregularities: points within delta of z_floor, metres, are navigable. A little under
    the 0.2 m that the agent can climb, since a voxel's centroid lies below its top."""

    delta_step: float = Field(default=0.05, gt=0.0)
    """Distance between interpolated points of M_nav, metres: one a voxel."""

    obstacle_top_m: float = Field(default=1.0, gt=0.0)
    """Height over the floor from which on points are no obstacles: ceilings, lintels and lamps are
    not in the way of an agent 0.88 m tall."""

    min_depth_m: float = Field(default=0.0, ge=0.0)
    """Depths at or under it are ignored, metres."""

    max_depth_m: float = Field(default=5.0, gt=0.0)
    """Depths at or over it are ignored, metres: the range of the protocol's sensor."""

    pixel_stride: int = Field(default=1, ge=1)
    """Every how many rows and columns a pixel is used."""

    navigable_categories: tuple[str, ...] = ("stairs",)
    """C_nav: navigable at any height."""

    standing_radius_m: float = Field(default=0.2, ge=0.0)
    """The ground within this distance of the foot point, metres, is navigable: the agent, of radius
    0.18 m, stands there, and its camera never sees it."""

    min_obstacle_voxels: int = Field(default=1, ge=1)
    """Voxels of M_obs over a cell that make it an obstacle; the paper's is 1."""

    min_frontier_cells: int = Field(default=4, ge=1)
    """Frontiers of fewer cells are dropped as noise (Yamauchi's minimum size)."""

    frontier_clearance_cells: int = Field(default=1, ge=0)
    """No obstacle lies within this many cells of a frontier cell, diagonals included: with 0.1 m
    cells and the default, a frontier keeps the agent's radius."""

    floor_separation_m: float = Field(default=1.2, gt=0.0)
    """A foot point farther than this from every known floor, metres, may stand on a new one."""

    level_area_m2: float = Field(default=1.0, gt=0.0)
    """Ground at foot height that a frame must show to found a new floor: more than a tread."""

    stairwells: bool = False
    """Stairs that lead down as well as up: no floor where lines of sight pass below it, though
    interpolation says so, no gaps in flights, and the next floor as soon as it is seen from them.
    Not in the paper."""

    stairs_by_shape: bool = False
    """Take for stairs (the first of C_nav) what has their shape, though no detector names it. Not
    in the paper."""

    drop_depth_m: float = Field(default=0.3, gt=0.0)
    """How far below the floor a line of sight must reach, metres: more than one step down."""

    clearing: ClearingConfig | None = None
    """Take out what is seen to have gone; without it the map keeps everything, as the paper's."""

    @model_validator(mode="after")
    def _check(self) -> MapConfig:
        if abs(self.r_g / self.r_pcd - self.columns_per_cell) > 1e-6 or not self.columns_per_cell:
            raise ValueError(f"r_g ({self.r_g}) must be a whole multiple of r_pcd ({self.r_pcd})")
        if not self.delta < self.obstacle_top_m < self.floor_separation_m - self.delta:
            raise ValueError(
                "heights must satisfy delta < obstacle_top_m < floor_separation_m - delta"
            )
        if self.stairs_by_shape and not self.navigable_categories:
            raise ValueError("stairs_by_shape needs a category in navigable_categories")
        return self

    @property
    def columns_per_cell(self) -> int:
        """r_g / r_pcd."""
        return round(self.r_g / self.r_pcd)


class MapParts(NamedTuple):
    """What a map consists of.

    Attributes:
        scene: M_scene.
        objects: M_obj by category.
        floors: In the order of discovery.
    """

    scene: VoxelCloud
    objects: Mapping[str, VoxelCloud]
    floors: tuple[Floor, ...]


class SemanticMap:
    """M_scene, M_obj, M_nav, M_obs and M_fro of Section III-C, grown frame by frame.

    A frame costs what the frame holds, not what the map holds, but for those that found a floor or
    find a flight of stairs.
    """

    def __init__(self, config: MapConfig | None = None) -> None:
        """Create an empty map."""
        self.config = config or MapConfig()
        self._scratch = Scratch()
        self.reset()

    def reset(self) -> None:
        """Forget everything."""
        config = self.config
        self._scene = VoxelCloud(config.r_pcd)
        self._objects: dict[str, VoxelCloud] = {}
        self._surroundings = Surroundings(self._objects)
        self._layers = FloorLayers(self._scene, config.delta, config.obstacle_top_m)
        self._floor: Floor | None = None
        self._view: MapView | None = None
        self._frames = 0
        self._clearing = None if config.clearing is None else Clearing(config.clearing)
        self._finder = FlightFinder() if config.stairs_by_shape else None

    @property
    def nbytes(self) -> int:
        """Memory that the map holds, bytes."""
        clouds = (self._scene, *self._objects.values())
        extras = (self._layers, self._surroundings, self._clearing, self._finder)
        return sum(part.nbytes for part in (*clouds, *extras) if part is not None)

    def integrate(self, observation: Observation, detections: Detections) -> FrameUpdate:
        """Add one observation.

        Args:
            observation: O_t.
            detections: What a detector saw in its image; a pixel counts for every category that
                has a mask over it, as the paper's M_obj are independent of each other.

        Returns:
            The floor points and the categories of this frame.

        Raises:
            ObservationError: The masks are not of the image's size, or the pose is out of reach.
        """
        config = self.config
        if detections.masks.shape[1:] != observation.depth.shape:
            raise ObservationError(
                f"masks must be of the image's size {observation.depth.shape}, "
                f"not {detections.masks.shape[1:]}"
            )
        self._view = None
        self._frames += 1
        window = DepthWindow(config.min_depth_m, config.max_depth_m, config.pixel_stride)
        frame = PosedFrame(observation, window)
        labels = self._add_points(frame, detections)
        touched = self._scene.refresh()
        self._surroundings.changed(self._scene.arrays.points, touched)
        floor = self._enter_floor(observation, touched)
        self._layers.update(touched)
        if self._find_flights(floor, touched):
            labels = tuple(dict.fromkeys((*labels, self.config.navigable_categories[0])))
        navigable = touched[self._layers.are_navigable(touched, floor)]
        points = self._scene.arrays.points[navigable]
        foot = observation.world_from_base.translation
        self._bridge(floor, foot, points)
        if config.stairwells:
            self._hold_ground(floor, foot)
            self._look_below(floor, foot, frame, touched)
        return FrameUpdate(points, labels, self._clear(frame, touched))

    def leave(self) -> None:
        """The agent is somewhere else now: the next frame says on which floor."""
        self._floor, self._view = None, None

    def parts(self) -> MapParts:
        """What the map consists of, live."""
        return MapParts(self._scene, MappingProxyType(self._objects), self._layers.floors)

    def restore_scene(self, scene: VoxelCloud) -> None:
        """Start anew with another map's M_scene; its objects and then its floors follow."""
        self.reset()
        self._scene = scene
        self._layers = FloorLayers(scene, self.config.delta, self.config.obstacle_top_m)

    def restore_object(self, label: str, cloud: VoxelCloud) -> None:
        """Take over M_obj of a category, whose voxels are in the scene."""
        self._objects[label] = cloud
        self._surroundings = Surroundings(self._objects)
        if label in self.config.navigable_categories:
            self._layers.mark_stairs(cloud.arrays.keys[: len(cloud)])

    def restore_floor(self, z: float) -> Floor:
        """Add the next floor of another map."""
        floor = self._new_floor(len(self._layers.floors), z)
        self._layers.add_floor(floor)
        if self._finder is not None:
            self._finder.look(floor.index, z, self._scene.cloud().points)
        return floor

    def view(self) -> MapView:
        """The map on the agent's current floor; its clouds are valid until the next `integrate`."""
        if self._view is None:
            self._view = self._make_view()
        return self._view

    def _add_points(self, frame: PosedFrame, detections: Detections) -> tuple[str, ...]:
        """M_scene, and M_obj^(c) of every detected category; returns those with a point."""
        labels = tuple(dict.fromkeys(detections.labels))
        rank = {label: index for index, label in enumerate(labels)}
        ranks = np.array([rank[label] for label in detections.labels], np.int64)
        seen = []
        for start in range(0, max(1, len(labels)), MAX_LABELS):
            chunk = labels[start : start + MAX_LABELS]
            bits = np.where(ranks < start + MAX_LABELS, ranks - start, -1)
            masks = Masks(detections.masks, bits)
            sums = frame.sums(self.config.r_pcd, masks, self._scratch)
            if start == 0:
                self._scene.add_sums(sums.voxels)
            seen += [label for bit, label in enumerate(chunk) if self._add(label, sums, bit)]
        return tuple(seen)

    def _clear(self, frame: PosedFrame, touched: NDArray[np.int32]) -> NDArray[np.float32]:
        """Take out what has gone; returns the (M, 3) centroids of those voxels."""
        if self._clearing is None:
            return np.empty((0, 3), np.float32)
        slots = self._scene.slots()
        voxels = Voxels(slots.points, slots.counts, self._layers.codes)
        self._clearing.watch(slots.points)
        gone = self._clearing.look(frame.images, voxels, self.config.r_pcd, touched)
        if len(gone):
            keys = self._scene.arrays.keys[gone]
            for cloud in (self._scene, *self._objects.values()):
                found = cloud.find(keys)
                cloud.clear(found[found != EMPTY])
            self._layers.update(gone)
            self._surroundings.changed(slots.points, gone)
        return slots.points[gone]

    def _add(self, label: str, sums: FrameSums, bit: int) -> bool:
        """M_obj^(c) of one category; returns whether there was anything to add."""
        cloud = self._objects.get(label) or VoxelCloud(self.config.r_pcd)
        if not cloud.add_sums(sums.voxels, sums.labels, bit):
            return False
        self._objects[label] = cloud
        touched = cloud.refresh()
        if label in self.config.navigable_categories:
            self._layers.mark_stairs(cloud.arrays.keys[touched])
        return True

    def _find_flights(self, floor: Floor, touched: NDArray[np.int32]) -> bool:
        """Label what has the shape of stairs; returns whether this frame shows any of it."""
        if self._finder is None:
            return False
        points = self._scene.arrays.points[touched]
        news = self._finder.look(floor.index, floor.z, points)
        news |= self._finder.grow(points)
        if not self._finder.has_flights:
            return False
        slots = np.arange(len(self._scene), dtype=np.int32) if news else touched
        inside = slots[self._finder.inside(self._scene.arrays.points[slots])]
        own = inside[self._scene.arrays.counts[inside] > 0]
        if not len(own):
            return False
        category = self.config.navigable_categories[0]
        cloud = self._objects.setdefault(category, VoxelCloud(self.config.r_pcd))
        cloud.add_sums(self._scene.one_of_each(own))
        cloud.refresh()
        self._surroundings.changed(self._scene.arrays.points, own)
        self._layers.mark_stairs(self._scene.arrays.keys[own])
        self._layers.update(own)
        return True

    def _enter_floor(self, observation: Observation, touched: NDArray[np.int32]) -> Floor:
        """The floor that the agent is on: the nearest one, until it stands on another.

        Away from all known floors (on stairs) the last floor stays, until a frame shows level
        ground at the agent's feet: then it has arrived on a new one.
        """
        foot_z = float(observation.world_from_base.translation[2])
        floors = self._layers.floors
        nearest = min(floors, key=lambda floor: abs(floor.z - foot_z), default=None)
        if nearest is not None and abs(nearest.z - foot_z) <= self.config.floor_separation_m:
            nearer = 0.0 if self._floor is None else abs(self._floor.z - foot_z)
            nearer -= abs(nearest.z - foot_z)
            if self._floor is None or nearer > (HALF_WAY_M if self.config.stairwells else 0.0):
                self._floor = nearest
            return self._floor
        foot = observation.world_from_base.translation
        z = foot_z if self._floor is None else self._ground_height(foot, touched)
        if z is not None:
            self._floor = self._new_floor(len(floors), z)
            self._layers.add_floor(self._floor)
        assert self._floor is not None
        return self._floor

    def _ground_height(self, foot: NDArray[np.float64], touched: NDArray[np.int32]) -> float | None:
        """Height of a new floor that the frame shows, or that a flight leads to; None without."""
        config = self.config
        points = self._scene.arrays.points[touched]
        if level_area_m2(points, foot[2], config.r_pcd) >= config.level_area_m2:
            return float(foot[2])
        if not config.stairwells or self._floor is None:
            return None
        about = points_near(self._scene.arrays.points[: len(self._scene)], foot)
        treads = self._scene.arrays.points[self._layers.stairs(self._floor)]
        for z in heights_ahead(foot, about, treads):
            if min(abs(floor.z - z) for floor in self._layers.floors) <= config.floor_separation_m:
                continue
            is_level = level_area_m2(about, z, config.r_pcd) >= config.level_area_m2
            ends_here = 0.0 <= foot[2] - z <= NEAR_END_M
            if is_level and ends_here:
                return height_of(about, z)
            if level_area_m2(points, z, config.r_pcd) >= config.level_area_m2:
                return height_of(points, z)
            if is_level and z < foot[2]:
                return None  # what is level above the lowest is a seat or a table
        return None

    def _new_floor(self, index: int, z: float) -> Floor:
        config = self.config
        grid = self._empty_grid()
        frontiers = FrontierMap(grid, config.frontier_clearance_cells, config.min_frontier_cells)
        return Floor(index, z, grid, frontiers, VoxelCloud(config.r_pcd), VoxelCloud(config.r_pcd))

    def _empty_grid(self) -> FloorGrid:
        config = self.config
        return FloorGrid(config.r_g, config.columns_per_cell, config.min_obstacle_voxels)

    def _bridge(
        self, floor: Floor, foot: NDArray[np.float64], targets: NDArray[np.float32]
    ) -> None:
        """Make the ground under the agent, and between it and what it sees, navigable."""
        config = self.config
        spacing = Spacing(config.delta_step, config.delta, config.r_pcd, config.columns_per_cell)
        under_foot = disc(foot, config.standing_radius_m, config.r_pcd)
        self._add_bridges(floor, under_foot)
        stand = np.array([foot[0], foot[1], floor.z])
        self._add_bridges(floor, interpolate(stand, targets, floor.grid, spacing))

    def _hold_ground(self, floor: Floor, foot: NDArray[np.float64]) -> None:
        """Where the agent stands there is ground, though it may be a tread."""
        under_foot = disc(foot, self.config.standing_radius_m, self.config.r_pcd)
        if abs(foot[2] - floor.z) > self.config.delta:
            floor.treads.add(under_foot)
            floor.treads.refresh()
        floor.grid.hold(np.floor(under_foot[:, :2] / self.config.r_pcd).astype(np.int64))

    def _look_below(
        self,
        floor: Floor,
        foot: NDArray[np.float64],
        frame: PosedFrame,
        touched: NDArray[np.int32],
    ) -> None:
        """Where the frame looks below the floor on which the agent stands."""
        config = self.config
        if abs(foot[2] - floor.z) >= config.drop_depth_m:
            return
        lowest = lowest_of(self._scene.arrays.keys[touched])
        if lowest * config.r_pcd > floor.z - config.drop_depth_m:
            return
        columns = frame.columns_seen_through(floor.z, config.drop_depth_m, config.r_pcd)
        floor.grid.see_through(columns)

    def _add_bridges(self, floor: Floor, points: NDArray[np.float64]) -> None:
        columns = np.floor(points[:, :2] / self.config.r_pcd).astype(np.int64)
        new = floor.grid.bridge(columns)
        if new.any():
            floor.bridges.add(points[new])
            floor.bridges.refresh()

    def _make_view(self) -> MapView:
        slots = self._scene.slots()
        scene = self._deferred(self._scene.cloud) if self._scene.has_gaps else slots
        clouds = {label: cloud.cloud() for label, cloud in self._objects.items()}
        objects = {label: cloud for label, cloud in clouds.items() if len(cloud)}
        if self._floor is None:
            nothing = VoxelCloud(self.config.r_pcd).cloud()
            grid = self._empty_grid().snapshot()
            return MapView(
                scene=scene,
                objects=MappingProxyType(objects),
                navigable=nothing,
                obstacles=nothing,
                frontiers=np.empty((0, 3)),
                frontier_labels=np.empty(0, np.int64),
                grid=grid,
                floor_z=0.0,
            )
        floor = self._floor
        grid = self._grid(floor)
        frontier_xy, frontier_labels = floor.frontiers.find()
        if self.config.stairwells and grid.stairs is not None:
            kept = beside_unknown(grid, frontier_xy) & ends_of_flights(grid, frontier_xy)
            frontier_xy, frontier_labels = frontier_xy[kept], frontier_labels[kept]
        frontier_z = np.full((len(frontier_xy), 1), floor.z)
        return MapView(
            scene=scene,
            objects=MappingProxyType(objects),
            navigable=self._deferred(lambda: self._navigable(floor, slots)),
            obstacles=self._deferred(lambda: _rows((slots, self._layers.obstacles(floor)))),
            frontiers=frozen(np.hstack([frontier_xy, frontier_z])),
            frontier_labels=frozen(frontier_labels),
            grid=grid,
            floor_z=floor.z,
            floor=floor.index,
            object_search=self._surroundings,
        )

    def _deferred(self, make: Callable[[], PointCloud]) -> PointCloud:
        """A cloud of the map as it is now, which must be looked at before the next frame."""
        frames = self._frames

        def make_in_time() -> PointCloud:
            if self._frames != frames:
                raise StaleViewError("a map's clouds must be looked at before its next frame")
            return make()

        return DeferredCloud(make_in_time)

    def _grid(self, floor: Floor) -> OccupancyGrid:
        """G, with the heights of the stairs on it.

        With `stairwells`, gaps between treads are filled, and on treads far enough down what is an
        obstacle on the floor is over the agent's head.
        """
        config = self.config
        grid = floor.grid.snapshot()
        seen = self._scene.arrays.points[self._layers.stairs(floor)]
        heights = tread_heights(grid, seen, floor.treads.cloud().points, floor.z)
        if heights is None:
            return grid
        if not config.stairwells:
            return replace(grid, stairs=frozen(heights))
        cells, heights = filled_flights(grid, heights, floor.grid.floor_cells())
        cells[heights < config.delta - config.obstacle_top_m] = FREE
        return replace(grid, cells=frozen(cells), stairs=frozen(heights))

    def _navigable(self, floor: Floor, slots: PointCloud) -> PointCloud:
        """M_nav: the observed voxels, then the bridges where nothing was observed."""
        bridges = floor.bridges.cloud()
        columns = columns_of(floor.bridges.arrays.keys[: len(bridges)])
        gaps = np.flatnonzero(~floor.grid.observed(columns))
        return _rows((slots, self._layers.navigable(floor)), (bridges, gaps))


def _rows(*parts: tuple[PointCloud, NDArray[np.int64]]) -> PointCloud:
    """Chosen rows of clouds, one cloud after the other."""
    points, colors, counts = (
        np.concatenate([getattr(cloud, name)[rows] for cloud, rows in parts])
        for name in ("points", "colors", "counts")
    )
    return PointCloud(frozen(points), frozen(colors), frozen(counts))
