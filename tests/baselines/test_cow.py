"""CoW: nearest in a straight line, the middle of a frontier, the centre of the first box."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from searches import Blind, Log, named, search

from drawn_map import clusters_from, detections_of, drawn_map, observation_at, reach_from
from small_house import small_config
from toponav.baselines.cow import CowAgent
from toponav.types import Action

AROUND = drawn_map(
    "###########",
    "#...#..... ",
    "#...#..... ",
    "#...#..... ",
    "#...#.....#",
    "#.........#",
    "#.........#",
    "#.........#",
    "#.........#",
    "##...######",
    "  ...      ",
    enlarged=5,
)
"""The way out at the upper right is near, but behind a wall; on foot the one below is nearer."""


def agent() -> CowAgent:
    return CowAgent(Blind(), small_config().navigator, Log())


def test_it_goes_to_the_middle_of_the_frontier_that_is_nearest_in_a_straight_line() -> None:
    here = (1.75, 1.05)
    clusters, reach = clusters_from(AROUND, here), reach_from(AROUND, here)
    crow = [np.hypot(*(cluster.centroid - here)) for cluster in clusters]
    foot = [cluster.path_cost for cluster in clusters]
    assert np.argmin(crow) != np.argmin(foot)
    chosen = agent()._choose(clusters, reach, observation_at(*here), AROUND)
    target = clusters[int(np.argmin(crow))]
    away = np.linalg.norm(target.cells - target.centroid, axis=1)
    in_reach = away[target.reachable]
    assert np.linalg.norm(chosen[:2] - target.centroid) == in_reach.min()


@given(
    left=st.integers(0, 30),
    top=st.integers(0, 20),
    width=st.integers(1, 10),
    height=st.integers(1, 10),
)
def test_a_detection_counts_at_the_pixel_in_its_middle(
    left: int, top: int, width: int, height: int
) -> None:
    box = (left, top, left + width, top + height)
    kept = agent()._accepted(detections_of({"sofa": box}, [0.5]))
    assert kept.labels == ("sofa",)
    ((v, u),) = np.argwhere(kept.masks[0])
    assert abs(u - (left + (width - 1) / 2)) <= 0.5
    assert abs(v - (top + (height - 1) / 2)) <= 0.5


def test_it_spins_once_explores_and_exploits() -> None:
    log = search(named("cow"))
    assert log.actions[:12] == [Action.TURN_LEFT] * 12
    assert Action.MOVE_FORWARD in log.actions
    assert log.actions[-1] is Action.STOP
    assert log.distance_to_goal < 0.1
