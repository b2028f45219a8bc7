"""The baselines in the small house: they differ in where they explore and in nothing else."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from searches import Factory, Log, search

from small_house import small_config
from toponav.baselines.base import MappedSearch
from toponav.baselines.frontier import FrontierAgent
from toponav.baselines.random_walk import MAX_STRAIGHT_STEPS, RandomAgent
from toponav.control.locomotion import Locomotion
from toponav.envs.simulator import HouseEnv
from toponav.perception import OracleDetector
from toponav.policy.affordances import Phase
from toponav.types import Action


def frontier(env: HouseEnv, log: Log) -> MappedSearch:
    return FrontierAgent(OracleDetector(env.oracle), small_config().navigator, log)


def wanderer(seed: int) -> Factory:
    return lambda env, log: RandomAgent(
        OracleDetector(env.oracle), small_config().navigator, seed, log
    )


IN_SIGHT_OF_A_SOFA = (2.16, 4.75, 0.0, 1.05)
"""A start pose from which a sofa is well seen, but too far away to stop."""


@cache
def found_toilet() -> Log:
    return search(frontier)


def test_the_frontier_agent_turns_once_round_goes_to_the_nearest_and_stops_at_the_target() -> None:
    log = found_toilet()
    assert log.actions[:12] == [Action.TURN_LEFT] * 12
    assert log.actions[-1] is Action.STOP
    assert log.distance_to_goal < 0.1
    assert [d.index for d in log.decisions] == list(range(len(log.decisions)))
    assert log.decisions[0].phase is Phase.EXPLORATION
    assert log.decisions[-1].phase is Phase.TARGET_ACQUISITION


def test_its_first_waypoint_is_the_frontier_that_is_nearest_on_foot() -> None:
    log = found_toilet()
    first = log.decisions[0]
    locomotion = Locomotion(small_config().navigator.locomotion)
    for observation in log.observations[: first.step + 1]:
        locomotion.observe(observation)
    reach = locomotion.reach(log.observations[first.step], first.map_view.grid)
    cost = reach.at(first.map_view.frontiers[:, :2])
    assert np.isfinite(cost).sum() > 1
    np.testing.assert_array_equal(first.waypoint, first.map_view.frontiers[np.argmin(cost)])


def test_without_the_object_the_frontier_agent_runs_out_of_frontiers() -> None:
    log = search(frontier, goal="piano", max_steps=600)
    assert log.actions[-1] is Action.STOP
    assert {decision.phase for decision in log.decisions} == {Phase.EXPLORATION}


def test_the_walk_of_the_random_agent_is_its_seed() -> None:
    first, again = (search(wanderer(3), "tv_monitor", max_steps=60) for _ in range(2))
    assert first.actions == again.actions
    assert search(wanderer(4), "tv_monitor", max_steps=60).actions != first.actions


def test_the_random_agent_turns_when_it_bumps_and_never_walks_farther_than_it_may() -> None:
    log = search(wanderer(1), goal="piano", max_steps=150)
    assert not log.decisions
    straight = 0
    bumped = 0
    for observation, action in zip(log.observations, log.actions, strict=True):
        if observation.collided:
            bumped += 1
            assert action in (Action.TURN_LEFT, Action.TURN_RIGHT)
        straight = straight + 1 if action is Action.MOVE_FORWARD else 0
        assert straight <= MAX_STRAIGHT_STEPS
    assert bumped > 0
    assert {Action.TURN_LEFT, Action.TURN_RIGHT, Action.MOVE_FORWARD} == set(log.actions)


@pytest.mark.parametrize("build", [frontier, wanderer(0)])
def test_a_target_in_sight_is_walked_to_at_once_by_either(build: Factory) -> None:
    log = search(build, target="sofa", max_steps=60, start=IN_SIGHT_OF_A_SOFA)
    assert [decision.phase for decision in log.decisions] == [Phase.TARGET_ACQUISITION]
    assert log.decisions[0].step == 0
    assert log.actions[-1] is Action.STOP
    assert log.distance_to_goal < 0.1
