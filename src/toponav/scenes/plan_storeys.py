"""Which rooms share a floor: the heights of boxes gathered into storeys."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

STOREY_GAP_M = 0.7
"""Floors nearer than this are one storey with a step in it, which the import levels out."""

REGULAR_HEIGHTS_M = (1.9, 3.2)
"""Boxes of these heights were scanned from floor to ceiling of one storey; others may be half a
room or a stairwell of two storeys, and say little about where the floor is."""


@dataclass(frozen=True)
class Storey:
    """A floor and the rooms on it.

    Attributes:
        floor: z, metres.
        rooms: Keys in ascending order.
    """

    floor: float
    rooms: tuple[int, ...]


def find_storeys(spans: Mapping[int, tuple[float, float]]) -> list[Storey]:
    """Group rooms by storey, the lowest first.

    Rooms of regular height are chained along their floors; each other room joins the storey that
    it overlaps most, of equals the lower.

    Args:
        spans: z of the lower and the upper face of each room's box, metres, by key.
    """
    shortest, tallest = REGULAR_HEIGHTS_M
    regular = [key for key, (low, high) in spans.items() if shortest <= high - low <= tallest]
    groups: list[list[int]] = []
    for key in sorted(regular or spans, key=lambda key: (spans[key][0], key)):
        if groups and spans[key][0] - spans[groups[-1][-1]][0] <= STOREY_GAP_M:
            groups[-1].append(key)
        else:
            groups.append([key])
    bounds = [np.median([spans[key] for key in group], axis=0) for group in groups]
    grouped = {key for group in groups for key in group}
    for key in sorted(set(spans) - grouped):
        low, high = spans[key]
        overlaps = [min(high, top) - max(low, bottom) for bottom, top in bounds]
        groups[int(np.argmax(overlaps))].append(key)
    return [
        Storey(round(float(bottom), 3), tuple(sorted(group)))
        for (bottom, _), group in zip(bounds, groups, strict=True)
    ]
