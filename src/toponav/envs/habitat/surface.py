"""Habitat's navmesh as a `Surface`: its PathFinder answers, in our frame."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from toponav.envs.habitat.simulator import HabitatSimulator, habitat_points
from toponav.envs.surface import Motion
from toponav.errors import EpisodeError, InputError
from toponav.geometry.conventions import WORLD_FROM_HABITAT

Array = NDArray[np.float64]

SNAP_DISTANCE_M = 0.5
"""How far a point may be from the surface to be moved onto it."""

SAME_PLACE_M = 1e-3
"""A snapped point that stays this near horizontally was on the surface."""

COLLISION_M2 = 1e-5
"""habitat-sim's own rule: a step whose squared length falls short by more than this collided."""

FLOOR_TOLERANCE_M = 0.2
"""A surface this close to a floor's height belongs to that floor."""

TRIES = 1000


class HabitatDistances:
    """Distances to the nearest of some goals, as habitat-lab measures them."""

    def __init__(self, simulator: HabitatSimulator, goals: ArrayLike) -> None:
        """Take (N, 3) goals; without one everything is infinitely far."""
        points = np.asarray(goals, dtype=np.float64).reshape(-1, 3)
        self._pathfinder = simulator.pathfinder
        self._path: Any = None
        if len(points):
            self._path = simulator.habitat.MultiGoalShortestPath()
            self._path.requested_ends = habitat_points(points)

    def at(self, point: ArrayLike) -> float:
        """Metres from a (3,) point to the nearest goal; infinite without a path."""
        if self._path is None:
            return math.inf
        self._path.requested_start = habitat_points(np.asarray(point, dtype=np.float64))
        self._pathfinder.find_path(self._path)
        return float(self._path.geodesic_distance)


class HabitatSurface:
    """The navmesh of one scene."""

    def __init__(self, simulator: HabitatSimulator, floors: tuple[float, ...]) -> None:
        """Take a simulator; `floors` are the heights at which `points_over` looks."""
        self._simulator = simulator
        self._pathfinder = simulator.pathfinder
        self._floors = floors
        areas = [self._pathfinder.island_area(k) for k in range(self._pathfinder.num_islands)]
        self._main_island = int(np.argmax(areas))

    @property
    def area(self) -> float:
        """Of the main island, m2."""
        return float(self._pathfinder.island_area(self._main_island))

    def is_navigable(self, point: ArrayLike) -> bool:
        """Whether the agent's foot can be at a (3,) point."""
        return bool(self._pathfinder.is_navigable(habitat_points(np.asarray(point, float))))

    def points_over(self, xy: Array) -> Array:
        """(M, 3) points of the main island over (N, 2) places, on each floor."""
        found = []
        for floor in self._floors:
            for x, y in xy:
                place = np.array([x, y, floor])
                snapped = self._snapped(place, self._main_island)
                if (
                    snapped is not None
                    and math.dist(snapped[:2], place[:2]) <= SAME_PLACE_M
                    and abs(snapped[2] - floor) <= FLOOR_TOLERANCE_M
                ):
                    found.append(snapped)
        return np.array(found).reshape(-1, 3)

    def snap(self, point: ArrayLike, max_distance: float = SNAP_DISTANCE_M) -> Array | None:
        """The point itself if it is navigable, else the nearest that is; None without one."""
        target = np.asarray(point, dtype=np.float64)
        if self.is_navigable(target):
            return target
        snapped = self._snapped(target)
        if snapped is None or np.linalg.norm(snapped - target) > max_distance:
            return None
        return snapped

    def move(self, position: ArrayLike, yaw: float, distance: float) -> Motion:
        """A step as habitat-sim's `move_forward` takes it, without sliding.

        Raises:
            EpisodeError: The position is not on the navmesh.
        """
        start = np.asarray(position, dtype=np.float64)
        if not self.is_navigable(start):
            raise EpisodeError(f"nobody can stand at {np.round(start, 2).tolist()}")
        ahead = start + distance * np.array([math.cos(yaw), math.sin(yaw), 0.0])
        begin, end = habitat_points(start), habitat_points(ahead)
        reached = np.array(self._pathfinder.try_step_no_sliding(begin, end), np.float32)
        wanted, walked = (float(np.sum((to - begin) ** 2)) for to in (end, reached))
        return Motion(WORLD_FROM_HABITAT.apply(reached), walked + COLLISION_M2 < wanted)

    def distance_field(self, goals: ArrayLike) -> HabitatDistances:
        """Distances to the nearest of (N, 3) goals."""
        return HabitatDistances(self._simulator, goals)

    def geodesic_distance(self, start: ArrayLike, goal: ArrayLike) -> float:
        """Length of the shortest path between two (3,) points; infinite without one."""
        return float(self._path(start, goal).geodesic_distance)

    def shortest_path(self, start: ArrayLike, goal: ArrayLike) -> Array:
        """(K, 3) corners of the shortest path between two (3,) points; empty without one."""
        points = np.array(self._path(start, goal).points, dtype=np.float64)
        return WORLD_FROM_HABITAT.apply(points.reshape(-1, 3))

    def random_point(self, rng: np.random.Generator, floor_z: float | None = None) -> Array:
        """A (3,) point of the main island, on one floor if its height is given.

        Raises:
            InputError: The main island does not reach that floor.
        """
        self._pathfinder.seed(int(rng.integers(2**31)))
        for _ in range(TRIES):
            drawn = self._pathfinder.get_random_navigable_point(island_index=self._main_island)
            point = WORLD_FROM_HABITAT.apply(np.array(drawn, dtype=np.float64))
            if floor_z is None or abs(point[2] - floor_z) <= FLOOR_TOLERANCE_M:
                return point
        raise InputError(
            f"the main island does not reach the height {floor_z} m: choose another floor"
        )

    def _snapped(self, point: Array, island: int = -1) -> Array | None:
        snapped = np.array(self._pathfinder.snap_point(habitat_points(point), island), np.float64)
        return WORLD_FROM_HABITAT.apply(snapped) if np.isfinite(snapped).all() else None

    def _path(self, start: ArrayLike, goal: ArrayLike) -> Any:
        path = self._simulator.habitat.ShortestPath()
        path.requested_start = habitat_points(np.asarray(start, float))
        path.requested_end = habitat_points(np.asarray(goal, float))
        self._pathfinder.find_path(path)
        return path
