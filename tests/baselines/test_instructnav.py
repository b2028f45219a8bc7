"""InstructNav: landmarks one after the other, plans after a look round, the flag at plans only."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from searches import Blind, Log, named, search
from words import Words

from drawn_map import detections_of, drawn_map, observation_at
from small_house import small_config
from toponav.baselines.instructnav import (
    PLAN_M,
    WAYPOINT_M,
    InstructNavAgent,
    waypoints_along,
)
from toponav.baselines.seen_floor import seen_floor
from toponav.policy.affordances import Phase
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
TURNS = [Action.TURN_LEFT] * 12


def agent(words: dict[str, float] | None = None) -> InstructNavAgent:
    made = InstructNavAgent(Blind(), Words(words or {}), small_config().navigator, Log())
    made.reset("sofa")
    return made


def test_waypoints_follow_the_way_to_its_end_or_for_a_plans_length() -> None:
    path = np.column_stack([0.05 + 0.1 * np.arange(60), np.zeros(60)])
    walked = np.array(waypoints_along(path))[:, 0] - 0.05
    np.testing.assert_allclose(walked, [0.8, 1.6, 2.4, 3.0], atol=0.11)
    np.testing.assert_allclose(waypoints_along(path[:5]), path[4:5])
    np.testing.assert_allclose(waypoints_along(path[:1]), path[:1])


def test_a_landmark_is_used_up_by_a_plan_that_is_walked_to_its_end() -> None:
    searching = agent({"tv_monitor": 0.9, "rug": 0.5})
    assert searching._landmark(HALL) is None
    seen = detections_of({"rug": (2, 13, 6, 17), "tv_monitor": (34, 13, 38, 17)}, [1.0, 1.0])
    searching._perceive(observation_at(4.3, 1.5), seen, HALL)
    assert searching._landmark(HALL) == "tv_monitor"
    for x, landmark in ((1.0, "tv_monitor"), (4.5, "rug")):
        searching._plan(observation_at(x, 1.5), HALL)
        assert searching._landmark(HALL) == landmark


def first_waypoint_x(seen_at: float, label: str = "tv_monitor") -> float:
    """x of the first waypoint from the middle of the hall when something was seen 2 m beyond."""
    searching = agent({label: 0.9})
    looking = observation_at(seen_at, 1.5)
    searching._perceive(looking, detections_of({label: (18, 13, 22, 17)}, [1.0]), HALL)
    searching._frames.clear()
    for _ in range(12):
        searching._perceive(observation_at(3.5, 1.5, depth_m=0.1), detections_of({}, []), HALL)
    searching._plan(observation_at(3.5, 1.5), HALL)
    assert searching._waypoint is not None
    return float(searching._waypoint[0])


def test_a_landmark_draws_the_agent_to_its_end_of_the_hall() -> None:
    assert first_waypoint_x(-1.3) < 3.5  # at x = 0.7
    assert first_waypoint_x(4.3) > 3.5  # at x = 6.3


def test_the_best_of_six_views_shows_where_to_go() -> None:
    searching = agent({"tv_monitor": 0.9})
    far, seen = observation_at(1.0, 1.5, 3.0), detections_of({"tv_monitor": (18, 13, 22, 17)}, [1])
    for k in range(12):
        looking = far if k == 5 else observation_at(1.0, 1.5, 1.0)
        searching._perceive(looking, seen if k == 5 else detections_of({}, []), HALL)
    np.testing.assert_array_equal(searching._promising_floor(HALL), seen_floor(far, HALL))
    searching._perceive(observation_at(1.0, 1.5), detections_of({}, []), HALL)
    assert len(searching._promising_floor(HALL)) == 0  # it is now between the six


def test_every_plan_follows_a_look_round_and_is_walked_for_three_metres_at_most() -> None:
    log = search(named("instructnav"), goal="piano", max_steps=200)
    assert log.actions[:12] == TURNS
    plans = [d.step for d in log.decisions if log.actions[max(0, d.step - 12) : d.step] == TURNS]
    assert len(plans) >= 3
    for plan, following in pairwise(plans):
        where = [o.world_from_base.translation[:2] for o in log.observations[plan : following + 1]]
        assert np.hypot(*(where[-1] - where[0])) <= PLAN_M
        here = log.observations[plan].world_from_base.translation[:2]
        first = next(d.waypoint for d in log.decisions if d.step == plan)
        assert first is not None
        assert np.hypot(*(first[:2] - here)) <= WAYPOINT_M + 0.3


def test_the_target_is_gone_to_from_a_plan_and_found() -> None:
    log = search(named("instructnav"), max_steps=500)
    approach = next(d for d in log.decisions if d.phase is Phase.TARGET_ACQUISITION)
    assert log.actions[approach.step - 12 : approach.step] == TURNS
    assert log.actions[-1] is Action.STOP
    assert log.distance_to_goal <= 0.1


def test_without_frontiers_it_stops_after_one_look_round() -> None:
    room = drawn_map("####", "#..#", "#..#", "####", enlarged=5)
    searching = agent()
    for _ in range(12):
        searching._perceive(observation_at(1.0, 1.0), detections_of({}, []), room)
    assert searching._explore(observation_at(1.0, 1.0), room) is Action.TURN_LEFT
    assert searching._explore(observation_at(1.0, 1.0), room) is Action.STOP
