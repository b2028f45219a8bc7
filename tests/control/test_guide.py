"""Guided walks: greedy steps along a path that somebody else knows."""

from __future__ import annotations

import math

import numpy as np

from small_house import small_runner
from toponav.control.guide import PATIENCE, Guidable, GuidedWalk
from toponav.evaluation.oracle_guide import OracleGuide
from toponav.evaluation.rollout import start_episode
from toponav.geometry import Pose
from toponav.types import Action


def test_the_oracle_guide_leads_to_any_place_of_the_house() -> None:
    runner = small_runner()
    start_episode(runner.env, runner.episode(0))
    env = runner.env
    goal = env.surface.random_point(np.random.default_rng(3))
    walk = GuidedWalk(OracleGuide(env), math.radians(30.0))
    for _ in range(150):
        if math.dist(env.position, goal) <= 0.25:
            break
        pose = Pose.from_yaw(env.yaw, env.position)
        action = walk.next_action(pose, goal[None, :2])
        assert action is not None
        env.step(int(action))
    assert math.dist(env.position, goal) <= 0.25


class Nowhere:
    def path(self, goals: np.ndarray) -> np.ndarray:
        return np.array([[0.0, 0.0], [5.0, 0.0]])


def test_a_walk_that_leads_no_nearer_is_given_up() -> None:
    walk = GuidedWalk(Nowhere(), math.radians(30.0))
    actions = [walk.next_action(Pose.identity(), np.zeros((1, 2))) for _ in range(PATIENCE + 2)]
    assert actions[0] is Action.MOVE_FORWARD
    assert actions[-1] is None


def test_every_walking_method_takes_a_guide() -> None:
    from toponav.baselines.base import MappedSearch
    from toponav.navigator import Navigator

    assert all(hasattr(kind, "follow") for kind in (MappedSearch, Navigator))
    assert not isinstance(object(), Guidable)
