"""The worker that really runs episodes; it keeps the scene that it loaded last."""

from __future__ import annotations

from pathlib import Path

from toponav.config import config_sha
from toponav.errors import TopoNavError
from toponav.evaluation.explanation import ExplanationRecorder
from toponav.evaluation.model_files import ModelFiles
from toponav.evaluation.recorder import EpisodeRecorder, episode_folder
from toponav.evaluation.results import EpisodeResult
from toponav.evaluation.rollout import EpisodeSpec, Rollout, RunIdentity
from toponav.evaluation.run_config import RunConfig
from toponav.evaluation.runner import SceneRunner
from toponav.evaluation.sources import Source
from toponav.evaluation.tasks import Task
from toponav.policy.decision import DecisionListener
from toponav.scenes.mesh import SceneEpisode

NO_EPISODE = SceneEpisode("", (0.0, 0.0, 0.0), 0.0)
"""Stands for the episode of a scene that could not be loaded."""


class EpisodeWorker:
    """Runs the episodes of a source by one configuration."""

    def __init__(
        self,
        source: Source,
        config: RunConfig,
        record_into: Path | None = None,
        models: ModelFiles | None = None,
        explain: bool = False,
    ) -> None:
        """Load nothing yet.

        Args:
            source: Where the episodes are.
            config: How they are run.
            record_into: The run's folder, when every step and decision is to be recorded there.
            models: Where a model keeps its calls; by default nowhere.
            explain: Record also what explains the decisions.
        """
        self._source = source
        self._config = config
        self._record_into = record_into
        self._models = models or ModelFiles()
        self._explain = explain
        self._spec: str | None = None
        self._runner: SceneRunner | None = None

    def run(self, task: Task) -> EpisodeResult:
        """Run one episode; one that its scene cannot host is a failed result that says why."""
        try:
            runner = self._runner_in(task.spec)
            episode = runner.episode(task.index)
        except TopoNavError as error:
            return self.failed(task, str(error))
        try:
            access = self._models.access(task.scene, task.index)
            if self._record_into is None:
                return runner.run(episode, access=access)
            folder = episode_folder(self._record_into, task.scene, task.index)
            recorder = EpisodeRecorder(folder)
            listeners: list[DecisionListener] = [recorder]
            if self._explain:
                target = episode.episode.target
                listeners.append(ExplanationRecorder(folder, target, access.log))
            return runner.run(episode, (recorder,), listeners, access)
        except TopoNavError as error:
            return runner.scored(episode, Rollout.impossible(str(error)))

    def failed(self, task: Task, reason: str) -> EpisodeResult:
        """The result of an episode that could not be run or not be finished."""
        spec = EpisodeSpec(task.scene, task.index, NO_EPISODE, self._config.seed)
        run = RunIdentity(self._config.method, config_sha(self._config), 0.0)
        return Rollout.impossible(reason).scored(spec, run)

    def close(self) -> None:
        """Let the scene go."""
        if self._runner is not None:
            self._runner.close()
        self._runner, self._spec = None, None

    def _runner_in(self, spec: str) -> SceneRunner:
        """The runner of a scene; the last one's memory is freed before it is built."""
        if self._runner is None or self._spec != spec:
            self.close()
            self._runner = SceneRunner(self._source.load(spec), self._config)
            self._spec = spec
        return self._runner
