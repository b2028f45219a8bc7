"""Searches of a baseline in the small house, and what they left behind."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cache
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from small_house import small_config, small_runner
from toponav.baselines.base import MappedSearch
from toponav.envs.simulator import HouseEnv
from toponav.mapping.view import MapView
from toponav.memory.graph import TopologicalMemory
from toponav.methods import AgentContext, methods
from toponav.perception import OracleDetector
from toponav.policy.affordances import Phase
from toponav.policy.decision import Decision
from toponav.reasoning import PriorReasoner
from toponav.types import Action, Detections, Observation

Factory = Callable[[HouseEnv, "Log"], MappedSearch]


@dataclass
class Log:
    """What a baseline did; a decision listener."""

    actions: list[Action] = field(default_factory=list)
    observations: list[Observation] = field(default_factory=list)
    decisions: list[Decision] = field(default_factory=list)
    distance_to_goal: float = np.inf

    def on_decision(self, decision: Decision) -> None:
        self.decisions.append(decision)

    def on_close(self, map_view: MapView | None, memory: TopologicalMemory | None) -> None:
        assert memory is None


@cache
def small_env() -> HouseEnv:
    return small_runner(max_steps=10_000).env


def search(
    build: Factory,
    target: str = "toilet",
    goal: str | None = None,
    max_steps: int = 150,
    start: tuple[float, float, float, float] | None = None,
) -> Log:
    """Look for `goal`, by default the target, in the small house."""
    env, log = small_env(), Log()
    agent = build(env, log)
    env.reset(seed=0, options={"target": target, "start": start})
    agent.reset(goal or target)
    while len(log.actions) < max_steps and Action.STOP not in log.actions:
        log.observations.append(env.observe())
        log.actions.append(agent.act(env.observe()))
        env.step(int(log.actions[-1]))
    log.distance_to_goal = env.oracle.distance_to_goal()
    agent.close()
    return log


def named(method: str) -> Factory:
    """The registered method of that name, with true labels and the offline prior."""

    def build(env: HouseEnv, log: Log) -> MappedSearch:
        detector, config = OracleDetector(env.oracle), small_config().navigator
        context = AgentContext(detector, PriorReasoner(), config, seed=5, listener=log)
        agent = methods.get(method)(context)
        assert isinstance(agent, MappedSearch)
        return agent

    return build


def walked_early(log: Log) -> list[tuple[Decision, Decision, float]]:
    """Pairs of successive exploring decisions and how far the first waypoint was at the second.

    Metres in a straight line, at the step of the second decision.
    """
    pairs = []
    for first, second in pairwise(log.decisions):
        if first.phase is second.phase is Phase.EXPLORATION and first.waypoint is not None:
            here = log.observations[second.step].world_from_base.translation
            pairs.append((first, second, float(np.hypot(*(first.waypoint - here)[:2]))))
    return pairs


class Blind:
    """A detector that finds nothing."""

    def detect(self, rgb: NDArray[np.uint8], vocabulary: Sequence[str]) -> Detections:
        del vocabulary
        return Detections.empty(*rgb.shape[:2])
