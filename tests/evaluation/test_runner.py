"""Running episodes: what is built, what is counted, what happens when an agent fails."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from functools import cache
from itertools import pairwise

import numpy as np
import pytest
from numpy.typing import NDArray

from small_house import small_config, small_runner, small_scene
from toponav.config import config_sha
from toponav.envs.simulator import HouseEnv, HouseEnvConfig
from toponav.envs.simulator.sensors import NoiseConfig
from toponav.errors import EpisodeError, InputError, ReasonerError
from toponav.evaluation.rollout import EpisodeSpec, Rollout, roll_out
from toponav.evaluation.runner import SceneRunner
from toponav.mapping.view import MapView
from toponav.memory.graph import TopologicalMemory
from toponav.policy.decision import Decision
from toponav.scenes.mesh import SceneEpisode
from toponav.types import Action, Observation


class Scripted:
    """An agent that plays a list of actions and then stops, or raises."""

    def __init__(self, actions: list[Action], error: Exception | None = None) -> None:
        self.actions, self.error = actions, error
        self.goal = ""

    def reset(self, goal: str) -> None:
        self.goal = goal
        self._left = list(self.actions)

    def act(self, observation: Observation) -> Action:
        if self._left:
            return self._left.pop(0)
        if self.error is not None:
            raise self.error
        return Action.STOP

    def close(self) -> None:
        """Nothing to release."""


@dataclass
class Trail:
    """A step observer that also reads the simulator, which an agent cannot."""

    env: HouseEnv
    positions: list[NDArray[np.float64]] = field(default_factory=list)
    actions: list[Action] = field(default_factory=list)
    steps: list[int] = field(default_factory=list)

    def on_step(self, observation: Observation, action: Action) -> None:
        self.positions.append(observation.world_from_base.translation)
        self.actions.append(action)
        self.steps.append(observation.step)


@cache
def small() -> SceneRunner:
    return small_runner(max_steps=40)


def spec() -> EpisodeSpec:
    return small().episode(0)


WALK = [Action.TURN_LEFT, *[Action.MOVE_FORWARD] * 20, Action.TURN_RIGHT, Action.MOVE_FORWARD]


def rolled(agent: Scripted) -> tuple[Rollout, Trail]:
    trail = Trail(small().env)
    return roll_out(small().env, agent, spec(), (trail,)), trail


def test_path_length_is_the_summed_displacement_and_collisions_are_counted() -> None:
    rollout, trail = rolled(Scripted(WALK))
    end = small().env.position
    moved = sum(np.linalg.norm(b - a) for a, b in pairwise([*trail.positions, end]))
    assert rollout.path_length == pytest.approx(moved, abs=1e-9)
    assert 0.0 < rollout.path_length < 21 * 0.25
    assert rollout.collisions > 0  # five metres straight on is more than the room has
    assert rollout.steps == len(WALK) + 1 == len(trail.actions)
    assert trail.steps == list(range(rollout.steps))
    assert trail.actions == [*WALK, Action.STOP]


def test_distances_are_those_of_the_oracle_at_the_start_and_at_the_end() -> None:
    env, episode = small().env, spec().episode
    rollout, _ = rolled(Scripted(WALK))
    goals = env.oracle.viewpoints(episode.target)
    assert rollout.distance_to_goal == env.oracle.distance_to_goal()
    assert rollout.distance_to_goal == pytest.approx(
        min(env.oracle.geodesic_distance(env.position, goal) for goal in goals[::4]), abs=0.3
    )
    env.reset(options={"target": episode.target, "start": (*episode.start, episode.yaw)})
    assert rollout.shortest_path == env.oracle.distance_to_goal()
    beeline = np.linalg.norm(goals - env.position, axis=1).min()
    assert rollout.shortest_path >= beeline - 0.1


def test_stopping_at_once_walks_nothing_and_scores_nothing() -> None:
    rollout, _ = rolled(Scripted([]))
    assert (rollout.steps, rollout.path_length, rollout.collisions) == (1, 0.0, 0)
    assert rollout.ended == "stop"
    result = small().scored(spec(), rollout)
    assert result.stop_called
    assert not result.succeeded
    assert result.spl == 0.0
    assert result.soft_spl == 0.0  # no progress was made
    assert result.distance_to_goal == result.shortest_path


def test_the_step_limit_ends_an_episode_that_does_not_stop() -> None:
    rollout, _ = rolled(Scripted([Action.TURN_LEFT] * 100))
    assert (rollout.ended, rollout.steps) == ("step-limit", 40)
    assert not small().scored(spec(), rollout).stop_called


def test_standing_at_a_goal_and_stopping_is_a_success_with_spl_one() -> None:
    env, episode = small().env, spec().episode
    x, y, z = (float(v) for v in env.oracle.viewpoints(episode.target)[0])
    here = replace(spec(), episode=SceneEpisode(episode.target, (x, y, z), 0.0))
    result = small().scored(here, roll_out(env, Scripted([]), here))
    assert result.distance_to_goal < 0.1
    assert result.succeeded
    assert result.spl == 1.0


def test_an_error_that_an_agent_raises_on_purpose_ends_its_episode_by_name() -> None:
    rollout, trail = rolled(Scripted(WALK[:3], ReasonerError("the model is away")))
    assert rollout.ended == "error: the model is away"
    assert rollout.steps == len(trail.actions) == 3
    assert math.isfinite(rollout.distance_to_goal)
    assert not small().scored(spec(), rollout).stop_called


def test_a_defect_of_an_agent_is_not_hidden() -> None:
    with pytest.raises(ZeroDivisionError):
        rolled(Scripted([], ZeroDivisionError()))


def test_the_agent_hears_the_canonical_name() -> None:
    agent = Scripted([])
    base = spec()
    named = replace(base, episode=replace(base.episode, target="Toilet"))
    roll_out(small().env, agent, named)
    assert agent.goal == "toilet"


def test_a_record_carries_the_key_the_method_and_the_configuration() -> None:
    result = small().run(spec())
    assert (result.scene, result.index, result.target) == ("generated_6", 0, "toilet")
    assert (result.method, result.seed) == ("toponav", spec().seed)
    assert result.config_sha == config_sha(small().config)
    assert result.steps == 40
    assert result.decisions >= 1
    assert result.seconds["total"] >= result.seconds["agent"] > 0.0
    assert not result.floor_change


def test_running_twice_gives_the_same_record_but_for_the_time() -> None:
    first, again = small().run(spec()), small().run(spec())
    assert replace(first, seconds={}) == replace(again, seconds={})


def test_listeners_are_closed_also_when_the_episode_cannot_start() -> None:
    class Closed:
        """Counts how often it was closed."""

        times = 0

        def on_decision(self, decision: Decision) -> None:
            raise AssertionError("nothing was decided")

        def on_close(self, map_view: MapView | None, memory: TopologicalMemory | None) -> None:
            self.times += 1

    listener, base = Closed(), spec()
    in_a_wall = replace(base, episode=replace(base.episode, start=(99.0, 99.0, 0.0)))
    with pytest.raises(EpisodeError, match="nobody can stand"):
        small().run(in_a_wall, listeners=(listener,))
    assert listener.times == 1


def test_episodes_are_the_scene_s_own_and_then_drawn_from_the_seed() -> None:
    own = small_scene().episodes
    five = [small().episode(index) for index in range(5)]
    assert tuple(s.episode for s in five[:2]) == own
    assert [s.index for s in five] == [0, 1, 2, 3, 4]
    assert len({s.seed for s in five}) == 5
    assert len({s.episode.start for s in five}) == 5
    other = SceneRunner(small_scene(), small().config.model_copy(update={"seed": 1}))
    assert all(other.episode(k).episode == five[k].episode for k in (0, 1))
    assert all(other.episode(k).episode != five[k].episode for k in (2, 3, 4))


def test_an_episode_is_the_same_whatever_was_drawn_or_run_before() -> None:
    fresh = SceneRunner(small_scene(), small().config)
    assert fresh.episode(6) == small().episode(6)
    small().run(spec())
    assert fresh.episode(3) == small().episode(3)


def test_drawn_episodes_can_be_run() -> None:
    for index in range(2, 6):
        small().check(small().episode(index))
        assert math.isfinite(small().env.oracle.distance_to_goal())


@pytest.mark.parametrize("key", ["method", "detector", "reasoner"])
def test_an_unknown_part_is_refused_before_anything_is_built(key: str) -> None:
    config = small_config().model_copy(update={key: "magic"})
    with pytest.raises(InputError, match=f"unknown {key} 'magic'; known: "):
        SceneRunner(small_scene(), config)


def test_the_length_of_a_walk_is_the_true_one_and_not_that_of_the_odometry() -> None:
    drifting = HouseEnvConfig(width=160, height=120, noise=NoiseConfig(drift_per_m=0.3))
    env = HouseEnv(small_scene(), drifting)
    exact, _ = rolled(Scripted(WALK))
    trail = Trail(env)
    rollout = roll_out(env, Scripted(WALK), spec(), (trail,))
    reported = sum(float(np.linalg.norm(b - a)) for a, b in pairwise(trail.positions))
    assert rollout.path_length == pytest.approx(exact.path_length, abs=1e-9)
    assert abs(reported - rollout.path_length) > 0.01
