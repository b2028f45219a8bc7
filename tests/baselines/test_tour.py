"""The tour: the first frontier of the shortest way past all of them, and when it is left."""

from __future__ import annotations

import numpy as np
from searches import Blind, Log, named, search, walked_early

from drawn_map import clusters_from, drawn_map, observation_at, reach_from
from small_house import small_config
from toponav.baselines.tour import VANISHED_M, TourAgent
from toponav.types import Action

CORRIDOR = drawn_map(
    "############",
    "#..........#",
    " .......... ",
    "#..........#",
    "##### ######",
    enlarged=5,
)
"""Ways out at the left end, at 2.75 m in the wall below, and at the right end, 5.5 m along."""


def agent() -> TourAgent:
    return TourAgent(Blind(), small_config().navigator, Log())


def test_the_near_end_comes_before_the_nearest_way_out_that_lies_on_the_way_to_the_far_end() -> (
    None
):
    here = (1.95, 1.55)
    clusters, reach = clusters_from(CORRIDOR, here), reach_from(CORRIDOR, here)
    assert len(clusters) == 3
    nearest = min(clusters, key=lambda cluster: cluster.path_cost)
    assert 2.5 < nearest.centroid[0] < 3.0
    chosen = agent()._choose(clusters, reach, observation_at(*here), CORRIDOR)
    assert chosen[0] < 1.0


def test_on_arrival_it_turns_to_what_is_left_of_the_frontier_about_it() -> None:
    search_agent = agent()
    beside_the_gap = observation_at(2.75, 1.75)
    assert search_agent._look_at_rest(beside_the_gap, CORRIDOR) is Action.TURN_RIGHT or (
        search_agent._look_at_rest(beside_the_gap, CORRIDOR) is Action.TURN_LEFT
    )
    assert search_agent._look_at_rest(observation_at(4.0, 0.8), CORRIDOR) is None
    at_the_end = observation_at(5.0, 1.25)
    assert search_agent._look_at_rest(at_the_end, CORRIDOR) is None


def test_a_frontier_is_left_early_only_when_it_has_vanished() -> None:
    early = [
        np.linalg.norm(second.map_view.frontiers[:, :2] - first.waypoint[:2], axis=1).min()
        for first, second, away in walked_early(search(named("tour"), goal="piano"))
        if away > small_config().navigator.locomotion.arrival_m
    ]
    assert early
    assert min(early) > VANISHED_M
