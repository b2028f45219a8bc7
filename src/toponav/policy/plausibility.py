"""Whether a cloud can be a thing of a kind at all: its size, its thickness, its height.

Detectors take posters, reflections and corners of furniture for what is asked for, and do so from
every side. What has been mapped of them from nearby tells: no plant is as flat as the wall, no
sofa hangs from the ceiling, no bed is a foot long, and what has a back is no table.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

MIN_POINTS = 8
"""Of fewer points nothing can be said."""

SMALLEST_M = {
    "bed": 0.7, "sofa": 0.6, "chair": 0.35, "toilet": 0.25, "tv_monitor": 0.42, "plant": 0.12,
    "table": 0.35, "bathtub": 0.5, "wardrobe": 0.5, "fridge": 0.35,
}  # fmt: skip
"""Least extent along the longest side of what is seen of one from nearby, half hidden, metres."""

LARGEST_M = {"toilet": 1.2, "chair": 1.9, "sofa": 4.5, "bed": 3.6, "tv_monitor": 2.6}
"""Largest extent along the longest side, with what of its neighbours clings to it, metres."""

ENDS = (2.0, 98.0)
"""Percentiles between which an extent is measured: strays lie beyond."""

STANDING = frozenset({
    "bed", "sofa", "chair", "toilet", "table", "bathtub", "desk", "counter", "bench", "stool",
    "chest_of_drawers", "nightstand", "wardrobe", "fridge", "washing_machine", "seating",
    "coffee_table", "fireplace", "gym_equipment", "piano",
})  # fmt: skip
"""Categories that stand on the floor."""

HIGHEST_FOOT_M = 0.9
"""The lower end of a standing thing, where something hides its foot, metres above the floor."""

LEAST_TOP_M = {"tv_monitor": 0.7, "sofa": 0.5, "chair": 0.5, "toilet": 0.3}
"""The upper end, metres above the floor."""

MOST_TOP_M = {"bed": 1.8, "sofa": 1.5, "chair": 1.6, "toilet": 1.4}
"""Walls of a corridor that is taken for a bed reach higher: models of furniture end at 1.0."""

FRONTS = frozenset({"tv_monitor"})
"""Categories that look like the fronts of ovens and fireplaces."""

FRONT_FOOT_M, FRONT_TOP_M = 0.2, 0.95
"""What reaches from below the one to nothing above the other is such a front, metres above the
floor: a screen begins higher up, and with the stand that clings to it ends higher up."""

BACKED = frozenset({"chair", "sofa"})
"""Categories with a back that rises above the seat."""

UNBACKED = frozenset({"bed"})
"""Categories of which at most a headboard rises above what one lies on."""

SEAT_M = (0.2, 0.85)
"""Between these heights above the floor lies a thing's seat or top, metres."""

RISE_M = 0.15
"""What is so much higher than the seat is a back, metres."""

SEAT_BIN_M = 0.05
FOOTPRINT_M = 0.1
"""Steps of height and of a footprint, metres."""

LEAST_SEAT_M2 = 0.1
"""Of a smaller seat or top nothing is said: a chair seen from behind shows little else than its
back."""

SEAT_SHARE = 0.2
"""Where a seat is looked for, it is the lowest level with this share of the footprint: backs and
arms may cover more."""

LITTLE_RAISED, MUCH_RAISED = 0.1, 0.16
"""Shares of the footprint. Of models of furniture, at least 0.17 rises above the seats of chairs
and sofas and nothing above tables, stands and desks; above the largest level of beds 0.14, of sofas
mostly 0.27 and more."""

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
    longest = float(np.ptp(np.percentile(centered @ axes[:, 2], ENDS)))
    on_wall = spread[0] < FLAT_M**2 and abs(axes[2, 0]) < STEEP
    foot, top = (np.percentile(points[:, 2], (5.0, 95.0)) - foot_z).tolist()
    raised = None
    if category in BACKED | UNBACKED:
        raised = _raised_share(points, foot_z, from_seat=category in BACKED)
    ways = (
        longest < SMALLEST_M.get(category, 0.0),
        longest > LARGEST_M.get(category, np.inf),
        category in SOLID and all_round and bool(on_wall),
        category in STANDING and foot > HIGHEST_FOOT_M,
        top < LEAST_TOP_M.get(category, -np.inf),
        top > MOST_TOP_M.get(category, np.inf),
        category in FRONTS and foot < FRONT_FOOT_M and top < FRONT_TOP_M,
        raised is not None and category in BACKED and raised < LITTLE_RAISED,
        raised is not None and category in UNBACKED and raised > MUCH_RAISED,
    )
    return sum(ways)


def _raised_share(points: NDArray[np.float64], foot_z: float, *, from_seat: bool) -> float | None:
    """Share of the footprint of (N, 3) points above which something rises like a back.

    Args:
        points: World frame, metres.
        foot_z: Height of the floor, metres.
        from_seat: Measure from the lowest level of some size; else from the largest one.

    Returns:
        None where the level is so small that it may be anything.
    """
    cells = np.floor(points[:, :2] / FOOTPRINT_M).astype(np.int64)
    kinds, cell = np.unique(cells, axis=0, return_inverse=True)
    top = np.full(len(kinds), -np.inf)
    np.maximum.at(top, cell.ravel(), points[:, 2] - foot_z)
    bins = np.arange(SEAT_M[0], SEAT_M[1] + SEAT_BIN_M / 2.0, SEAT_BIN_M)
    count, _ = np.histogram(top, bins)
    seat = bins[count.argmax()] + SEAT_BIN_M / 2.0
    wide = np.flatnonzero(count[:-1] + count[1:] >= SEAT_SHARE * len(kinds))
    if from_seat and len(wide):
        seat = bins[wide[0] + 1]
    level = np.count_nonzero(np.abs(top - seat) < RISE_M / 2.0)
    if level * FOOTPRINT_M**2 < LEAST_SEAT_M2:
        return None
    return float(np.mean(top > seat + RISE_M))
