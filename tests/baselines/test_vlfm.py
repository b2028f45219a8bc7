"""VLFM: the frontier of the highest value, and how long a choice is kept."""

from __future__ import annotations

import numpy as np
from searches import Blind, Log, named, search
from words import Words

from drawn_map import clusters_from, detections_of, drawn_map, observation_at, reach_from
from small_house import small_config
from toponav.baselines.vlfm import LOSS_ALLOWED, VlfmAgent
from toponav.types import Action

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


def agent(target: str = "sofa", words: dict[str, float] | None = None) -> VlfmAgent:
    made = VlfmAgent(Blind(), Words(words or {}), small_config().navigator, Log())
    made.reset(target)
    return made


def choose(searching: VlfmAgent, x: float) -> float:
    """x of the waypoint chosen from (x, 1.5) in the hall."""
    here = (x, 1.5)
    clusters, reach = clusters_from(HALL, here), reach_from(HALL, here)
    return float(searching._choose(clusters, reach, observation_at(*here), HALL)[0])


def look(searching: VlfmAgent, x: float, score: float) -> None:
    """See a rug, which speaks for the target with 0.8, from (x, 1.5) along x."""
    seen = detections_of({"rug": (18, 13, 22, 17)}, [score])
    searching._perceive(observation_at(x, 1.5), seen, HALL)


def test_of_equal_frontiers_the_nearest_and_of_others_the_best() -> None:
    assert choose(agent(), 2.0) < 1.0
    assert choose(agent(), 5.0) > 6.0
    searching = agent(words={"rug": 0.8})
    look(searching, 5.0, 1.0)
    assert choose(searching, 2.0) > 6.0


def test_a_choice_is_kept_while_it_loses_nothing_even_if_another_is_better_now() -> None:
    searching = agent(words={"rug": 0.8})
    look(searching, 5.0, 0.5)
    assert choose(searching, 2.0) > 6.0
    look(searching, -1.2, 1.0)
    assert choose(searching, 2.0) > 6.0
    look(searching, 5.0, 0.5 - 3 * LOSS_ALLOWED / 0.8)  # the mean of both: 0.015 less in value
    assert choose(searching, 2.0) < 1.0


def test_a_small_loss_is_allowed() -> None:
    searching = agent(words={"rug": 0.8})
    look(searching, 5.0, 0.5)
    choose(searching, 2.0)
    look(searching, -1.2, 1.0)
    look(searching, 5.0, 0.5 - LOSS_ALLOWED / 0.8)  # the mean of both: 0.005 less in value
    assert choose(searching, 2.0) > 6.0


def test_a_frontier_that_is_gone_is_not_kept() -> None:
    searching = agent(words={"rug": 0.8})
    searching._last, searching._last_value = np.array([3.0, 1.5]), 0.0
    look(searching, 5.0, 1.0)
    assert choose(searching, 2.0) > 6.0


def test_it_turns_round_first_finds_the_target_and_stops() -> None:
    log = search(named("vlfm"))
    assert log.actions[:12] == [Action.TURN_LEFT] * 12
    assert log.actions[-1] is Action.STOP
    assert log.distance_to_goal <= 0.1


def test_it_stops_once_no_frontier_is_left() -> None:
    log = search(named("vlfm"), goal="piano", max_steps=500)
    assert log.actions[-1] is Action.STOP
