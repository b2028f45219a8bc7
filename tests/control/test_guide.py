"""Guided walks: greedy steps by what the simulator knows."""

from __future__ import annotations

import math

import numpy as np
import pytest

from small_house import small_runner
from toponav.baselines.base import MappedSearch
from toponav.control.guide import Guidable, guided_action
from toponav.evaluation.oracle_guide import OracleGuide
from toponav.evaluation.rollout import start_episode
from toponav.navigator import Navigator
from toponav.types import Action


@pytest.mark.parametrize("seed", range(4))
def test_the_oracle_guide_leads_to_any_place_of_the_house(seed: int) -> None:
    runner = small_runner()
    start_episode(runner.env, runner.episode(0))
    env, guide = runner.env, OracleGuide(runner.env)
    goal = env.surface.random_point(np.random.default_rng(seed))
    for _ in range(200):
        action = guided_action(guide, goal[None, :2])
        if action is None:
            break
        env.step(int(action))
        assert not env.collided
    assert math.dist(env.position, goal) <= 0.25


def test_nothing_leads_to_a_place_that_nobody_can_reach() -> None:
    runner = small_runner()
    start_episode(runner.env, runner.episode(0))
    assert guided_action(OracleGuide(runner.env), np.array([[500.0, 500.0]])) is None


class Turning:
    def __init__(self, turns: int | None) -> None:
        self.answer = turns

    def turns(self, goals: np.ndarray) -> int | None:
        return self.answer


@pytest.mark.parametrize(
    ("turns", "action"),
    [(0, Action.MOVE_FORWARD), (2, Action.TURN_LEFT), (-1, Action.TURN_RIGHT), (None, None)],
)
def test_turns_come_before_the_step(turns: int | None, action: Action | None) -> None:
    assert guided_action(Turning(turns), np.zeros((1, 2))) is action


def test_navigator_and_baselines_take_a_guide() -> None:
    assert all(issubclass(kind, Guidable) for kind in (MappedSearch, Navigator))
    assert not issubclass(object, Guidable)
