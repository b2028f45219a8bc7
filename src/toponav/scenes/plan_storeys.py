"""Which rooms share a floor: the heights of boxes gathered into storeys.

Real homes have half-levels, sunken living rooms and stairwells of two storeys. The house format has
flat storeys, one above the other: what differs by less than a storey is levelled out where it lies
side by side, and raised to a full storey where it lies one above the other.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from toponav.scenes.plan_rooms import RoomBox

STEP_M = 0.7
"""Floors nearer than this are one storey with a step in it."""

HALF_LEVEL_M = 1.7
"""Storeys nearer than this are one, if their rooms lie side by side."""

MAX_OVERLAP_SHARE = 0.3
"""Rooms lie side by side as long as they overlap in plan by no more than this share of the smaller
storey: boxes overlap a little even on one floor."""

MIN_STOREY_M = 2.4
"""From floor to floor of storeys that lie one above the other."""

REGULAR_HEIGHTS_M = (1.9, 3.2)
"""Boxes of these heights were scanned from floor to ceiling of one storey; others may be half a
room or a stairwell of two storeys, and say little about where the floor is."""


@dataclass(frozen=True)
class Storey:
    """A floor and the rooms on it.

    Attributes:
        floor: Height in metres.
        rooms: Keys in ascending order.
    """

    floor: float
    rooms: tuple[int, ...]


def find_storeys(
    boxes: Sequence[RoomBox],
    spans: Mapping[int, tuple[float, float]],
    connections: Sequence[tuple[int, int]],
) -> list[Storey]:
    """Group rooms by storey, the lowest first; floors are at least `MIN_STOREY_M` apart.

    Args:
        boxes: Footprints of the rooms.
        spans: Heights of the lower and the upper face of each room's box, metres, by key.
        connections: Pairs of rooms that connect.
    """
    storeys = _by_height(spans)
    footprints = {item.key: item for item in boxes}
    index = 0
    while index + 1 < len(storeys):
        low, high = storeys[index], storeys[index + 1]
        if _is_half_level(low, high, footprints, connections):
            larger = max(low, high, key=lambda storey: _area(storey, footprints))
            merged = Storey(larger.floor, tuple(sorted((*low.rooms, *high.rooms))))
            storeys[index : index + 2] = [merged]
        else:
            index += 1
    stacked: list[Storey] = []
    for storey in storeys:
        floor = storey.floor
        if stacked:
            floor = max(floor, round(stacked[-1].floor + MIN_STOREY_M, 3))
        stacked.append(Storey(floor, storey.rooms))
    return stacked


def _by_height(spans: Mapping[int, tuple[float, float]]) -> list[Storey]:
    """Rooms of regular height chained along their floors; others join the storey of their floor.

    Where a room has no storey at its floor, the one that it overlaps most takes it.
    """
    shortest, tallest = REGULAR_HEIGHTS_M
    regular = [key for key, (low, high) in spans.items() if shortest <= high - low <= tallest]
    groups: list[list[int]] = []
    for key in sorted(regular or spans, key=lambda key: (spans[key][0], key)):
        if groups and spans[key][0] - spans[groups[-1][-1]][0] <= STEP_M:
            groups[-1].append(key)
        else:
            groups.append([key])
    bounds = [np.median([spans[key] for key in group], axis=0) for group in groups]
    grouped = {key for group in groups for key in group}
    for key in sorted(set(spans) - grouped):
        low, high = spans[key]
        on_floor = [abs(low - bottom) <= STEP_M for bottom, _ in bounds]
        overlaps = [min(high, top) - max(low, bottom) for bottom, top in bounds]
        ranks = list(zip(on_floor, overlaps, strict=True))
        groups[ranks.index(max(ranks))].append(key)
    return [
        Storey(round(float(bottom), 3), tuple(sorted(group)))
        for (bottom, _), group in zip(bounds, groups, strict=True)
    ]


def _is_half_level(
    low: Storey,
    high: Storey,
    footprints: Mapping[int, RoomBox],
    connections: Sequence[tuple[int, int]],
) -> bool:
    connected = any(
        (a in low.rooms and b in high.rooms) or (b in low.rooms and a in high.rooms)
        for a, b in connections
    )
    if not connected or high.floor - low.floor >= HALF_LEVEL_M:
        return False
    overlap = sum(_overlap(footprints[a], footprints[b]) for a in low.rooms for b in high.rooms)
    smaller = min(_area(low, footprints), _area(high, footprints))
    return overlap <= MAX_OVERLAP_SHARE * smaller


def _area(storey: Storey, footprints: Mapping[int, RoomBox]) -> float:
    return sum(footprints[key].area for key in storey.rooms)


def _overlap(a: RoomBox, b: RoomBox) -> float:
    """Square metres that two boxes share in plan."""
    sides = np.minimum(a.high, b.high) - np.maximum(a.low, b.low)
    return float(np.prod(np.maximum(sides, 0.0)))
