"""ChallengeAgent: habitat-lab's observations become ours, and ours alone decide."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from small_house import small_config, small_runner
from toponav.envs.simulator import HouseEnv
from toponav.errors import InputError, ObservationError
from toponav.evaluation.rollout import start_episode
from toponav.habitat import ChallengeAgent
from toponav.types import Action


def lab_observations(env: HouseEnv, start: Any, goal: int, three: bool = False) -> dict[str, Any]:
    """What habitat-lab's sensors give, by their own definitions, in the episode's frame."""
    observation = env.observe()
    moved = env.position - start[0]
    yaw = start[1]
    ahead = moved[0] * math.cos(yaw) + moved[1] * math.sin(yaw)
    right = moved[0] * math.sin(yaw) - moved[1] * math.cos(yaw)
    gps = [right, moved[2], -ahead] if three else [ahead, right]
    clipped = np.clip(env.semantic_frame().depth, 0.5, 5.0)
    return {
        "rgb": observation.rgb,
        "depth": ((clipped - 0.5) / 4.5)[..., None].astype(np.float32),
        "gps": np.array(gps, np.float32),
        "compass": np.array([math.remainder(env.yaw - yaw, math.tau)], np.float32),
        "objectgoal": np.array([goal]),
        "semantic": np.maximum(env.semantic_frame().instance_ids, 0)[..., None],
    }


def begun(goal: int = 0) -> tuple[ChallengeAgent, HouseEnv, Any]:
    runner = small_runner(preset="default")
    start_episode(runner.env, runner.episode(goal))
    names = [runner.episode(k).episode.target for k in range(2)]
    agent = ChallengeAgent(
        "oracle",
        small_config(preset="default"),
        names,
        annotations=lambda: runner.scene.mesh.instances,
    )
    agent.reset()
    return agent, runner.env, (runner.env.position, runner.env.yaw)


@pytest.mark.parametrize("three", [False, True], ids=["GPS of two", "GPS of three"])
def test_poses_and_depth_are_those_of_the_simulator(three: bool) -> None:
    agent, env, start = begun()
    first = env.observe()
    track = agent._track
    for action in (None, 1, 2, 1, 5, 1, 3, 4, 1):
        if action is not None:
            env.step(action)
            track.acted(Action(action))
        seen = track.observe(lab_observations(env, start, 0, three), normalized=True)
        truth = env.observe()
        relative = first.world_from_base.inverse() @ truth.world_from_camera
        np.testing.assert_allclose(seen.world_from_camera.matrix, relative.matrix, atol=1e-5)
        assert seen.collided == truth.collided
        inner = (truth.depth > 0.501) & (truth.depth < 4.999)
        np.testing.assert_allclose(seen.depth[inner], truth.depth[inner], atol=1e-5)
        assert not seen.depth[truth.depth == 0.0].any()


def test_it_finds_the_target_in_its_own_frame() -> None:
    agent, env, start = begun()
    for _ in range(200):
        action = agent.act(lab_observations(env, start, 0))["action"]
        env.step(action)
        if action == Action.STOP:
            break
    agent.close()
    assert env.oracle.distance_to_goal() < 0.1


def test_what_the_task_does_not_give_is_named() -> None:
    agent, env, start = begun()
    complete = lab_observations(env, start, 0)
    with pytest.raises(ObservationError, match="'compass'"):
        agent.act({k: v for k, v in complete.items() if k != "compass"})
    with pytest.raises(InputError, match="objectgoal 9"):
        agent.act({**complete, "objectgoal": np.array([9])})
    with pytest.raises(ObservationError, match="semantic sensor"):
        agent.act({k: v for k, v in complete.items() if k != "semantic"})
    with pytest.raises(InputError, match="unknown detector"):
        ChallengeAgent("nothing")
