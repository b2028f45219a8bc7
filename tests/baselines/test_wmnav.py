"""WMNav: the most curious view gives the direction, a candidate in it the waypoint."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from searches import Blind, Log, named, search
from words import Words

from drawn_map import clusters_from, detections_of, drawn_map, observation_at, reach_from
from small_house import small_config
from toponav.baselines.wmnav import ANGLES_DEG, RANGES_M, View, WmNavAgent, polar_candidates
from toponav.types import Action

TURNS = [Action.TURN_LEFT] * 12
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
HERE = (3.5, 1.5)


def agent(words: dict[str, float] | None = None) -> WmNavAgent:
    made = WmNavAgent(Blind(), Words(words or {}), small_config().navigator, Log())
    made.reset("sofa")
    return made


def turn(searching: WmNavAgent, label: str | None = None) -> None:
    """See the six views of a turn at the middle of the hall; the one to the right shows a label."""
    seen = detections_of({label: (18, 13, 22, 17)} if label else {}, [1.0] if label else [])
    searching._perceive(observation_at(*HERE), seen, HALL)
    for bearing in np.radians([60.0, 120.0, 180.0, 240.0, 300.0]):
        direction = np.array([np.cos(bearing), np.sin(bearing)])
        floor = np.array(HERE) + np.outer(np.linspace(0.5, 1.2, 8), direction)
        searching._maps[HALL.floor].paint(floor, np.array(HERE), 5.0)
        searching._views.append(View(float(bearing), floor))


def choose(searching: WmNavAgent, monkeypatch: pytest.MonkeyPatch) -> np.ndarray:
    """The waypoint after a turn of six views."""
    turn_deg = searching._config.locomotion.follower.turn_deg
    monkeypatch.setattr("toponav.baselines.wmnav.VIEWS", round(360.0 / turn_deg))
    clusters, reach = clusters_from(HALL, HERE), reach_from(HALL, HERE)
    return searching._choose(clusters, reach, observation_at(*HERE), HALL)


def test_candidates_lie_in_the_views_share_of_the_circle() -> None:
    candidates = polar_candidates(np.array(HERE), np.pi / 2) - HERE
    assert candidates.shape == (len(RANGES_M) * len(ANGLES_DEG), 2)
    assert set(np.round(np.hypot(*candidates.T), 6)) == set(RANGES_M)
    bearing = np.degrees(np.arctan2(candidates[:, 1], candidates[:, 0]))
    assert bearing.min() == pytest.approx(60.0)
    assert bearing.max() == pytest.approx(120.0)


def test_the_view_that_promises_most_is_gone_to(monkeypatch: pytest.MonkeyPatch) -> None:
    searching = agent({"rug": 0.9})
    turn(searching, "rug")
    chosen = choose(searching, monkeypatch)[:2] - HERE
    assert chosen[0] > 0.0
    assert abs(np.degrees(np.arctan2(chosen[1], chosen[0]))) <= 30.1


def test_a_view_that_promises_nothing_is_left(monkeypatch: pytest.MonkeyPatch) -> None:
    searching = agent()
    turn(searching)
    chosen = choose(searching, monkeypatch)[:2] - HERE
    assert abs(np.degrees(np.arctan2(chosen[1], chosen[0]))) >= 29.9


def test_it_turns_round_before_every_walk_finds_the_target_and_stops() -> None:
    log = search(named("wmnav"), max_steps=800)
    assert log.actions[:12] == TURNS
    for first, second in pairwise(log.decisions):
        if second.phase is first.phase:
            assert log.actions[second.step - 12 : second.step] == TURNS
    assert log.actions[-1] is Action.STOP
    assert log.distance_to_goal <= 0.1
