"""The free space of one room while it is being furnished."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from shapely.geometry import LineString, Point, Polygon
from shapely.geometry.base import BaseGeometry
from shapely.geometry.polygon import orient
from shapely.ops import unary_union

from toponav.scenes.building.surfaces import polygons
from toponav.scenes.house import Opening, Stairs

WALL_GAP_M = 0.08
"""Half a wall and a finger's breadth: how far furniture stays from the room's outline."""
PASSAGE_RADIUS_M = 0.27
"""Half the width of passages that stay open: the agent's 0.18 m and a margin for steering."""
DOOR_DEPTH_M = 0.95
"""Floor that stays free in front of an opening."""
DOOR_MARGIN_M = 0.12
"""Floor that stays free on each side of an opening."""
NEAR_M = 0.3
"""How near free floor must come to the middle of what lies before an opening or a flight."""
REACH_M = 0.55
"""How near a passage must come to a thing that may be searched for."""
STAIRS_LANDING_M = 1.0
"""Floor that stays free at either end of a flight."""
STAIRS_SIDE_M = 0.1
"""Floor that stays free on either side of a flight, for its railing."""
MAX_DOOR_DISTANCE_M = 0.8
"""An opening this far from a room's outline is not one of this room's."""


@dataclass(frozen=True)
class WallSlot:
    """A stretch of wall.

    Attributes:
        start: (x, y) of its left end, seen from the room with the wall ahead of one's back.
        along: Unit vector along the wall.
        inward: Unit normal into the room.
        length: Metres.
    """

    start: NDArray[np.float64]
    along: NDArray[np.float64]
    inward: NDArray[np.float64]
    length: float

    @property
    def yaw(self) -> float:
        """Yaw of a thing with its back (local +y) to this wall."""
        return math.atan2(float(self.inward[0]), -float(self.inward[1]))


class RoomSpace:
    """Knows what stands where, and whether everything can still be reached."""

    def __init__(
        self,
        polygon: Polygon,
        openings: Sequence[Opening],
        stairs: Sequence[StairsFootprint] = (),
    ) -> None:
        """Start with an empty room; stairs need not touch it."""
        self.polygon = orient(polygon)
        self.inner = self.polygon.buffer(-WALL_GAP_M, join_style="mitre")
        zones = [self._door_zone(opening) for opening in openings]
        self.doors = unary_union([zone for zone in zones if zone is not None])
        flights = [area.flight for area in stairs]
        landings = [area.landing for area in stairs]
        self.clear = unary_union([self.doors, *flights, *landings])
        self._flights = unary_union(flights)
        self.entrances = [zone.centroid for zone in zones if zone is not None]
        self._landings = [area for area in landings if self.polygon.contains(area.centroid)]
        self.footprints: list[tuple[Polygon, float]] = []

    def walls(self) -> list[WallSlot]:
        """The room's walls, in order."""
        ring = np.asarray(self.polygon.exterior.coords)
        slots = []
        for a, b in pairwise(ring):
            length = math.dist(a, b)
            if length > 0.05:
                along = (b - a) / length
                slots.append(WallSlot(a, along, np.array([-along[1], along[0]]), length))
        return slots

    def fits(
        self, footprint: Polygon, in_front: Polygon | None = None, tucked: float = 0.0
    ) -> bool:
        """Whether a thing fits here without standing in or in front of another or of a door.

        Args:
            footprint: Where it would stand.
            in_front: Floor before it that must be empty too.
            tucked: Share of it that may be under another thing.
        """
        if not self.inner.buffer(0.01).contains(footprint) or footprint.intersects(self.clear):
            return False
        needed = footprint if in_front is None else footprint.union(in_front)
        limit = tucked * footprint.area
        return all(needed.intersection(other).area <= limit for other, _ in self.footprints)

    def occupy(self, footprint: Polygon, top_m: float) -> None:
        """Stand a thing on the floor."""
        self.footprints.append((footprint, top_m))

    def vacate(self, count: int) -> None:
        """Take the last `count` things away again."""
        if count:
            del self.footprints[-count:]

    def free(self) -> BaseGeometry:
        """Where the agent's centre can be."""
        things = unary_union([self._flights, *(footprint for footprint, _ in self.footprints)])
        walkable = self.polygon.buffer(-PASSAGE_RADIUS_M, join_style="mitre")
        return walkable.difference(things.buffer(PASSAGE_RADIUS_M - 0.02))

    def passable(self) -> bool:
        """Whether all entrances, all landings and all things are still joined by free floor."""
        main = self._main_part(self.free())
        if main.is_empty:
            return not self.footprints
        return (
            all(main.distance(entrance) < NEAR_M for entrance in self.entrances)
            and all(main.distance(thing) < REACH_M for thing, _ in self.footprints)
            and all(main.distance(landing.centroid) < NEAR_M for landing in self._landings)
        )

    def _main_part(self, free: BaseGeometry) -> Polygon:
        """The part of free floor at the first entrance, or else the largest; maybe empty."""
        parts = polygons(free)
        if not self.entrances:
            return max(parts, key=lambda part: part.area, default=Polygon())
        return min(parts, key=lambda part: part.distance(self.entrances[0]), default=Polygon())

    def _door_zone(self, opening: Opening) -> Polygon | None:
        """The floor inside this room that an opening needs."""
        center = Point(opening.center)
        nearest = min(self.walls(), key=lambda wall: _segment(wall).distance(center))
        if _segment(nearest).distance(center) > MAX_DOOR_DISTANCE_M:
            return None
        half = opening.width / 2 + DOOR_MARGIN_M
        base = nearest.start + nearest.along * float(
            (np.asarray(opening.center) - nearest.start) @ nearest.along
        )
        depth = min(DOOR_DEPTH_M, 0.9 * math.sqrt(self.polygon.area))
        corners = [
            base + s * half * nearest.along + t * nearest.inward
            for s, t in ((-1, -0.05), (1, -0.05), (1, depth), (-1, depth))
        ]
        return Polygon(corners)


def _segment(wall: WallSlot) -> LineString:
    return LineString([wall.start, wall.start + wall.length * wall.along])


def rectangle(
    center: NDArray[np.float64], yaw: float, width: float, depth: float, grow: float = 0.0
) -> Polygon:
    """The footprint of a thing of some width (local x) and depth (local y)."""
    along = np.array([math.cos(yaw), math.sin(yaw)]) * (width / 2 + grow)
    across = np.array([-math.sin(yaw), math.cos(yaw)]) * (depth / 2 + grow)
    return Polygon(
        [center - along - across, center + along - across, center + along + across,
         center - along + across]
    )  # fmt: skip


@dataclass(frozen=True)
class StairsFootprint:
    """What a flight takes up on one of its two levels.

    Attributes:
        flight: The steps below, the railed well above: nobody walks across it.
        landing: Floor that stays free where it is left.
    """

    flight: Polygon
    landing: Polygon


def stairs_footprints(stairs: Sequence[Stairs], level: int) -> list[StairsFootprint]:
    """The flights that touch a level."""
    footprints = []
    for flight in stairs:
        near, far = np.array(flight.start), np.array(flight.end)
        if level == flight.to_level:
            near, far = far, near
        elif level != flight.from_level:
            continue
        outer = near + (near - far) / np.linalg.norm(near - far) * STAIRS_LANDING_M
        half = flight.width / 2.0 + STAIRS_SIDE_M
        footprints.append(
            StairsFootprint(
                flight=LineString([near, far]).buffer(half, cap_style="flat"),
                landing=LineString([outer, near]).buffer(half, cap_style="flat"),
            )
        )
    return footprints
