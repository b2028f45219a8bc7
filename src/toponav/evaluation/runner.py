"""Builds what an episode needs (environment, perception, reasoner, agent) and runs it."""

from __future__ import annotations

import zlib
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from toponav.config import config_sha
from toponav.control.guide import Guidable
from toponav.envs.backends import HABITAT, backends
from toponav.envs.habitat.simulator import import_habitat_sim
from toponav.errors import InputError
from toponav.evaluation.oracle_guide import OracleGuide
from toponav.evaluation.recollection import Recollection
from toponav.evaluation.results import EpisodeResult
from toponav.evaluation.rollout import (
    EpisodeSpec,
    Rollout,
    RunIdentity,
    StepObserver,
    roll_out,
    start_episode,
)
from toponav.evaluation.run_config import RunConfig
from toponav.evaluation.search_watch import SearchWatch
from toponav.methods import AgentContext, methods
from toponav.perception import DetectorContext, check_detector, make_detector
from toponav.perception.sightings import SightLog, WitnessedDetector
from toponav.policy.decision import DecisionListener, Listeners
from toponav.reasoning import ReasonerContext, reasoners
from toponav.reasoning.openai_compatible import NAME as OPENAI
from toponav.reasoning.openai_compatible import key_of
from toponav.reasoning.vlm.access import ModelAccess
from toponav.scenes.mesh import Scene, SceneEpisode


def check_parts(config: RunConfig, *, replayed: bool = False) -> None:
    """Make sure that a run's method, detector and reasoner exist, before anything is loaded.

    Args:
        config: Of the run.
        replayed: Whether a model's answers come from an earlier run, so that no key is needed.

    Raises:
        InputError: One does not, the message lists those that do; or a model's key is missing.
    """
    methods.get(config.method)
    check_detector(config.detector)
    reasoners.get(config.reasoner)
    backends.get(config.backend)
    if config.backend == HABITAT:
        import_habitat_sim()
    if config.reasoner == OPENAI and not replayed:
        key_of(config.reasoning.openai)


class SceneRunner:
    """Runs episodes in one scene, which is loaded once."""

    def __init__(self, scene: Scene, config: RunConfig) -> None:
        """Build the environment; the navigable surface is computed here.

        Raises:
            InputError: Unknown method, detector or reasoner.
        """
        self._method = methods.get(config.method)
        check_detector(config.detector)
        self._reasoner = reasoners.get(config.reasoner)
        self.scene = scene
        self.config = config
        self.env = backends.get(config.backend)(scene, config.env)
        self._identity = RunIdentity(config.method, config_sha(config), self.env.surface.area)

    def close(self) -> None:
        """Let the scene go."""
        self.env.close()

    def episode(self, index: int) -> EpisodeSpec:
        """Episode `index` of the scene: one that it brings or, beyond those, one that is drawn.

        What is drawn depends on the run's seed, the scene's name and the index alone.

        Raises:
            EpisodeError: The scene has no target that can be reached.
        """
        if index < len(self.scene.episodes):
            return self.spec(index, self.scene.episodes[index])
        name = zlib.crc32(self.scene.name.encode())
        rng = np.random.default_rng([self.config.seed, name, index])
        return self.spec(index, self.env.sample_episode(rng))

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
        access: ModelAccess | None = None,
        known: Recollection | None = None,
    ) -> EpisodeResult:
        """Run and score one episode.

        Args:
            spec: The episode.
            observers: Watch every step.
            listeners: Watch every decision.
            access: What a reasoner that asks a model may use; by default it keeps nothing.
            known: What the agent knows of the building, before and after.

        Raises:
            EpisodeError: The target or the start does not fit the scene.
            InputError: The agent cannot recall anything.
        """
        if self.config.revisit:
            known = self._visited(spec)
        access = access or ModelAccess()
        rollout = self._search(spec, observers, listeners, access, known)
        return self.scored(spec, rollout)

    def _visited(self, spec: EpisodeSpec) -> Recollection:
        """What searches for other objects from the same start teach."""
        known = Recollection()
        others = [name for name in self.env.oracle.categories() if name != spec.episode.target]
        turn = spec.seed % max(1, len(others))
        for target in (others[turn:] + others[:turn])[: self.config.revisit]:
            visit = replace(spec, episode=replace(spec.episode, target=target))
            self._search(visit, (), (), ModelAccess(), known)
        return known

    def _search(
        self,
        spec: EpisodeSpec,
        observers: Sequence[StepObserver],
        listeners: Sequence[DecisionListener],
        access: ModelAccess,
        known: Recollection | None,
    ) -> Rollout:
        """One episode, watched; the agent recalls what is known and adds to it."""
        oracle, config = self.env.oracle, self.config
        sights = SightLog(oracle)
        detector = make_detector(
            config.detector, DetectorContext(config.perception, oracle, spec.seed)
        )
        reasoner = self._reasoner(ReasonerContext(config.reasoning, sights, spec.seed, access))
        watch = SearchWatch(WitnessedDetector(detector, sights), oracle)
        agent = self._method(
            AgentContext(
                detector=watch,
                reasoner=reasoner,
                config=config.navigator,
                seed=spec.seed,
                listener=Listeners((watch, *listeners)),
            )
        )
        if config.follower == "oracle":
            if not isinstance(agent, Guidable):
                raise InputError(f"{config.method} plans no walks: leave --follower at map")
            agent.follow(OracleGuide(self.env))
        try:
            if known is not None:
                known.give_to(agent)
            rollout = roll_out(self.env, agent, spec, (watch, *observers))
            if known is not None:
                known.take_from(agent)
        finally:
            agent.close()
        watch.tell(rollout)
        rollout.vlm = access.log.usage()
        return rollout

    def scored(self, spec: EpisodeSpec, rollout: Rollout) -> EpisodeResult:
        """The result record of an episode of this run."""
        return rollout.scored(spec, self._identity)
