"""The plan over frontiers: unseen floor, telling objects, the reasoner's place, stairs last."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from drawn_map import clusters_from, drawn_map, reach_from
from toponav.control.looks import Looks
from toponav.control.planner import Planner, PlannerConfig
from toponav.control.search_plan import (
    Belief,
    SearchPlanConfig,
    frontier_towards,
    is_on_stairs,
    landing,
    off_this_floor,
    ranked_frontiers,
)
from toponav.geometry import Pose
from toponav.mapping.view import MapView, PointCloud
from toponav.policy.glimpses import Glimpse

HALL = drawn_map(
    "##############",
    "#............#",
    " ............ ",
    " ............ ",
    "#............#",
    "##############",
    enlarged=5,
)
"""A hall of 6 m with a way out at either end."""
NOTHING = Belief({}, np.zeros((0, 2)))


def chosen_x(view: MapView, x: float, belief: Belief = NOTHING, beyond: float = 0.5) -> float:
    """Where the first frontier is; stairs promise `beyond`."""
    here = (x, 1.5)
    reach, clusters = reach_from(view, here), clusters_from(view, here)
    planner, config = Planner(PlannerConfig()), SearchPlanConfig()
    on_stairs = [is_on_stairs(cluster, view) for cluster in clusters]
    frontiers = [c for c, stairs in zip(clusters, on_stairs, strict=True) if not stairs]
    stairs = [c for c, stairs in zip(clusters, on_stairs, strict=True) if stairs]
    places = (frontiers, [off_this_floor(c, beyond, "", on_stairs=True) for c in stairs])
    first = ranked_frontiers(places, belief, view, reach, planner, config)[0]
    return float(first.waypoint[0])


def with_object(category: str, x: float) -> MapView:
    points = np.array([[x, 1.5, 0.4]] * 5, np.float32)
    cloud = PointCloud(points, np.zeros((5, 3), np.uint8), np.ones(5, np.int32))
    return replace(HALL, objects={category: cloud})


def test_of_like_frontiers_the_nearer_is_first() -> None:
    assert chosen_x(HALL, 2.0) < 1.0
    assert chosen_x(HALL, 5.0) > 6.0


def test_an_object_that_speaks_for_the_target_draws_to_its_end() -> None:
    assert chosen_x(with_object("bed", 6.4), 3.0, Belief({"bed": 0.9}, NOTHING.guided)) > 6.0
    assert chosen_x(with_object("bed", 6.4), 3.0, Belief({"bed": 0.0}, NOTHING.guided)) < 1.0


def test_the_place_that_the_reasoner_names_counts_more() -> None:
    right = HALL.frontiers[HALL.frontiers[:, 0] > 6.0][:, :2]
    assert chosen_x(HALL, 3.4) < 1.0
    assert chosen_x(HALL, 3.4, Belief({}, right)) > 6.0


def test_what_was_looked_at_from_nearby_and_stayed_promises_less() -> None:
    looks = Looks()
    looks.add(Pose.from_yaw(math.pi, (1.0, 1.5, 0.0)))
    assert chosen_x(HALL, 2.6) < 1.0
    assert chosen_x(HALL, 2.6, replace(NOTHING, looks=looks)) > 6.0


def with_stairs(below_x: float) -> MapView:
    """The hall with treads that rise to the left, from some x on."""
    heights = np.full(HALL.grid.cells.shape, np.nan, np.float32)
    count = int(below_x / HALL.grid.resolution)
    heights[:count] = 0.18 + 0.06 * np.arange(count)[::-1, None]
    return replace(HALL, grid=replace(HALL.grid, stairs=heights))


def test_stairs_wait_for_what_is_near_on_this_floor_but_not_for_ever() -> None:
    assert chosen_x(HALL, 2.0) < 1.0
    assert chosen_x(with_stairs(0.8), 2.0) > 6.0
    assert chosen_x(with_stairs(0.8), 2.0, beyond=50.0) < 1.0


def test_a_glimpse_of_the_target_outweighs_the_way() -> None:
    glimpse = Glimpse(np.array([9.0, 1.5]), 0.0, score=0.5)
    assert chosen_x(HALL, 1.5, Belief({}, NOTHING.guided, (glimpse,))) > 6.0


def test_from_a_flight_the_landing_is_the_nearest_place_off_it() -> None:
    view = with_stairs(3.0)
    spot = landing(view, reach_from(view, (2.9, 1.5)))
    assert spot is not None
    assert 3.0 <= spot[0] < 3.6


def test_a_target_beyond_is_approached_by_the_frontier_beside_it() -> None:
    clusters = clusters_from(HALL, (3.0, 1.5))
    assert frontier_towards(clusters, np.array([[9.0, 1.5, 0.5]]))[0] > 6.0
    assert frontier_towards(clusters, np.array([[-1.0, 1.5, 0.5]]))[0] < 1.0
