"""L3MVN: which frontiers are put to the model, what it answers, and when it is asked."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.special import softmax
from searches import Blind, Log, named, search, walked_early
from words import Words

from drawn_map import (
    clusters_from,
    detections_of,
    drawn_map,
    observation_at,
    reach_from,
    straight_cluster,
)
from small_house import small_config
from toponav.baselines.l3mvn import (
    CANDIDATES,
    REPLAN_STEPS,
    L3mvnAgent,
    candidates,
    goal_probability,
)
from toponav.types import Action, Detections

HALL = drawn_map(
    "##############",
    "#............#",
    "#............ ",
    " ............ ",
    "#............#",
    "##############",
    enlarged=5,
)
"""A hall of 6 m; the way out at the right end is the wider one."""
HERE = (3.6, 1.5)
NOTHING = detections_of({}, [])


def agent(words: dict[str, float] | None = None) -> L3mvnAgent:
    made = L3mvnAgent(Blind(), Words(words or {}), small_config().navigator, Log())
    made.reset("sofa")
    return made


def test_candidates_are_in_range_large_first_with_a_bonus_for_close_ones() -> None:
    clusters = [
        straight_cluster(0.0, float(k), cells) for k, cells in enumerate((3, 9, 6, 8, 2, 7))
    ]
    distance = np.array([2.0, 4.0, 2.9, 5.1, 1.0, 0.4])
    # Areas in cells of 0.05 m: 6, 18, 12, 16, 4, 14; with the bonus 14, 18, 20.
    ranked = candidates(clusters, distance, 0.1)
    assert [cluster.size for cluster in ranked] == [6, 9, 3]


def test_no_more_than_four_are_put_to_the_model_and_the_first_of_equals_first() -> None:
    clusters = [straight_cluster(0.0, float(k), 5) for k in range(6)]
    ranked = candidates(clusters, np.full(6, 4.0), 0.1)
    assert len(ranked) == CANDIDATES
    assert [cluster.cells[0, 1] for cluster in ranked] == [0.0, 1.0, 2.0, 3.0]


def test_the_goals_share_of_the_softmax() -> None:
    affinity = np.array([[0.9, 0.5], [0.1, 0.2], [0.3, 0.3]])
    expected = softmax(np.log(affinity).mean(axis=1))[0]
    assert goal_probability(affinity) == pytest.approx(expected)
    assert goal_probability(np.array([[0.0], [0.5]])) == pytest.approx(0.001 / 0.501)


def chosen(seen: Detections, words: dict[str, float] | None = None) -> float:
    """x of the waypoint after something was seen at the left end."""
    clusters, reach = clusters_from(HALL, HERE), reach_from(HALL, HERE)
    searching = agent(words)
    searching._perceive(observation_at(-0.5, 1.75), seen, HALL)  # 2 m ahead: at x = 1.5
    return float(searching._choose(clusters, reach, observation_at(*HERE), HALL)[0])


def test_without_objects_the_larger_frontier_and_with_a_trusted_one_that() -> None:
    assert chosen(NOTHING) > 6.0
    rug = detections_of({"sofa": (18, 13, 22, 17)}, [1.0])
    assert chosen(rug) < 1.0


def test_a_model_that_is_not_sure_is_not_followed() -> None:
    toilet = detections_of({"toilet": (18, 13, 22, 17)}, [1.0])
    assert chosen(toilet, {"toilet": 0.2}) > 6.0


def test_it_starts_without_a_turn_and_plans_anew_every_ten_steps() -> None:
    log = search(named("l3mvn"), goal="piano")
    assert log.actions[:12] != [Action.TURN_LEFT] * 12
    assert log.decisions[0].step == 0
    early = [
        second.step - first.step
        for first, second, away in walked_early(log)
        if away > small_config().navigator.locomotion.arrival_m
    ]
    assert early
    assert all(steps % REPLAN_STEPS == 0 for steps in early)
