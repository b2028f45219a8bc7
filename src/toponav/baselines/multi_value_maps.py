"""InstructNav's multi-sourced value maps: how much speaks for going to each navigable point."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

LEAST_VALUE, MOST_VALUE = 0.1, 1.0
"""The combined value is clipped to these."""

OBSTACLE_M = 0.25
"""Points this near to an obstacle are worth nothing, metres."""


def nearness(
    points: NDArray[np.float64], marks: NDArray[np.float64], cut_m: float
) -> NDArray[np.float64]:
    """(N,) 1 at the point nearest to a mark, falling to 0 at the farthest; 0 beyond the cut.

    Args:
        points: (N, 2) navigable points, N >= 1, metres.
        marks: (M, 2) what to be near to; without any, nothing is near.
        cut_m: Points farther than this from every mark count as far, metres.
    """
    distance = _distance(points, marks)
    return np.where(distance <= cut_m, 1.0 - _stretched(distance), 0.0)


def remoteness(points: NDArray[np.float64], marks: NDArray[np.float64]) -> NDArray[np.float64]:
    """(N,) 0 at the point nearest to a mark, rising to 1 at the farthest; 0 without marks.

    Args:
        points: (N, 2) navigable points, N >= 1, metres.
        marks: (M, 2) what to be far from.
    """
    return _stretched(_distance(points, marks))


def combined(
    maps: NDArray[np.float64], obstacle_distance_m: NDArray[np.float64]
) -> NDArray[np.float64]:
    """(N,) mean of the value maps, clipped, and 0 beside obstacles.

    Args:
        maps: (4, N) semantic, action, intuition and trajectory value of each point.
        obstacle_distance_m: (N,) distance to the nearest obstacle.
    """
    value = np.clip(maps.mean(axis=0), LEAST_VALUE, MOST_VALUE)
    return np.where(obstacle_distance_m < OBSTACLE_M, 0.0, value)


def _distance(points: NDArray[np.float64], marks: NDArray[np.float64]) -> NDArray[np.float64]:
    """(N,) distance to the nearest mark, infinite without any."""
    if not len(marks):
        return np.full(len(points), np.inf)
    return np.asarray(cKDTree(marks).query(points)[0], dtype=np.float64)


def _stretched(distance: NDArray[np.float64]) -> NDArray[np.float64]:
    """Distances stretched over [0, 1]; 0 where they are all alike."""
    low, high = distance.min(), distance.max()
    return np.zeros_like(distance) if low == high else (distance - low) / (high - low)
