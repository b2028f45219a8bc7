"""Drawing episodes for a house: a target it has, and a start on free floor."""

from __future__ import annotations

import math

import numpy as np
from shapely.geometry import Point, Polygon
from shapely.ops import unary_union

from toponav.categories import HM3D_TARGETS, MP3D_TARGETS, canonical
from toponav.scenes.building.surfaces import polygons
from toponav.scenes.house import House, HouseEpisode, Level
from toponav.scenes.room_space import StairsFootprint, rectangle, stairs_footprints

START_CLEARANCE_M = 0.35
"""Starts keep this far from walls and furniture."""
LEAST_DISTANCE_M = 5.0
"""Starts are at least this far from every instance of the target, where the house allows it."""
TRIES = 200


def sample_episodes(
    house: House, rng: np.random.Generator, count: int, other_level: tuple[bool, ...] = (False,)
) -> list[HouseEpisode]:
    """Draw episodes; fewer when the house has no target, no free floor or no level without one.

    Args:
        house: A furnished house.
        rng: Draws targets and starts.
        count: How many.
        other_level: Taken in turn: whether the start is on a level without the target.
    """
    targets = _targets_by_level(house)
    names = sorted(set().union(*targets)) if targets else []
    preferred = [name for name in names if name in HM3D_TARGETS] or names
    episodes: list[HouseEpisode] = []
    order = [preferred[k] for k in rng.permutation(len(preferred))] if preferred else []
    for number in range(count if order else 0):
        apart = other_level[number % len(other_level)]
        for name in (*order[number % len(order) :], *order[: number % len(order)]):
            episode = _episode(house, targets, name, apart, rng)
            if episode is not None:
                episodes.append(episode)
                break
    return episodes


def _targets_by_level(house: House) -> list[set[str]]:
    known = {*HM3D_TARGETS, *MP3D_TARGETS}
    return [{canonical(item.category) for item in level.objects} & known for level in house.levels]


def _episode(
    house: House, targets: list[set[str]], name: str, apart: bool, rng: np.random.Generator
) -> HouseEpisode | None:
    """An episode for one target, or None when no level suits."""
    levels = [k for k, has in enumerate(targets) if (name in has) != apart]
    if not levels or (apart and len(levels) == len(house.levels)):
        return None
    index = levels[int(rng.integers(len(levels)))]
    level = house.levels[index]
    instances = [
        np.array(item.position[:2]) for item in level.objects if canonical(item.category) == name
    ]
    stairs = stairs_footprints(house.stairs, index)
    free = [
        part for room in level.rooms for part in _free_floor(Polygon(room.polygon), level, stairs)
    ]
    if not free:
        return None
    areas = np.array([part.area for part in free])
    best: tuple[float, np.ndarray] | None = None
    for _ in range(TRIES):
        part = free[int(rng.choice(len(free), p=areas / areas.sum()))]
        x0, y0, x1, y1 = part.bounds
        point = np.array([rng.uniform(x0, x1), rng.uniform(y0, y1)])
        if not part.contains(Point(point)):
            continue
        distance = min((math.dist(point, other) for other in instances), default=math.inf)
        if best is None or distance > best[0]:
            best = (distance, point)
        if distance >= LEAST_DISTANCE_M:
            best = (distance, point)
            break
    if best is None:
        return None
    x, y = (round(float(v), 3) for v in best[1])
    yaw = round(float(rng.uniform(-math.pi, math.pi)), 4)
    return HouseEpisode(target=name, start=(x, y, level.floor), yaw=yaw)


def _free_floor(room: Polygon, level: Level, stairs: list[StairsFootprint]) -> list[Polygon]:
    """Where in a room somebody can stand, with some elbow room."""
    things = [
        rectangle(np.array(item.position[:2]), item.yaw, item.size[0], item.size[1])
        for item in level.objects
        if item.position[2] < level.floor + 1.0 and item.size[2] > 0.1
    ]
    taken = unary_union([*things, *(area.flight for area in stairs)]).buffer(START_CLEARANCE_M)
    inside = room.buffer(-START_CLEARANCE_M, join_style="mitre")
    return polygons(inside.difference(taken))
