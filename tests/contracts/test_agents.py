"""What every registered method owes the loop that drives it."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
import pytest

from small_house import small_config, small_runner
from toponav.envs.simulator import HouseEnv
from toponav.geometry import Intrinsics, Pose
from toponav.geometry.conventions import BODY_FROM_OPTICAL
from toponav.methods import AgentContext, methods
from toponav.perception import OracleDetector
from toponav.reasoning import PriorReasoner
from toponav.types import Action, Agent, Observation, SemanticFrame, SemanticSource
from true_frames import true_frame

TARGET, OTHER_TARGET = "toilet", "sofa"
every_method = pytest.mark.parametrize("name", methods.names())


@dataclass
class Tape:
    """Recorded images with their labels; a semantic source that shows the one being played."""

    observations: tuple[Observation, ...]
    labels: tuple[SemanticFrame, ...]
    now: int = 0

    def semantic_frame(self) -> SemanticFrame:
        return self.labels[self.now]


@cache
def small_env() -> HouseEnv:
    return small_runner().env


@cache
def frames() -> tuple[tuple[Observation, ...], tuple[SemanticFrame, ...]]:
    """A turn on the spot, then a walk that bumps into things; the same for every method."""
    env = small_env()
    env.reset(seed=0, options={"target": TARGET})
    observations, labels = [], []
    rng = np.random.default_rng(1)
    legs = [[Action.TURN_LEFT] * int(rng.integers(1, 5)) + [Action.MOVE_FORWARD] * 4] * 4
    for action in [Action.TURN_LEFT] * 12 + [action for leg in legs for action in leg]:
        observations.append(env.observe())
        labels.append(env.semantic_frame())
        env.step(int(action))
    return tuple(observations), tuple(labels)


def blank(depth_m: float) -> tuple[Observation, ...]:
    """An agent that stands still and sees nothing, or the same wall, thirty times."""
    intrinsics = Intrinsics.from_hfov(64, 48, 79.0)
    eye = Pose.from_yaw(0.0, (0.0, 0.0, 0.88)) @ BODY_FROM_OPTICAL
    first = Observation(
        rgb=np.zeros((48, 64, 3), np.uint8),
        depth=np.full((48, 64), depth_m, np.float32),
        world_from_camera=eye,
        world_from_base=Pose.identity(),
        intrinsics=intrinsics,
    )
    return tuple(replace(first, step=k, timestamp_s=float(k)) for k in range(30))


def unlabelled(observations: tuple[Observation, ...]) -> Tape:
    ids = np.full(observations[0].depth.shape, -1, np.int32)
    return Tape(observations, (true_frame(ids),) * len(observations))


def build(name: str, labels: SemanticSource, seed: int = 5) -> Agent:
    return methods.get(name)(
        AgentContext(OracleDetector(labels), PriorReasoner(), small_config().navigator, seed)
    )


def drive(agent: Agent, env: HouseEnv, goal: str = TARGET, steps: int = 40) -> list[Action]:
    """The agent's first actions in the house, or all of them if it stops earlier."""
    env.reset(seed=0, options={"target": TARGET})
    agent.reset(goal)
    actions: list[Action] = []
    while len(actions) < steps and Action.STOP not in actions:
        actions.append(agent.act(env.observe()))
        env.step(int(actions[-1]))
    return actions


def play(agent: Agent, tape: Tape, goal: str = TARGET) -> list[Action]:
    """The actions on the tape's images, whatever the agent would rather have seen."""
    agent.reset(goal)
    actions = []
    for k, observation in enumerate(tape.observations):
        tape.now = k
        actions.append(agent.act(observation))
    return actions


@every_method
def test_it_is_an_agent(name: str) -> None:
    assert isinstance(build(name, Tape(*frames())), Agent)


@every_method
def test_its_actions_are_those_of_the_protocol(name: str) -> None:
    env = small_env()
    actions = drive(build(name, env.oracle), env)
    assert all(type(action) is Action for action in actions)
    assert {Action.MOVE_FORWARD, Action.TURN_LEFT} <= set(actions)


@every_method
def test_it_forgets_everything_at_a_reset(name: str) -> None:
    env = small_env()
    agent = build(name, env.oracle)
    fresh = drive(agent, env)
    drive(agent, env, OTHER_TARGET)
    assert drive(agent, env) == fresh
    assert drive(build(name, env.oracle), env) == fresh


@every_method
def test_it_leaves_its_observations_alone(name: str) -> None:
    tape = Tape(*frames())
    before = [(o.rgb.copy(), o.depth.copy()) for o in tape.observations]
    play(build(name, tape), tape)
    for (rgb, depth), observation in zip(before, tape.observations, strict=True):
        np.testing.assert_array_equal(rgb, observation.rgb)
        np.testing.assert_array_equal(depth, observation.depth)


@every_method
@pytest.mark.parametrize("depth_m", [0.0, 0.6, 4.9])
def test_it_goes_on_when_there_is_nothing_to_see(name: str, depth_m: float) -> None:
    tape = unlabelled(blank(depth_m))
    assert all(type(action) is Action for action in play(build(name, tape), tape))


@every_method
def test_it_survives_a_jump_of_its_pose(name: str) -> None:
    """A robot that was carried, or whose localisation was corrected, ten metres away."""
    observations, labels = frames()
    away = Pose.from_yaw(math.pi / 3, (10.0, -4.0, 0.0))
    moved = tuple(
        o if k < 20 else replace(
            o,
            world_from_base=away @ o.world_from_base,
            world_from_camera=away @ o.world_from_camera,
        )
        for k, o in enumerate(observations)
    )  # fmt: skip
    tape = Tape(moved, labels)
    assert len(play(build(name, tape), tape)) == len(moved)


@every_method
def test_closing_is_allowed_at_any_time_and_twice(name: str) -> None:
    tape = Tape(*frames())
    agent = build(name, tape)
    agent.close()
    agent.reset(TARGET)
    agent.act(tape.observations[0])
    agent.close()
    agent.close()


@every_method
def test_any_goal_is_searched_for(name: str) -> None:
    tape = Tape(*frames())
    for goal in ("unicorn", "TV monitor", "a chair", ""):
        assert Action.STOP not in play(build(name, tape), tape, goal)[:12]
