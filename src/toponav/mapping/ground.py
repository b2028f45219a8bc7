"""Level ground at an agent's feet, or where the flight that it walks on leads."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

LEVEL_TOLERANCE_M = 0.08
"""How far points may be above or below the foot to count as the ground that the agent stands on:
depth noise and a sill pass, the next tread of a stair (0.15 m and more) does not."""

WALL_CHECK_M = 0.5
"""A column with points up to this far above the foot is a wall or a riser, not ground."""

STEPS_UP_M = (0.1, 0.18, 0.26, 0.34, 0.42)
"""How far above the last treads of a flight the next floor may be."""

RISER_M = 0.2
"""The lowest tread is no higher over the floor that a flight leads down to."""

FLIGHT_M = 4.0
"""A flight is no longer than this, in plan."""

DEEPEST_M = 3.5
"""A floor is looked for this far below the foot of an agent on a flight: a storey."""


def level_area_m2(points: NDArray[np.float32], z: float, column_m: float) -> float:
    """Area of level ground at a height, square metres; walls do not count.

    Args:
        points: (N, 3) what a frame shows, or the map.
        z: Height, metres.
        column_m: Edge of the columns that are counted.
    """
    above = points[:, 2] - z
    columns = np.floor(points[:, :2] / column_m).astype(np.int64) @ (1 << 32, 1)
    level = columns[np.abs(above) <= LEVEL_TOLERANCE_M]
    rising = columns[(above > LEVEL_TOLERANCE_M) & (above <= WALL_CHECK_M)]
    return len(np.setdiff1d(level, rising)) * column_m**2


def points_near(points: NDArray[np.float32], foot: NDArray[np.float64]) -> NDArray[np.float32]:
    """Those of (N, 3) points that lie within reach of a flight from the (3,) foot.

    The floor at the end of a flight may have been seen from its head only: near its foot a level
    camera looks over it.
    """
    offset = points[:, :2] - foot[:2].astype(np.float32)
    near: NDArray[np.float32] = points[(np.square(offset).sum(axis=1) <= FLIGHT_M**2)]
    return near


def heights_ahead(
    foot: NDArray[np.float64], points: NDArray[np.float32], treads: NDArray[np.float32]
) -> Sequence[float]:
    """Where the next floor may be, besides at the feet: the likeliest height first.

    Down a flight it is the lowest level not above its foot, of which a tread's riser or a mask's
    edge may be a part; up a flight, a step above the last one.

    Args:
        foot: (3,) the agent's foot point.
        points: (N, 3) what is known about there.
        treads: (M, 3) the stairs that are known.
    """
    near = np.hypot(*(treads[:, :2] - foot[:2]).T) <= FLIGHT_M
    lowest = max(float(points[:, 2].min(initial=foot[2])), float(foot[2]) - DEEPEST_M)
    highest = min(treads[near, 2].min(initial=foot[2]) + RISER_M, foot[2])
    below = np.arange(lowest, highest, LEVEL_TOLERANCE_M)
    return (*below.tolist(), *(float(foot[2]) + step for step in STEPS_UP_M))


def height_of(points: NDArray[np.float32], z: float) -> float:
    """Median height of the points about z, metres; there is at least one."""
    return float(np.median(points[np.abs(points[:, 2] - z) <= LEVEL_TOLERANCE_M, 2]))
