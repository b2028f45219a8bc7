"""Where an agent can be, how it moves, and how far things are: the simulator's navigable surface.

Built from any triangle soup; plays the part of Habitat's PathFinder. Points are (3,) foot points in
the world frame, metres, z up.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from toponav.envs.simulator.agent_body import AgentBody
from toponav.envs.simulator.geodesic import ShortestPaths, distance_at, shortest_paths
from toponav.envs.simulator.heightfield import build_heightfield
from toponav.envs.simulator.span_graph import SpanGraph, build_span_graph
from toponav.envs.simulator.walking import cell_at, walk
from toponav.envs.surface import Motion
from toponav.errors import EpisodeError, InputError, SceneError
from toponav.scenes.mesh import SceneMesh

SNAP_DISTANCE_M = 0.5
"""How far a point may be from the surface to be moved onto it."""

CONTACT_MARGIN_M = 1e-6
"""A blocked agent stops this far before the border of its cell, so that it stays inside."""

FLOOR_TOLERANCE_M = 0.2
"""A surface this close to a floor's height belongs to that floor."""

__all__ = ["AgentBody", "DistanceField", "Motion", "NavigableSurface"]

Array = NDArray[np.float64]
Place = tuple[tuple[float, float], int]
"""(x, y) in columns, and the cell there."""


class DistanceField:
    """Geodesic distances from anywhere to the nearest of some goals."""

    def __init__(self, surface: NavigableSurface, tree: ShortestPaths | None) -> None:
        """Without a tree, when there is no goal, everything is infinitely far."""
        self._surface = surface
        self._tree = tree

    def at(self, point: ArrayLike) -> float:
        """Metres from a (3,) point to the nearest goal; infinite without a path."""
        place = self._surface.locate(point)
        if place is None or self._tree is None:
            return math.inf
        at, cell = place
        return distance_at(self._surface.graph, self._tree, at, cell)[0]


class NavigableSurface:
    """All places where a body can stand in a scene, on every storey.

    The surface consists of square cells (`SpanGraph`); positions on it are continuous.
    """

    def __init__(self, graph: SpanGraph, body: AgentBody, floors: Sequence[float] = ()) -> None:
        """`floors` are the known floor heights, by which a floor is told from a roof."""
        if not len(graph.z):
            raise SceneError(
                "the scene has no floor on which the agent has room: check that z is up and that "
                "its units are metres"
            )
        self.graph = graph
        self.body = body
        self.main_island = _main_island(graph, floors)

    @classmethod
    def build(
        cls, mesh: SceneMesh, body: AgentBody | None = None, floors: Sequence[float] = ()
    ) -> NavigableSurface:
        """Find the navigable surface of a scene.

        Args:
            mesh: Any triangles, z up.
            body: Who moves.
            floors: Heights of the known floors; without any, all that is flat counts.

        Raises:
            SceneError: The scene is empty, far too large, or has no floor with room for the agent.
        """
        body = body or AgentBody()
        return cls(build_span_graph(build_heightfield(mesh, body), body), body, floors)

    @property
    def area(self) -> float:
        """Of the main island, m2."""
        cells = np.count_nonzero(self.graph.island == self.main_island)
        return float(cells) * self.graph.cell_size**2

    def island_of(self, point: ArrayLike) -> int | None:
        """The island that a (3,) point lies on; None off the surface."""
        place = self.locate(point)
        return None if place is None else int(self.graph.island[place[1]])

    def is_navigable(self, point: ArrayLike) -> bool:
        """Whether the agent's foot can be at a (3,) point, its height within a climb."""
        return self.locate(point) is not None

    def locate(self, point: ArrayLike) -> Place | None:
        """(x, y) in columns and the cell of a (3,) point; None off the surface."""
        x, y, z = (float(v) for v in np.asarray(point, dtype=np.float64))
        at = (x - self.graph.origin[0]) / self.graph.cell_size
        at_y = (y - self.graph.origin[1]) / self.graph.cell_size
        cell = int(cell_at(self.graph, at, at_y, z, self.body.max_climb))
        return None if cell < 0 else ((at, at_y), cell)

    def points_over(self, xy: NDArray[np.float64]) -> Array:
        """(M, 3) points of the main island over (N, 2) places, each on every storey it has."""
        graph = self.graph
        columns = np.floor((xy - graph.origin) / graph.cell_size).astype(np.int64)
        inside = np.all((columns >= 0) & (columns < graph.shape), axis=1)
        column = columns[inside, 0] * graph.shape[1] + columns[inside, 1]
        first, count = graph.column_start[column], np.diff(graph.column_start)[column]
        place = np.repeat(np.arange(len(column)), count)
        storey = np.arange(len(place)) - np.repeat(np.cumsum(count) - count, count)
        cell = first[place] + storey
        cell, place = (part[graph.island[cell] == self.main_island] for part in (cell, place))
        return np.column_stack([xy[inside][place], graph.z[cell]])

    def snap(self, point: ArrayLike, max_distance: float = SNAP_DISTANCE_M) -> Array | None:
        """The nearest point of the surface, (3,), within some metres; None without one."""
        target = np.asarray(point, dtype=np.float64)
        place = self.locate(target)
        if place is not None:
            return np.array([target[0], target[1], self.graph.z[place[1]]])
        centres = self._centres()
        reach = 0.5 * self.graph.cell_size - CONTACT_MARGIN_M
        closest = centres.copy()
        closest[:, :2] += np.clip(target[:2] - centres[:, :2], -reach, reach)
        distance = np.linalg.norm(closest - target, axis=1)
        nearest = int(np.argmin(distance))
        return closest[nearest] if distance[nearest] <= max_distance else None

    def move(self, position: ArrayLike, yaw: float, distance: float) -> Motion:
        """Walk straight ahead without sliding: a blocked move ends where it touches.

        Args:
            position: (3,) on the surface.
            yaw: Heading, radians.
            distance: Metres.

        Returns:
            Where the agent is then, always on the surface.

        Raises:
            EpisodeError: The position is not on the surface.
        """
        start = np.asarray(position, dtype=np.float64)
        place = self.locate(start)
        if place is None:
            raise EpisodeError(
                f"nobody can stand at {np.round(start, 2).tolist()}: snap the position to the "
                "navigable surface first"
            )
        at, cell = place
        direction = np.array([math.cos(yaw), math.sin(yaw)])
        ahead = distance / self.graph.cell_size * direction
        fraction, last, _ = walk(self.graph, cell, at, (at[0] + ahead[0], at[1] + ahead[1]))
        reached = self._settle(start[:2] + fraction * distance * direction, last)
        if fraction == 1.0 and reached is not None:
            return Motion(reached, collided=False)
        travelled = max(0.0, fraction * distance - CONTACT_MARGIN_M)
        reached = self._settle(start[:2] + travelled * direction, last)
        return Motion(start if reached is None else reached, collided=True)

    def distance_field(self, goals: ArrayLike) -> DistanceField:
        """Distances to the nearest of (N, 3) goals; goals off the surface count for nothing."""
        places = [self.locate(goal) for goal in np.asarray(goals, float).reshape(-1, 3)]
        known = [place for place in places if place is not None]
        if not known:
            return DistanceField(self, None)
        at = np.array([place[0] for place in known])
        cells = np.array([place[1] for place in known], dtype=np.int64)
        return DistanceField(self, shortest_paths(self.graph, at, cells))

    def geodesic_distance(self, start: ArrayLike, goal: ArrayLike) -> float:
        """Length of the shortest path between two (3,) points; infinite without one."""
        here, there = self.locate(start), self.locate(goal)
        if here is None or there is None:
            return math.inf
        return distance_at(self.graph, self._paths_between(here, there), *here)[0]

    def shortest_path(self, start: ArrayLike, goal: ArrayLike) -> Array:
        """(K, 3) corners of the shortest path between two (3,) points; empty without one."""
        here, there = self.locate(start), self.locate(goal)
        if here is None or there is None:
            return np.zeros((0, 3))
        tree = self._paths_between(here, there)
        distance, node = distance_at(self.graph, tree, *here)
        if not math.isfinite(distance):
            return np.zeros((0, 3))
        corners = [self._world(*here)]
        while True:
            at = (float(tree.at[node, 0]), float(tree.at[node, 1]))
            corners.append(self._world(at, int(tree.cell[node])))
            if tree.parent[node] == node:
                return np.array(corners)
            node = int(tree.parent[node])

    def random_point(self, rng: np.random.Generator, floor_z: float | None = None) -> Array:
        """A (3,) point of the main island, on one floor if its height is given.

        Raises:
            InputError: The main island does not reach that floor.
        """
        allowed = self.graph.island == self.main_island
        if floor_z is not None:
            allowed &= np.abs(self.graph.z - floor_z) <= FLOOR_TOLERANCE_M
        cells = np.flatnonzero(allowed)
        if not len(cells):
            raise InputError(
                f"the main island does not reach the height {floor_z} m: choose another floor"
            )
        cell = int(cells[rng.integers(len(cells))])
        dx, dy = rng.random(2)
        return self._world((self.graph.x[cell] + dx, self.graph.y[cell] + dy), cell)

    def _paths_between(self, here: Place, there: Place) -> ShortestPaths:
        """Shortest paths to `there`, searched no farther than `here`."""
        at, cell = there
        return shortest_paths(self.graph, np.array([at]), np.array([cell]), stop_cell=here[1])

    def _settle(self, xy: Array, near_cell: int) -> Array | None:
        """The (3,) surface point over a place in or just beside a cell, or None."""
        at = (xy - self.graph.origin) / self.graph.cell_size
        # Cells of one column are a body's height apart, so half of it tells the storeys apart.
        z, tolerance = self.graph.z[near_cell], 0.5 * self.body.height
        cell = cell_at(self.graph, at[0], at[1], z, tolerance)
        return None if cell < 0 else np.array([*xy, self.graph.z[cell]])

    def _world(self, at: tuple[float, float], cell: int) -> Array:
        """(3,) world point of (x, y) in columns in a cell."""
        xy = self.graph.origin + np.asarray(at) * self.graph.cell_size
        return np.array([*xy, self.graph.z[cell]])

    def _centres(self) -> Array:
        """(S, 3) centres of all cells."""
        columns = np.column_stack([self.graph.x, self.graph.y]) + 0.5
        xy = self.graph.origin + columns * self.graph.cell_size
        return np.column_stack([xy, self.graph.z])


def _main_island(graph: SpanGraph, floors: Sequence[float]) -> int:
    """The island with the most floor, the lower number at a tie: a flat roof is no floor."""
    counted = np.ones(len(graph.z), np.bool_)
    if len(floors):
        gap = np.abs(graph.z[:, None] - np.asarray(floors, dtype=np.float64)).min(axis=1)
        counted = gap <= FLOOR_TOLERANCE_M
    if not counted.any():
        counted[:] = True
    return int(np.argmax(np.bincount(graph.island[counted])))
