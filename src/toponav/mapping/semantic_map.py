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

from dataclasses import replace
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator
from scipy.ndimage import binary_closing, binary_opening, convolve, distance_transform_edt, maximum
from scipy.ndimage import label as connected

from toponav.config_model import ConfigModel
from toponav.errors import ObservationError
from toponav.mapping.back_projection import DepthWindow, FrameScatter
from toponav.mapping.floors import Floor, FloorLayers
from toponav.mapping.frontiers import FrontierMap
from toponav.mapping.interpolation import Spacing, disc, interpolate
from toponav.mapping.occupancy import FloorGrid
from toponav.mapping.view import (
    DROP,
    FREE,
    OCCUPIED,
    UNKNOWN,
    FrameUpdate,
    MapView,
    OccupancyGrid,
    PointCloud,
)
from toponav.mapping.voxels import VoxelCloud, columns_of, frozen
from toponav.types import Detections, Observation

LEVEL_TOLERANCE_M = 0.08
"""How far points may be above or below the foot to count as the ground that the agent stands on:
depth noise and a sill pass, the next tread of a stair (0.15 m and more) does not."""

TREAD_GAP_M = 0.6
"""Between treads this near to each other there are only treads: seen from above at a flat angle,
parts of a flight are hidden, and what is nearer to the foot than this lies under the image."""

NEIGHBOURS = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 1.0], [0.0, 1.0, 0.0]])

STEP_GAP_M = 0.4
"""Between the lowest tread and the floor, a riser and the shadow of an edge may be unseen."""

FLIGHT_END_M = 0.3
"""Treads this much below the highest of a flight, or above its lowest, are not its end."""

HALF_WAY_M = 0.5
"""Half-way between two floors the agent stays on the one it comes from until it is this much nearer
to the other."""

STEPS_UP_M = (0.1, 0.18, 0.26, 0.34, 0.42)
"""How far above the last treads of a flight the next floor may be."""

FLIGHT_M = 4.0
"""A flight is no longer than this, in plan."""

DEEPEST_M = 3.5
"""A floor is looked for this far below the foot of an agent on a flight: a storey."""

WALL_CHECK_M = 0.5
"""A column with points up to this far above the foot is a wall or a riser, not ground."""


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

    drops: bool = False
    """Note where lines of sight pass below the floor: a stairwell is no floor to walk on, though
    interpolation between the agent and the floor beyond it says so. Not in the paper."""

    drop_depth_m: float = Field(default=0.3, gt=0.0)
    """How far below the floor a line of sight must reach, metres: more than one step down."""

    @model_validator(mode="after")
    def _check(self) -> MapConfig:
        if abs(self.r_g / self.r_pcd - self.columns_per_cell) > 1e-6 or not self.columns_per_cell:
            raise ValueError(f"r_g ({self.r_g}) must be a whole multiple of r_pcd ({self.r_pcd})")
        if not self.delta < self.obstacle_top_m < self.floor_separation_m - self.delta:
            raise ValueError(
                "heights must satisfy delta < obstacle_top_m < floor_separation_m - delta"
            )
        return self

    @property
    def columns_per_cell(self) -> int:
        """r_g / r_pcd."""
        return round(self.r_g / self.r_pcd)


class SemanticMap:
    """M_scene, M_obj, M_nav, M_obs and M_fro of Section III-C, grown frame by frame.

    A frame costs what the frame holds, not what the map holds.
    """

    def __init__(self, config: MapConfig | None = None) -> None:
        """Create an empty map."""
        self.config = config or MapConfig()
        self.reset()

    def reset(self) -> None:
        """Forget everything."""
        config = self.config
        self._scene = VoxelCloud(config.r_pcd)
        self._objects: dict[str, VoxelCloud] = {}
        self._layers = FloorLayers(self._scene, config.delta, config.obstacle_top_m)
        self._floor: Floor | None = None
        self._view: MapView | None = None

    @property
    def nbytes(self) -> int:
        """Memory that the map holds, bytes."""
        clouds = (self._scene, *self._objects.values())
        return sum(cloud.nbytes for cloud in clouds) + self._layers.nbytes

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
        window = DepthWindow(config.min_depth_m, config.max_depth_m, config.pixel_stride)
        frame = FrameScatter(observation, window)
        frame.into(self._scene)
        labels = self._add_objects(frame, detections)
        touched = self._scene.refresh()
        floor = self._enter_floor(observation, touched)
        self._layers.update(touched)
        navigable = touched[self._layers.are_navigable(touched, floor)]
        points = self._scene.arrays.points[navigable]
        foot = observation.world_from_base.translation
        self._bridge(floor, foot, points)
        if config.drops:
            self._hold_ground(floor, foot)
            self._look_below(floor, foot, frame)
        return FrameUpdate(points, labels)

    def view(self) -> MapView:
        """The map on the agent's current floor.

        `scene` and `objects` are views of the live storage: valid until the next `integrate`.
        """
        if self._view is None:
            self._view = self._make_view()
        return self._view

    def _add_objects(self, frame: FrameScatter, detections: Detections) -> tuple[str, ...]:
        """M_obj^(c) of every detected category; returns those with at least one point."""
        seen = []
        labels = np.array(detections.labels, dtype=np.str_)
        for label in dict.fromkeys(detections.labels):
            masks = detections.masks[labels == label]
            known = self._objects.get(label)
            cloud = VoxelCloud(self.config.r_pcd) if known is None else known
            frame.into(cloud, masks[0] if len(masks) == 1 else masks.any(axis=0))
            touched = cloud.refresh()
            if not len(touched):
                continue
            seen.append(label)
            self._objects[label] = cloud
            if label in self.config.navigable_categories:
                self._layers.mark_stairs(cloud.arrays.keys[touched])
        return tuple(seen)

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
            if self._floor is None or nearer > (HALF_WAY_M if self.config.drops else 0.0):
                self._floor = nearest
            return self._floor
        z = foot_z if self._floor is None else self._ground_height(observation, touched)
        if z is not None:
            self._floor = self._new_floor(len(floors), z)
            self._layers.add_floor(self._floor)
        assert self._floor is not None
        return self._floor

    def _ground_height(self, observation: Observation, touched: NDArray[np.int32]) -> float | None:
        """Height of a new floor that the frame shows; None without.

        That is at the agent's feet or, where it walks down a flight, the lowest below its treads,
        or one step above the last tread.
        """
        foot = observation.world_from_base.translation
        foot_z = float(foot[2])
        points = self._scene.arrays.points[touched]
        if self._level_area(points, foot_z) >= self.config.level_area_m2:
            return foot_z
        if not self.config.drops:
            return None
        assert self._floor is not None
        treads = self._scene.arrays.points[self._layers.stairs(self._floor)]
        treads = treads[np.hypot(*(treads[:, :2] - foot[:2]).T) <= FLIGHT_M]
        lowest = max(float(points[:, 2].min(initial=foot_z)), foot_z - DEEPEST_M)
        below = np.arange(lowest, treads[:, 2].min(initial=foot_z), LEVEL_TOLERANCE_M)
        for z in (*below, *(foot_z + np.array(STEPS_UP_M))):
            apart = min(abs(floor.z - z) for floor in self._layers.floors)
            known = apart <= self.config.floor_separation_m
            if not known and self._level_area(points, z) >= self.config.level_area_m2:
                level = points[np.abs(points[:, 2] - z) <= LEVEL_TOLERANCE_M, 2]
                return float(np.median(level))
        return None

    def _level_area(self, points: NDArray[np.float32], z: float) -> float:
        """Area of level ground at a height, square metres; walls do not count."""
        above = points[:, 2] - z
        columns = np.floor(points[:, :2] / self.config.r_pcd).astype(np.int64) @ (1 << 32, 1)
        level = columns[np.abs(above) <= LEVEL_TOLERANCE_M]
        rising = columns[(above > LEVEL_TOLERANCE_M) & (above <= WALL_CHECK_M)]
        return len(np.setdiff1d(level, rising)) * self.config.r_pcd**2

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

    def _look_below(self, floor: Floor, foot: NDArray[np.float64], frame: FrameScatter) -> None:
        """Where the frame looks below the floor on which the agent stands."""
        config = self.config
        if abs(foot[2] - floor.z) >= config.drop_depth_m:
            return
        columns = frame.columns_seen_through(floor.z, config.drop_depth_m, config.r_pcd)
        floor.grid.see_through(columns)

    def _add_bridges(self, floor: Floor, points: NDArray[np.float64]) -> None:
        columns = np.floor(points[:, :2] / self.config.r_pcd).astype(np.int64)
        floor.bridges.add(points[floor.grid.bridge(columns)])
        floor.bridges.refresh()

    def _make_view(self) -> MapView:
        scene = self._scene.cloud()
        objects = {label: cloud.cloud() for label, cloud in self._objects.items()}
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
        if self.config.drops and grid.stairs is not None:
            kept = _beside_unknown(grid, frontier_xy) & _ends_of_flights(grid, frontier_xy)
            frontier_xy, frontier_labels = frontier_xy[kept], frontier_labels[kept]
        frontier_z = np.full((len(frontier_xy), 1), floor.z)
        return MapView(
            scene=scene,
            objects=MappingProxyType(objects),
            navigable=self._navigable(floor, scene),
            obstacles=_rows((scene, self._layers.obstacles(floor))),
            frontiers=frozen(np.hstack([frontier_xy, frontier_z])),
            frontier_labels=frozen(frontier_labels),
            grid=grid,
            floor_z=floor.z,
            floor=floor.index,
        )

    def _grid(self, floor: Floor) -> OccupancyGrid:
        """G, with the heights of the stairs on it.

        With `drops`, gaps between treads are filled, and on treads far enough down what is an
        obstacle on the floor is over the agent's head.
        """
        config = self.config
        grid = floor.grid.snapshot()
        stairs = self._scene.arrays.points[self._layers.stairs(floor)]
        treads = np.vstack([stairs, floor.treads.cloud().points])
        if not len(treads):
            return grid
        heights = np.full(grid.cells.shape, -np.inf, np.float32)
        cell = grid.index_of(treads)
        np.maximum.at(heights, (cell[:, 0], cell[:, 1]), treads[:, 2] - np.float32(floor.z))
        heights[np.isneginf(heights)] = np.nan
        if not config.drops:
            return replace(grid, stairs=frozen(heights))
        cells, heights = _filled_flights(grid, heights, floor.grid.floor_cells())
        cells[heights < config.delta - config.obstacle_top_m] = FREE
        return replace(grid, cells=frozen(cells), stairs=frozen(heights))

    def _navigable(self, floor: Floor, scene: PointCloud) -> PointCloud:
        """M_nav: the observed voxels, then the bridges where nothing was observed."""
        bridges = floor.bridges.cloud()
        columns = columns_of(floor.bridges.arrays.keys[: len(bridges)])
        gaps = np.flatnonzero(~floor.grid.observed(columns))
        return _rows((scene, self._layers.navigable(floor)), (bridges, gaps))


def _rows(*parts: tuple[PointCloud, NDArray[np.int64]]) -> PointCloud:
    """Chosen rows of clouds, one cloud after the other."""
    total = sum(len(rows) for _, rows in parts)
    points = np.empty((total, 3), np.float32)
    colors = np.empty((total, 3), np.uint8)
    counts = np.empty(total, np.int32)
    start = 0
    for cloud, rows in parts:
        chosen = slice(start, start + len(rows))
        # With mode "clip" NumPy writes straight into `out`; the rows are all valid.
        np.take(cloud.points, rows, axis=0, out=points[chosen], mode="clip")
        np.take(cloud.colors, rows, axis=0, out=colors[chosen], mode="clip")
        np.take(cloud.counts, rows, out=counts[chosen], mode="clip")
        start += len(rows)
    return PointCloud(frozen(points), frozen(colors), frozen(counts))


def _beside_unknown(grid: OccupancyGrid, xy: NDArray[np.float64]) -> NDArray[np.bool_]:
    """(N,) which of (N, 2) places lie in cells with an unknown 4-neighbour."""
    unknown = np.pad(grid.cells == UNKNOWN, 1, constant_values=True)
    i, j = (grid.index_of(xy) + 1).T
    beside: NDArray[np.bool_] = (
        unknown[i - 1, j] | unknown[i + 1, j] | unknown[i, j - 1] | unknown[i, j + 1]
    )
    return beside


def _ends_of_flights(grid: OccupancyGrid, xy: NDArray[np.float64]) -> NDArray[np.bool_]:
    """(N,) which of (N, 2) places are on the floor or at the end of a flight, not at its side."""
    assert grid.stairs is not None
    height = np.abs(np.nan_to_num(grid.stairs))
    flight, count = connected(height > FLIGHT_END_M)
    farthest = np.append(0.0, maximum(height, flight, np.arange(1, count + 1)))
    i, j = grid.index_of(xy).T
    ends: NDArray[np.bool_] = (flight[i, j] == 0) | (
        height[i, j] >= farthest[flight[i, j]] - FLIGHT_END_M
    )
    return ends


def _filled_flights(
    grid: OccupancyGrid, heights: NDArray[np.float32], floor: NDArray[np.bool_]
) -> tuple[NDArray[np.int8], NDArray[np.float32]]:
    """Cells and heights of stairs with their gaps closed, those at their foot and head, too.

    Beside treads, floor that no image showed is a guess that they make unlikely: it is a drop.
    """
    reach = round(0.5 * TREAD_GAP_M / grid.resolution)
    stairs = np.argwhere(np.isfinite(heights))
    low, high = np.maximum(stairs.min(axis=0) - 2 * reach, 0), stairs.max(axis=0) + 2 * reach + 1
    window = (slice(low[0], high[0]), slice(low[1], high[1]))
    filled_cells, filled_heights = grid.cells.copy(), heights.copy()
    filled_cells[window], filled_heights[window] = _fill(
        grid.cells[window], heights[window], floor[window], grid.resolution
    )
    return filled_cells, filled_heights


def _fill(
    cells: NDArray[np.int8],
    heights: NDArray[np.float32],
    floor: NDArray[np.bool_],
    resolution: float,
) -> tuple[NDArray[np.int8], NDArray[np.float32]]:
    """The same in a window about the stairs."""
    seen = np.isfinite(heights)
    floor = binary_opening(floor, np.ones((2, 2)))  # a line of cells is what a seam shows
    open_cells = ~floor & (cells != OCCUPIED)
    reach = round(0.5 * TREAD_GAP_M / resolution)
    filled = _closed(seen, reach) & ~seen & open_cells
    nearest = distance_transform_edt(~seen, return_distances=False, return_indices=True)
    heights = np.where(filled, heights[tuple(nearest)], heights)
    treads = seen | filled
    weight = treads.astype(np.float64)
    total = np.maximum(convolve(weight, NEIGHBOURS), 1.0)
    for _ in range(2 * reach):  # an even slope between the treads that were seen
        mean = convolve(np.where(treads, heights, 0.0), NEIGHBOURS) / total
        heights = np.where(filled, mean, heights).astype(np.float32)
    guessed = (cells == FREE) & ~floor & (distance_transform_edt(~treads) <= reach)
    cells = np.where(guessed & ~treads, np.int8(DROP), cells)
    step = treads & (np.abs(heights) <= FLIGHT_END_M)
    steps = round(0.5 * STEP_GAP_M / resolution)
    foot = _closed(step | (floor & (cells == FREE)), steps)
    foot &= open_cells & (distance_transform_edt(~step) <= 2 * steps)
    return np.where(filled | foot, np.int8(FREE), cells), heights


def _closed(mask: NDArray[np.bool_], reach: int) -> NDArray[np.bool_]:
    """A (N_x, N_y) mask with its gaps of up to twice `reach` cells along straight lines closed."""
    padded = np.pad(mask, 2 * reach)
    diagonal = np.eye(2 * reach + 1, dtype=np.bool_)
    straight = np.zeros_like(diagonal)
    straight[reach] = True
    lines = (straight, straight.T, diagonal, diagonal[::-1])
    closed = np.any([binary_closing(padded, line) for line in lines], axis=0)
    return np.asarray(closed[2 * reach : -2 * reach, 2 * reach : -2 * reach])
