"""Where an opening goes through the walls of a plan."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from shapely import Geometry, LineString, Point, Polygon, get_parts, union_all

from toponav.scenes.house import Opening
from toponav.scenes.validation import OPENING_REACH_M

WALL_THICKNESS_M = 0.12
"""Of the walls around rooms; a room's polygon runs along their middle."""

PARALLEL_COSINE = math.cos(math.radians(30.0))
"""Walls that differ less in direction than this are cut by the same opening."""

_Vector2 = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Passage:
    """An opening in plan; `along` its walls, `across` them.

    Attributes:
        opening: What the house says.
        center: (2,) metres.
        along: (2,) unit vector.
        across: (2,) unit vector, 90 degrees counter-clockwise from `along`.
        walls: Lowest and highest offset across, from the centre, of the walls of its rooms.
        reach: Lowest and highest offset across up to which it cuts any wall.
        has_walls: Whether one of its rooms is enclosed at all.
    """

    opening: Opening
    center: _Vector2
    along: _Vector2
    across: _Vector2
    walls: tuple[float, float]
    reach: tuple[float, float]
    has_walls: bool

    @property
    def is_outer(self) -> bool:
        """Whether it leads outside."""
        return len(self.opening.rooms) == 1

    def rectangle(self, width: float, span: tuple[float, float]) -> Polygon:
        """The rectangle of that width along the walls and that span across them."""
        half = width / 2.0
        corners = ((-half, span[0]), (half, span[0]), (half, span[1]), (-half, span[1]))
        return Polygon([self.center + a * self.along + b * self.across for a, b in corners])

    @property
    def threshold(self) -> Polygon:
        """The ground between the far faces of its rooms' walls."""
        return self.rectangle(self.opening.width, self.walls)

    def cut(self, side_walls: Geometry) -> Geometry:
        """What it takes out of the walls.

        It cuts all walls within reach, as the house format says, and all that lies between the
        walls of its two rooms. Of the walls that run across it, those at its sides are left.

        Args:
            side_walls: Walls that are not parallel to it (see `crossing_walls`).
        """
        low, high = min(self.walls[0], self.reach[0]), max(self.walls[1], self.reach[1])
        return self.rectangle(self.opening.width, (low, high)).difference(side_walls)

    def crossing_walls(self, edges: NDArray[np.float64]) -> Geometry:
        """Walls at the passage's sides that run across it, from (E, 2, 2) wall edges."""
        direction = edges[:, 1] - edges[:, 0]
        length = np.maximum(np.linalg.norm(direction, axis=1), 1e-12)
        parallel = np.abs(direction @ self.along) > PARALLEL_COSINE * length
        inner = self.rectangle(self.opening.width - WALL_THICKNESS_M, self.reach)
        lines = [LineString(edge) for edge in edges[~parallel]]
        return union_all(
            [
                line.buffer(WALL_THICKNESS_M / 2.0, cap_style="flat")
                for line in lines
                if not line.intersects(inner)
            ]
        )


def find_passage(
    opening: Opening, rooms: Mapping[str, Polygon], enclosed: Mapping[str, bool]
) -> Passage:
    """Where an opening lies.

    Args:
        opening: Names one or two of the rooms.
        rooms: Polygons by id.
        enclosed: Whether each room has walls.
    """
    center = np.array(opening.center, dtype=np.float64)
    served = [rooms[name] for name in opening.rooms]
    edges = [_edges(polygon) for polygon in served]
    along = _direction(center, edges)
    across = np.array([-along[1], along[0]])
    offsets = [_offset(center, along, across, room_edges) for room_edges in edges]
    half = WALL_THICKNESS_M / 2.0
    low, high = -OPENING_REACH_M, OPENING_REACH_M
    for polygon in served:
        near, far = _room_interval(center, across, polygon)
        if 0.0 < (near + far) / 2.0 < high and far < high + half:
            high = (near + far) / 2.0
        if low < (near + far) / 2.0 < 0.0 and near > low - half:
            low = (near + far) / 2.0
    return Passage(
        opening=opening,
        center=center,
        along=along,
        across=across,
        walls=(min(offsets) - half, max(offsets) + half),
        reach=(low, high),
        has_walls=any(enclosed[name] for name in opening.rooms),
    )


def _edges(polygon: Polygon) -> NDArray[np.float64]:
    """(E, 2, 2) edges of the outer ring."""
    points = np.asarray(polygon.exterior.coords)[:, :2]
    return np.stack([points[:-1], points[1:]], axis=1)


def _distances(center: _Vector2, edges: NDArray[np.float64]) -> NDArray[np.float64]:
    """(E,) distances of a point from edges."""
    a, direction = edges[:, 0], edges[:, 1] - edges[:, 0]
    share = np.einsum("ec,ec->e", center - a, direction) / np.einsum(
        "ec,ec->e", direction, direction
    )
    nearest = a + np.clip(share, 0.0, 1.0)[:, None] * direction
    distances: NDArray[np.float64] = np.linalg.norm(center - nearest, axis=1)
    return distances


def _direction(center: _Vector2, edges: list[NDArray[np.float64]]) -> _Vector2:
    """The direction of the wall: that of the edge, parallel in all rooms, nearest to the centre."""
    best, smallest = np.array([1.0, 0.0]), np.inf
    for edge, distance in zip(edges[0], _distances(center, edges[0]), strict=True):
        direction = (edge[1] - edge[0]) / np.linalg.norm(edge[1] - edge[0])
        total = float(distance)
        for others in edges[1:]:
            total += _nearest_parallel(center, direction, others)
        if total < smallest:
            best, smallest = direction, total
    return best


def _nearest_parallel(center: _Vector2, direction: _Vector2, edges: NDArray[np.float64]) -> float:
    """Distance of the nearest edge in a direction; edges in others count with a penalty."""
    vectors = edges[:, 1] - edges[:, 0]
    parallel = np.abs(vectors @ direction) > PARALLEL_COSINE * np.linalg.norm(vectors, axis=1)
    return float((_distances(center, edges) + np.where(parallel, 0.0, OPENING_REACH_M)).min())


def _offset(
    center: _Vector2, along: _Vector2, across: _Vector2, edges: NDArray[np.float64]
) -> float:
    """The offset across of the nearest edge that is parallel to the passage."""
    vectors = edges[:, 1] - edges[:, 0]
    parallel = np.abs(vectors @ along) > PARALLEL_COSINE * np.linalg.norm(vectors, axis=1)
    penalty = np.where(parallel, 0.0, OPENING_REACH_M)
    a, b = edges[int((_distances(center, edges) + penalty).argmin())]
    slope = float((b - a) @ along)
    share = float((center - a) @ along) / slope if abs(slope) > 1e-9 else 0.0
    return float((a + np.clip(share, 0.0, 1.0) * (b - a) - center) @ across)


def _room_interval(center: _Vector2, across: _Vector2, room: Polygon) -> tuple[float, float]:
    """The part of the line across the opening that is inside a room, the one nearest the centre."""
    far = 2.0 * OPENING_REACH_M
    line = LineString([center - far * across, center + far * across])
    intervals = []
    for part in get_parts(line.intersection(room)):
        if isinstance(part, Point):
            continue
        offsets = (np.asarray(part.coords)[:, :2] - center) @ across
        intervals.append((float(offsets.min()), float(offsets.max())))
    if not intervals:
        return -far, far
    return min(intervals, key=lambda span: max(span[0], -span[1], 0.0))
