"""The last metre: a reachable spot from which the target is seen, within the stop distance."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from toponav.control.planner import CostField
from toponav.mapping.sight_lines import lines_through
from toponav.mapping.view import MapView
from toponav.policy.goal import GoalTracker
from toponav.policy.sight import TargetSight

MARGIN_M = 0.2
"""A walk ends up to `LocomotionConfig.arrival_m` short of the spot; it still has to be near enough
to stop there."""

LOOK_M = (1.2, 2.4)
"""Another look is taken from between these distances, metres: nearer, the camera looks over low
things."""

WALL_COST = 6.0
"""A wall on the straight line to the target counts as so many metres of way: it may not have been
mapped well enough to hide what stands against its other side."""

WALL_TOP_M = 2.0
"""What reaches from the eye's height to somewhere below this may be a wall; a lintel is higher."""

ON_FLIGHT_M = 0.3
"""Treads this far from the floor's height are on the way to another: nothing is seen from there as
from the floor."""

MAX_TRIED = 200
"""Spots checked for sight, the best first."""


Allowed = Callable[[NDArray[np.float64]], NDArray[np.bool_]]


def everywhere(spots: NDArray[np.float64]) -> NDArray[np.bool_]:
    """(N,) true: all of (N, 2) spots may be chosen."""
    return np.ones(len(spots), dtype=np.bool_)


def vantage_point(
    target_points: NDArray[np.floating],
    goal: GoalTracker,
    view: MapView,
    reach: CostField,
    eye_height_m: float,
    allowed: Allowed = everywhere,
) -> NDArray[np.float64] | None:
    """The spot that is cheapest to reach of those at which the agent would stop.

    Args:
        target_points: (N, 3) S_sem.
        goal: Knows the stop distances and what hides the target.
        view: The map.
        reach: Cost of walking from the agent to every cell.
        eye_height_m: Height of the camera above the floor, metres.
        allowed: Tells which of (N, 2) spots may be chosen.

    Returns:
        (3,) on the floor, world frame, metres. Where nothing can be reached that is well within
        the stop distance, the spot nearest to the target; None when no spot sees it from within
        the farthest distance.
    """
    cells = _standing(view, reach)
    if not len(cells) or not len(target_points):
        return None
    spots = reach.clearance.grid.center_of(cells)
    cells, spots = cells[allowed(spots)], spots[allowed(spots)]
    if not len(cells):
        return None
    distance, nearest = cKDTree(target_points[:, :2]).query(spots)
    config = goal.config
    close = distance <= config.farthest_stop_m
    cells, spots, distance, nearest = cells[close], spots[close], distance[close], nearest[close]
    well_within = distance <= config.stop_distance_m - MARGIN_M
    wall = _walls(target_points, view, eye_height_m)
    through = lines_through(wall, spots, target_points[nearest, :2], view.grid)
    cost = reach.cost[cells[:, 0], cells[:, 1]] + WALL_COST * through
    cost = np.where(well_within, cost, np.inf)
    # The last key is the first criterion: cheapest well within, then nearest beyond.
    best_first = np.lexsort((distance, cost))
    tried = best_first[:MAX_TRIED]
    sight = TargetSight(target_points, view.scene.points, config.farthest_stop_m, config.sight)
    limit = np.where(well_within, config.stop_distance_m, config.farthest_stop_m)
    for (x, y), limit_m in zip(spots[tried], limit[tried], strict=True):
        if sight.within_reach((x, y, view.floor_z + eye_height_m), limit_m):
            return np.array([x, y, view.floor_z])
    return None


def further_look(
    goal: GoalTracker, target: str, view: MapView, reach: CostField, eye_height_m: float
) -> NDArray[np.float64] | None:
    """The spot, cheapest to reach, that shows a candidate from a side not yet looked from.

    Args:
        goal: Knows the candidate, and from where it has been looked at.
        target: What is looked for.
        view: The map.
        reach: Cost of walking from the agent to every cell.
        eye_height_m: Height of the camera above the floor, metres.

    Returns:
        (3,) on the floor, world frame, metres; None if there is none.
    """
    points = goal.points(view, target)
    cells = _standing(view, reach)
    if not len(cells) or not len(points):
        return None
    spots = reach.clearance.grid.center_of(cells)
    distance, _ = cKDTree(points[:, :2]).query(spots)
    nearest, farthest = LOOK_M
    ring = np.flatnonzero((distance >= nearest) & (distance <= farthest))
    cost = reach.cost[cells[ring, 0], cells[ring, 1]]
    sight = TargetSight(points, view.scene.points, farthest, goal.config.sight)
    tried = 0
    for spot in spots[ring[np.argsort(cost, kind="stable")]]:
        if goal.looked_from(spot):
            continue
        if sight.within_reach((*spot, view.floor_z + eye_height_m), farthest):
            return np.array([*spot, view.floor_z])
        tried += 1
        if tried == MAX_TRIED:
            return None
    return None


def _walls(
    target_points: NDArray[np.floating], view: MapView, eye_height_m: float
) -> NDArray[np.bool_]:
    """(N_x, N_y) cells with something as high as the eye in them, but not with the target."""
    height = view.scene.points[:, 2] - view.floor_z
    tall = view.scene.points[(height >= eye_height_m) & (height <= WALL_TOP_M)]
    walls = np.zeros(view.grid.cells.shape, np.bool_)
    for points, is_wall in ((tall, True), (target_points, False)):
        cells = view.grid.index_of(points)
        cells = cells[view.grid.contains(cells)]
        walls[cells[:, 0], cells[:, 1]] = is_wall
    return walls


def _standing(view: MapView, reach: CostField) -> NDArray[np.int64]:
    """(N, 2) cells on the floor that can be walked to."""
    can_stand = np.isfinite(reach.cost)
    if view.grid.stairs is not None:
        can_stand &= ~(np.abs(view.grid.stairs) > ON_FLIGHT_M)  # NaN, no stair, is not
    return np.argwhere(can_stand)
