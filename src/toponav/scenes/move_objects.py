"""The same house after somebody has moved things: for scenes that change during an episode."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from shapely.geometry import Point, Polygon

from toponav.scenes.house import House, HouseObject, Level, Opening, Room
from toponav.scenes.room_space import RoomSpace, StairsFootprint, rectangle, stairs_footprints

MOVABLE = frozenset(
    ("armchair", "bed", "box", "chair", "lamp", "plant", "sofa", "stool", "tv_stand")
)
"""Categories that stand on the floor by themselves."""

TRIES = 200
"""Places that are tried for a thing."""

ON_FLOOR_M = 0.05
"""What stands no higher than this stands on the floor."""


class Moved(NamedTuple):
    """A thing before and after."""

    before: HouseObject
    after: HouseObject


def move_objects(
    house: House,
    objects: list[HouseObject],
    rng: np.random.Generator,
    away_from: tuple[NDArray[np.float64], float],
) -> tuple[House, list[Moved]]:
    """Move things, each into a room of its level, where it blocks no way.

    Args:
        house: Where.
        objects: Which, of any level; those that find no place stay.
        rng: Draws rooms and places.
        away_from: (2 or 3,) a place, and how far from it nothing is put down, metres.

    Returns:
        The house afterwards, and what was moved in it.
    """
    moved: list[Moved] = []
    levels = []
    for number, level in enumerate(house.levels):
        things = list(level.objects)
        for thing in objects:
            if thing not in things:
                continue
            rest = [other for other in things if other is not thing]
            footprints = stairs_footprints(house.stairs, number)
            after = _placed(level, rest, thing, footprints, rng, away_from)
            if after is not None:
                things[things.index(thing)] = after
                moved.append(Moved(thing, after))
        levels.append(level.model_copy(update={"objects": things}))
    return house.model_copy(update={"levels": levels}), moved


def movable(house: House) -> list[HouseObject]:
    """Things that one can move."""
    return [
        thing
        for level in house.levels
        for thing in level.objects
        if thing.category in MOVABLE and thing.position[2] - level.floor <= ON_FLOOR_M
    ]


def _placed(
    level: Level,
    others: list[HouseObject],
    thing: HouseObject,
    stairs: list[StairsFootprint],
    rng: np.random.Generator,
    away_from: tuple[NDArray[np.float64], float],
) -> HouseObject | None:
    """The thing at another place of its level, at least its own size away; None without one."""
    width, depth, _ = thing.size
    avoided, distance = away_from
    for _ in range(TRIES):
        room = level.rooms[int(rng.integers(len(level.rooms)))]
        openings = [opening for opening in level.openings if room.id in opening.rooms]
        low, high = np.min(room.polygon, axis=0), np.max(room.polygon, axis=0)
        center = rng.uniform(low, high)
        far = np.hypot(*(center - thing.position[:2])) > math.hypot(width, depth)
        if not far or np.hypot(*(center - avoided[:2])) < distance + math.hypot(width, depth) / 2:
            continue
        yaw = float(rng.choice([0.0, 0.5, 1.0, 1.5])) * math.pi
        footprint = rectangle(center, yaw, width, depth)
        if _fits(room, openings, others, stairs, footprint, thing.size[2]):
            position = (float(center[0]), float(center[1]), thing.position[2])
            return thing.model_copy(update={"position": position, "yaw": yaw})
    return None


def _fits(
    room: Room,
    openings: list[Opening],
    others: list[HouseObject],
    stairs: list[StairsFootprint],
    footprint: Polygon,
    height: float,
) -> bool:
    polygon = Polygon(room.polygon)
    space = RoomSpace(polygon, openings, stairs)
    for other in others:
        if polygon.contains(Point(other.position[:2])):
            xy = np.array(other.position[:2])
            space.occupy(rectangle(xy, other.yaw, *other.size[:2]), other.size[2])
    if not space.fits(footprint):
        return False
    space.occupy(footprint, height)
    return space.passable()
