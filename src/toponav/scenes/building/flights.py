"""Straight flights of stairs, the holes that they need in floors and ceilings, and guard rails."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from shapely import Geometry, Polygon

from toponav.scenes.furniture.primitives import Part, box
from toponav.scenes.house import Level, Stairs
from toponav.scenes.textures import paint, plaster, wood

MAX_RISER_M = 0.18
"""Of a step: comfortable for people, and below the 0.2 m that the protocol's agent climbs."""

HEADROOM_M = 2.1
"""Above the line through the steps' edges; floors and ceilings nearer than this are open."""

RAIL_HEIGHT_M = 0.9
"""Of the guard rail around a stairwell."""

RAIL_THICKNESS_M = 0.05
"""Less than half a wall, so that a rail in front of a wall vanishes in it."""

TREAD_M = 0.03
"""Thickness of the boards that people step on."""

TREAD = wood((142, 96, 58))
RISER = paint((226, 220, 208))
RAIL = plaster((232, 228, 218))

_TOLERANCE_M = 1e-6


@dataclass(frozen=True, eq=False)
class Flight:
    """A flight from its lower to its upper end, whichever way the house names them.

    Attributes:
        foot: (2,) middle of the lower end in plan.
        ahead: (2,) unit vector uphill.
        run: Length in plan, metres.
        width: Metres.
        low: z of the lower floor.
        high: z of the upper floor.
    """

    foot: NDArray[np.float64]
    ahead: NDArray[np.float64]
    run: float
    width: float
    low: float
    high: float

    @property
    def step_count(self) -> int:
        """Equal steps; the last one is flush with the upper floor."""
        return math.ceil((self.high - self.low) / MAX_RISER_M - _TOLERANCE_M)

    def rectangle(self, begin: float, end: float, margin: float = 0.0) -> Polygon:
        """The flight in plan between two distances from its foot, widened by a margin."""
        half = self.width / 2.0 + margin
        left = np.array([-self.ahead[1], self.ahead[0]])
        corners = ((begin, -half), (end, -half), (end, half), (begin, half))
        return Polygon([self.foot + s * self.ahead + t * left for s, t in corners])

    def steps(self) -> list[Part]:
        """Solid steps in the world frame; nobody walks under them."""
        count = self.step_count
        depth, rise = self.run / count, (self.high - self.low) / count
        half = self.width / 2.0
        parts = []
        for index in range(count):
            begin, end = index * depth, (index + 1) * depth
            top = (index + 1) * rise
            parts.append(box((begin, -half, 0.0), (end, half, top - TREAD_M), RISER))
            parts.append(box((begin, -half, top - TREAD_M), (end, half, top), TREAD))
        degrees = math.degrees(math.atan2(self.ahead[1], self.ahead[0]))
        base = (float(self.foot[0]), float(self.foot[1]), self.low)
        return [part.turned("z", degrees).moved(base) for part in parts]

    def hole(self, underside: float) -> Polygon | None:
        """Where a slab with that underside must be open, or None when the flight is clear of it."""
        share = (underside - HEADROOM_M - self.low) / (self.high - self.low)
        begin = self.run * min(max(share, 0.0), 1.0)
        return self.rectangle(begin, self.run) if begin < self.run else None


@dataclass(frozen=True, eq=False)
class Stairwell:
    """The hole of a flight in one slab.

    Attributes:
        flight: The flight.
        level: Index of the level whose floor it opens.
        floor: z of that floor.
        underside: z of the ceiling below.
        hole: In plan.
    """

    flight: Flight
    level: int
    floor: float
    underside: float
    hole: Polygon

    def rail(self, standing_room: Geometry) -> Geometry:
        """The guard rail in plan: around the hole, open where the flight arrives.

        Args:
            standing_room: The floor on which it may stand: that of rooms, without walls.
        """
        around = self.hole.buffer(RAIL_THICKNESS_M, join_style="mitre")
        flight = self.flight
        arrival = flight.rectangle(flight.run, flight.run + 1.0, margin=1.0)
        return around.difference(self.hole).difference(arrival).intersection(standing_room)


def find_flight(stairs: Stairs, levels: Sequence[Level]) -> Flight:
    """The flight of a house's stairs."""
    ends = [
        (levels[stairs.from_level].floor, np.array(stairs.start, dtype=np.float64)),
        (levels[stairs.to_level].floor, np.array(stairs.end, dtype=np.float64)),
    ]
    (low, foot), (high, head) = sorted(ends, key=lambda end: end[0])
    run = float(np.linalg.norm(head - foot))
    return Flight(foot, (head - foot) / run, run, stairs.width, low, high)


def find_stairwells(flight: Flight, levels: Sequence[Level]) -> list[Stairwell]:
    """The holes of a flight in the floors that it comes up to."""
    wells = []
    for index, level in enumerate(levels):
        if not flight.low < level.floor <= flight.high:
            continue
        underside = _underside(flight, level.floor, levels)
        hole = flight.hole(underside)
        if hole is not None:
            wells.append(Stairwell(flight, index, level.floor, underside, hole))
    return wells


def _underside(flight: Flight, floor: float, levels: Sequence[Level]) -> float:
    """The lowest ceiling over the flight that belongs to a floor: that of the level below it."""
    below = max(level.floor for level in levels if level.floor < floor)
    ceilings = [
        level.floor + room.height
        for level in levels
        if level.floor == below
        for room in level.rooms
        if Polygon(room.polygon).intersects(flight.rectangle(0.0, flight.run))
    ]
    return min([floor, *ceilings])
