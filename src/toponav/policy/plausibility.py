"""Whether a cloud can be a thing of a kind at all: its size, its thickness, its height.

Detectors take posters, reflections and corners of furniture for what is asked for, and do so from
every side. What has been mapped of them from nearby tells: no plant is as flat as the wall, no
sofa hangs from the ceiling, and no bed is a foot long.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

MIN_POINTS = 8
"""Of fewer points nothing can be said."""

SMALLEST_M = {
    "bed": 0.7, "sofa": 0.6, "chair": 0.35, "toilet": 0.25, "tv_monitor": 0.2, "plant": 0.12,
    "table": 0.35, "bathtub": 0.5, "wardrobe": 0.5, "fridge": 0.35,
}  # fmt: skip
"""Least extent along the longest side of what is seen of one from nearby, half hidden, metres."""

STANDING = frozenset({
    "bed", "sofa", "chair", "toilet", "table", "bathtub", "desk", "counter", "bench", "stool",
    "chest_of_drawers", "nightstand", "wardrobe", "fridge", "washing_machine", "seating",
    "coffee_table", "fireplace", "gym_equipment", "piano",
})  # fmt: skip
"""Categories that stand on the floor."""

HIGHEST_FOOT_M = 0.9
"""The lower end of a standing thing, where something hides its foot, metres above the floor."""

SOLID = STANDING - {"fireplace"} | {"plant", "cushion"}
"""Categories that are no flat thing on a wall."""

FLAT_M = 0.02
"""A cloud whose points deviate less from a plane is flat: root mean square, metres."""

STEEP = 0.5
"""A flat cloud is one on a wall where its plane's normal rises less than this: a seat or a mattress
may be all that is seen of a thing, and lies flat."""


def implausibilities(
    points: NDArray[np.float64], foot_z: float, category: str, *, all_round: bool
) -> int:
    """In how many ways (N, 3) points are unlike a thing of a category.

    Args:
        points: World frame, metres.
        foot_z: Height of the floor from which it was seen, metres.
        category: What it should be.
        all_round: Whether it was seen from more than one side: from one, the back of a chair is
            flat, too.
    """
    if len(points) < MIN_POINTS:
        return 0
    centered = points - points.mean(axis=0)
    spread, axes = np.linalg.eigh(centered.T @ centered / len(points))
    longest = float(np.ptp(centered @ axes[:, 2]))
    on_wall = spread[0] < FLAT_M**2 and abs(axes[2, 0]) < STEEP
    foot = float(np.percentile(points[:, 2], 5.0)) - foot_z
    ways = (
        longest < SMALLEST_M.get(category, 0.0),
        category in SOLID and all_round and bool(on_wall),
        category in STANDING and foot > HIGHEST_FOOT_M,
    )
    return sum(ways)
