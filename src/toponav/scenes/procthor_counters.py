"""Footprints of ProcTHOR assets, and the arms of its L- and C-shaped counters.

A counter is known by its bounding box alone; solid, that box would fill half a kitchen. Its arms
are laid along the sides of the box that are nearest to walls and under what lies on the counter.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

from shapely import Point, Polygon, affinity, box, unary_union

from toponav.scenes.house import Point2

COUNTER_DEPTH_M = 0.62
"""Depth of each arm."""

SMALLEST_SCALE = 0.4
"""A footprint that sticks into a wall shrinks at most so far."""

_ARMS_BY_SHAPE = {"I": 1, "L": 2, "C": 3}


@dataclass(frozen=True)
class Rectangle:
    """A footprint.

    Attributes:
        center: x, y in metres.
        sides: Extents along its own x and y, metres.
        yaw: Counter-clockwise, radians.
    """

    center: Point2
    sides: tuple[float, float]
    yaw: float

    @property
    def polygon(self) -> Polygon:
        """The rectangle in the world."""
        (x, y), (width, depth) = self.center, self.sides
        shape = box(x - width / 2.0, y - depth / 2.0, x + width / 2.0, y + depth / 2.0)
        rotated: Polygon = affinity.rotate(shape, self.yaw, origin=self.center, use_radians=True)
        return rotated

    def scaled(self, scale: float) -> Rectangle:
        """The same about the same centre, smaller or larger."""
        return Rectangle(self.center, (self.sides[0] * scale, self.sides[1] * scale), self.yaw)


def fitting_scale(footprint: Rectangle, room: Polygon) -> float:
    """The largest scale, in tenths, at which a footprint stays inside its room."""
    for tenths in range(10, round(10 * SMALLEST_SCALE), -1):
        if room.covers(footprint.scaled(tenths / 10.0).polygon):
            return tenths / 10.0
    return SMALLEST_SCALE


def counter_arms(
    shape: str, bounds: Rectangle, room: Polygon, items: Sequence[Point2]
) -> list[Rectangle]:
    """The arms of a counter, each with its back at its own +y.

    Args:
        shape: I, L or C: one, two or three arms.
        bounds: The bounding box; which of its sides is which is not certain.
        room: The room's polygon.
        items: x, y of what lies on the counter.
    """
    turned = Rectangle(bounds.center, (bounds.sides[1], bounds.sides[0]), bounds.yaw)
    candidates: list[tuple[Rectangle, ...]] = []
    for candidate in (bounds, turned):
        fitted = candidate.scaled(fitting_scale(candidate, room))
        arms = [_arm(fitted, quarter) for quarter in range(4)]
        for chosen in combinations(arms, _ARMS_BY_SHAPE.get(shape, 1)):
            if shape != "L" or not _opposite(*chosen):
                candidates.append(chosen)
    best = min(candidates, key=lambda arms: _misfit(arms, room, items))
    return list(best)


def _opposite(first: Rectangle, second: Rectangle) -> bool:
    return math.cos(first.yaw - second.yaw) < -0.5


def _misfit(arms: tuple[Rectangle, ...], room: Polygon, items: Sequence[Point2]) -> float:
    """Metres by which items lie beside the arms and arms away from or beyond walls."""
    covered = unary_union([arm.polygon for arm in arms])
    to_items = sum(covered.distance(Point(item)) for item in items)
    to_walls = sum(room.exterior.distance(_middle_of_back(arm)) for arm in arms)
    return float(to_items + to_walls + covered.difference(room).area)


def _arm(bounds: Rectangle, quarter: int) -> Rectangle:
    """The arm along one side of the box: quarter 0 is its +y side, then counter-clockwise."""
    run, reach = bounds.sides if quarter % 2 == 0 else bounds.sides[::-1]
    depth = min(COUNTER_DEPTH_M, reach)
    yaw = bounds.yaw + quarter * math.pi / 2.0
    offset = (reach - depth) / 2.0
    x, y = bounds.center
    center = (x - math.sin(yaw) * offset, y + math.cos(yaw) * offset)
    return Rectangle(center, (run, depth), yaw)


def _middle_of_back(arm: Rectangle) -> Point:
    half = arm.sides[1] / 2.0
    return Point(arm.center[0] - math.sin(arm.yaw) * half, arm.center[1] + math.cos(arm.yaw) * half)
