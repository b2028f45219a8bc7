"""One episode from reset to its end, by the protocol."""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from toponav.categories import canonical
from toponav.envs.simulator import HouseEnv
from toponav.errors import TopoNavError
from toponav.evaluation.funnel import ERROR, SearchTrace
from toponav.evaluation.results import EpisodeResult, score_episode
from toponav.reasoning.usage import VlmUsage
from toponav.scenes.mesh import SceneEpisode
from toponav.types import Action, Agent, Observation

FLOOR_CHANGE_M = 1.0
"""When even the nearest goal in height is this far above or below, it is on another floor."""


@dataclass(frozen=True)
class EpisodeSpec:
    """An episode of a scene; (scene, index) is its key.

    Attributes:
        scene: Name of the scene.
        index: Index among the scene's episodes.
        episode: Target and start pose.
        seed: Seeds everything random in the episode.
    """

    scene: str
    index: int
    episode: SceneEpisode
    seed: int


@dataclass(frozen=True)
class RunIdentity:
    """What all results of a run in one scene have in common.

    Attributes:
        method: Name of the agent.
        config_sha: Hash of the resolved configuration.
        scene_m2: Area on which the agent can stand, square metres.
    """

    method: str
    config_sha: str
    scene_m2: float


class StepObserver(Protocol):
    """Watches an episode step by step; it may record or draw but never steers."""

    def on_step(self, observation: Observation, action: Action) -> None:
        """Called after the agent has chosen `action` on `observation`."""
        ...


@dataclass
class Rollout:
    """What a result needs, gathered while the episode runs.

    Attributes:
        shortest_path: l, metres.
        floor_change: Whether the nearest goal lies on another floor than the start.
        path_length: p, metres.
        steps: Actions taken.
        collisions: Steps that were cut short.
        ended: "stop", "step-limit" or "error: ...".
        distance_to_goal: DTG at the end, metres.
        decisions: Decisions of the agent.
        search: Stages of the search.
        failure: Why it failed; "" on success.
        seconds: Wall-clock seconds by stage.
        vlm: What the model took.
    """

    shortest_path: float
    floor_change: bool
    path_length: float = 0.0
    steps: int = 0
    collisions: int = 0
    ended: str = ""
    distance_to_goal: float = 0.0
    decisions: int = 0
    search: SearchTrace = field(default_factory=SearchTrace)
    failure: str = ""
    seconds: dict[str, float] = field(
        default_factory=lambda: {"simulation": 0.0, "agent": 0.0, "total": 0.0}
    )
    vlm: VlmUsage = field(default_factory=VlmUsage)

    @classmethod
    def impossible(cls, reason: str) -> Rollout:
        """An episode that could not be run: a failure without a path."""
        return cls(
            math.inf, False, ended=f"error: {reason}", distance_to_goal=math.inf, failure=ERROR
        )

    @property
    def stopped(self) -> bool:
        """Whether the agent ended the episode by itself."""
        return self.ended == "stop"

    def scored(self, spec: EpisodeSpec, run: RunIdentity) -> EpisodeResult:
        """The result record."""
        score = score_episode(
            self.stopped, self.distance_to_goal, self.shortest_path, self.path_length
        )
        return EpisodeResult(
            scene=spec.scene,
            index=spec.index,
            target=canonical(spec.episode.target),
            method=run.method,
            seed=spec.seed,
            stop_called=self.stopped,
            distance_to_goal=self.distance_to_goal,
            shortest_path=self.shortest_path,
            path_length=self.path_length,
            success=score.success,
            spl=score.spl,
            soft_spl=score.soft_spl,
            steps=self.steps,
            collisions=self.collisions,
            decisions=self.decisions,
            seconds=self.seconds,
            ended=self.ended,
            floor_change=self.floor_change,
            config_sha=run.config_sha,
            scene_m2=run.scene_m2,
            failure=self.failure,
            search=self.search,
            vlm=self.vlm,
        )


def start_episode(env: HouseEnv, spec: EpisodeSpec) -> str:
    """Reset the environment to an episode; returns the canonical target.

    Raises:
        EpisodeError: The target or the start pose does not fit the scene.
    """
    target = canonical(spec.episode.target)
    start = (*spec.episode.start, spec.episode.yaw)
    env.reset(seed=spec.seed, options={"target": target, "start": start})
    return target


def roll_out(
    env: HouseEnv, agent: Agent, spec: EpisodeSpec, observers: Sequence[StepObserver] = ()
) -> Rollout:
    """Run one episode; the agent is reset here but not closed.

    An error that the agent raises on purpose ends the episode and is named in `ended`.

    Raises:
        EpisodeError: The target or the start pose does not fit the scene.
    """
    clock = time.perf_counter()
    target = start_episode(env, spec)
    heights = env.oracle.viewpoints(target)[:, 2]
    rollout = Rollout(
        shortest_path=env.oracle.distance_to_goal(),
        floor_change=bool(np.all(np.abs(heights - spec.episode.start[2]) > FLOOR_CHANGE_M)),
    )
    agent.reset(target)
    rollout.ended = _step_until_end(env, agent, rollout, observers)
    rollout.distance_to_goal = env.oracle.distance_to_goal()
    rollout.seconds["total"] = time.perf_counter() - clock
    return rollout


def _step_until_end(
    env: HouseEnv, agent: Agent, rollout: Rollout, observers: Sequence[StepObserver]
) -> str:
    """Step until stop, the step limit or an error; says which it was."""
    observation = env.observe()
    while True:
        clock = time.perf_counter()
        try:
            action = agent.act(observation)
        except TopoNavError as error:
            return f"error: {error}"
        rollout.seconds["agent"] += time.perf_counter() - clock
        for observer in observers:
            observer.on_step(observation, action)
        clock = time.perf_counter()
        before = env.position
        _, _, terminated, truncated, _ = env.step(int(action))
        rollout.steps += 1
        rollout.path_length += float(np.linalg.norm(env.position - before))
        rollout.collisions += int(env.collided)
        if terminated or truncated:
            return "stop" if terminated else "step-limit"
        observation = env.observe()
        rollout.seconds["simulation"] += time.perf_counter() - clock
