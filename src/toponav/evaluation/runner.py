"""Builds what an episode needs (environment, perception, reasoner, agent) and runs it."""

from __future__ import annotations

import zlib
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from toponav.config import config_sha
from toponav.envs.simulator import HouseEnv
from toponav.evaluation.results import EpisodeResult
from toponav.evaluation.rollout import EpisodeSpec, Rollout, StepObserver, roll_out, start_episode
from toponav.evaluation.run_config import RunConfig
from toponav.mapping.view import MapView
from toponav.memory.graph import TopologicalMemory
from toponav.methods import AgentContext, methods
from toponav.perception import detectors
from toponav.policy.decision import Decision, DecisionListener, Listeners
from toponav.reasoning import reasoners
from toponav.scenes.mesh import Scene, SceneEpisode


@dataclass
class _DecisionCounter:
    """Counts an agent's decisions."""

    count: int = 0

    def on_decision(self, decision: Decision) -> None:
        del decision
        self.count += 1

    def on_close(self, map_view: MapView | None, memory: TopologicalMemory | None) -> None:
        del map_view, memory


class SceneRunner:
    """Runs episodes in one scene, which is loaded once."""

    def __init__(self, scene: Scene, config: RunConfig) -> None:
        """Build the environment; the navigable surface is computed here.

        Raises:
            InputError: Unknown method, detector or reasoner.
        """
        self._method = methods.get(config.method)
        self._detector = detectors.get(config.detector)
        self._reasoner = reasoners.get(config.reasoner)
        self.scene = scene
        self.config = config
        self._sha = config_sha(config)
        self.env = HouseEnv(scene, config.env)

    def episodes(self, count: int | None) -> list[EpisodeSpec]:
        """The scene's own episodes, the first `count`; more are drawn from the seed if it lacks.

        Raises:
            EpisodeError: The scene has no target that can be reached.
        """
        own = list(self.scene.episodes if count is None else self.scene.episodes[:count])
        wanted = max(len(own), 1) if count is None else count
        rng = np.random.default_rng([self.config.seed, zlib.crc32(self.scene.name.encode())])
        own += [self.env.sample_episode(rng) for _ in range(wanted - len(own))]
        return [self.spec(index, episode) for index, episode in enumerate(own)]

    def spec(self, index: int, episode: SceneEpisode) -> EpisodeSpec:
        """An episode of this scene; its seed derives from the run's and from its key."""
        key = f"{self.scene.name}#{index}".encode()
        return EpisodeSpec(
            scene=self.scene.name,
            index=index,
            episode=episode,
            seed=(self.config.seed * 1_000_003 + zlib.crc32(key)) % 2**31,
        )

    def check(self, spec: EpisodeSpec) -> None:
        """Make sure that the scene can host an episode, before anything is written about it.

        Raises:
            EpisodeError: The target or the start does not fit the scene.
        """
        start_episode(self.env, spec)

    def run(
        self,
        spec: EpisodeSpec,
        observers: Sequence[StepObserver] = (),
        listeners: Sequence[DecisionListener] = (),
    ) -> EpisodeResult:
        """Run and score one episode.

        Raises:
            EpisodeError: The target or the start does not fit the scene.
        """
        counter = _DecisionCounter()
        agent = self._method(
            AgentContext(
                detector=self._detector(self.env.oracle, spec.seed),
                reasoner=self._reasoner(),
                config=self.config.navigator,
                seed=spec.seed,
                listener=Listeners((counter, *listeners)),
            )
        )
        try:
            outcome = roll_out(self.env, agent, spec, observers)
        finally:
            agent.close()
        return self.scored(spec, outcome, counter.count)

    def scored(self, spec: EpisodeSpec, rollout: Rollout, decisions: int) -> EpisodeResult:
        """The result record of an episode of this run."""
        return rollout.scored(spec, self.config.method, decisions, self._sha)
