"""The last metre: a reachable spot from which the target is seen, within the stop distance."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from toponav.control.planner import CostField
from toponav.mapping.view import MapView
from toponav.policy.goal import GoalTracker, horizontal_distance

MAX_TRIED = 200
"""Spots checked for sight, the cheapest to reach first."""


def vantage_point(
    target_points: NDArray[np.floating],
    goal: GoalTracker,
    view: MapView,
    reach: CostField,
    eye_height_m: float,
) -> NDArray[np.float64] | None:
    """The spot that is cheapest to reach of those at which the agent would stop.

    Args:
        target_points: (N, 3) S_sem.
        goal: Knows the stop distance and what is in sight.
        view: The map.
        reach: Cost of walking from the agent to every cell.
        eye_height_m: Height of the camera above the floor.

    Returns:
        (3,) on the floor, world frame; None when no such spot is known.
    """
    cells = np.argwhere(np.isfinite(reach.cost))
    if not len(cells) or not len(target_points):
        return None
    spots = reach.clearance.grid.center_of(cells)
    near = horizontal_distance(spots, target_points) <= goal.config.stop_distance_m
    cells, spots = cells[near], spots[near]
    order = np.argsort(reach.cost[cells[:, 0], cells[:, 1]], kind="stable")[:MAX_TRIED]
    for x, y in spots[order]:
        if goal.within_reach((x, y, view.floor_z + eye_height_m), target_points, view):
            return np.array([x, y, view.floor_z])
    return None
