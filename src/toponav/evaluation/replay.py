"""A recorded episode run again: the same steps, for those who want to see what they missed.

Episodes are deterministic, so the images and maps that a recording leaves out can be had again from
its configuration; a trajectory that comes out otherwise is an error, never shown.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from toponav.categories import canonical
from toponav.config import load_config
from toponav.errors import EpisodeError, InputError, TopoNavError
from toponav.evaluation.journal import read_results
from toponav.evaluation.model_files import CALLS, ModelFiles, episode_name
from toponav.evaluation.results import EpisodeResult, from_json
from toponav.evaluation.rollout import EpisodeSpec, StepObserver
from toponav.evaluation.run_config import RunConfig
from toponav.evaluation.run_folder import CONFIG_FILE, RUN_FILE, RunRequest
from toponav.evaluation.runner import SceneRunner
from toponav.evaluation.sources import open_source
from toponav.policy.decision import DecisionListener
from toponav.scenes.mesh import SceneEpisode
from toponav.types import Action, Observation

TRAJECTORY_FILE, RESULT_FILE = "trajectory.jsonl", "result.json"
SAME_M = 1e-3
"""How far a position may be from the recorded one."""


@dataclass(frozen=True)
class RecordedEpisode:
    """An episode that was recorded, and all that is needed to run it again.

    Attributes:
        folder: Holds its trajectory.
        run: Folder of the run that it belongs to; that of `toponav demo` is both.
        config: How it was run.
        request: On what.
        result: What came of it.
        steps: Lines of the trajectory.
    """

    folder: Path
    run: Path
    config: RunConfig
    request: RunRequest
    result: EpisodeResult
    steps: tuple[dict[str, Any], ...]

    def replay(
        self,
        observers: Sequence[StepObserver] = (),
        listeners: Sequence[DecisionListener] = (),
    ) -> EpisodeResult:
        """Run it again, watched.

        Raises:
            TopoNavError: It took another course than the recorded one.
            InputError: Its scene is no longer there, or no recorded answers of its model.
        """
        source = open_source(self.request.source, self.request.labels, self.request.data)
        outlines = [o for o in source.outlines() if o.name == self.result.scene]
        if not outlines:
            raise InputError(f"{self.request.source} holds no scene {self.result.scene!r} any more")
        runner = SceneRunner(source.load(outlines[0].spec), self.config)
        episode = self._episode(runner)
        spec = EpisodeSpec(self.result.scene, self.result.index, episode, self.result.seed)
        asked = (self.run / CALLS).is_dir()
        files = ModelFiles(replayed=self.run if asked else None)
        access = files.access(spec.scene, spec.index)
        return runner.run(spec, (_Comparison(self.steps), *observers), listeners, access)

    def _episode(self, runner: SceneRunner) -> SceneEpisode:
        """The episode with its exact start; the trajectory's, of few digits, only as a resort."""
        first, target = self.steps[0], self.result.target
        x, y, z = first["position"]
        drawn: tuple[Callable[[], SceneEpisode], ...] = (
            lambda: runner.episode(self.result.index).episode,
            lambda: runner.env.episode(target, None, self.config.seed),
        )
        for draw in drawn:
            try:
                episode = draw()
            except EpisodeError:
                continue
            here = np.allclose([*episode.start, episode.yaw], [x, y, z, first["yaw"]], atol=SAME_M)
            if here and canonical(episode.target) == target:
                return episode
        return SceneEpisode(target, (x, y, z), first["yaw"])


class _Comparison:
    """Holds every step against the recorded one."""

    def __init__(self, steps: Sequence[dict[str, Any]]) -> None:
        self._steps = steps

    def on_step(self, observation: Observation, action: Action) -> None:
        """Compare one step."""
        k = observation.step
        recorded = self._steps[k] if k < len(self._steps) else None
        position = observation.world_from_base.translation
        if (
            recorded is None
            or recorded["action"] != action.name.lower()
            or not np.allclose(recorded["position"], position, atol=SAME_M)
        ):
            raise TopoNavError(
                f"the replay leaves the recorded path at step {k}: it was recorded with another "
                "version or another scene; run the episode anew"
            )


def open_episode(folder: Path) -> RecordedEpisode:
    """A recorded episode: the folder of `toponav demo` or `run`, or RUN/episodes/NAME.

    Raises:
        InputError: There is no such episode, or it was not recorded.
    """
    trajectory = folder / TRAJECTORY_FILE
    if not trajectory.is_file():
        raise InputError(
            f"{folder} is no recorded episode: give the folder of `toponav demo` or `run`, or one "
            "of RUN/episodes" + _those_in(folder)
        )
    alone = (folder / RESULT_FILE).is_file()
    run = folder if alone else folder.resolve().parent.parent
    for name in (CONFIG_FILE, RUN_FILE):
        if not (run / name).is_file():
            raise InputError(f"{run / name} is missing, so {folder} cannot be shown again")
    return RecordedEpisode(
        folder=folder,
        run=run,
        config=load_config(RunConfig, run / CONFIG_FILE),
        request=load_config(RunRequest, run / RUN_FILE),
        result=_result_of(folder, run, alone),
        steps=_read_steps(trajectory),
    )


def _those_in(folder: Path) -> str:
    names = sorted(path.parent.name for path in folder.glob(f"episodes/*/{TRAJECTORY_FILE}"))
    return f", such as {folder / 'episodes' / names[0]}" if names else ""


def _read_steps(path: Path) -> tuple[dict[str, Any], ...]:
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
        steps = tuple(json.loads(line) for line in lines)
    except ValueError as error:
        raise InputError(f"{path} is damaged: {error}") from error
    if not steps or not all({"position", "yaw", "action"} <= step.keys() for step in steps):
        raise InputError(f"{path} holds no steps, or steps without position, yaw and action")
    return steps


def _result_of(folder: Path, run: Path, alone: bool) -> EpisodeResult:
    if alone:
        path = folder / RESULT_FILE
        return from_json(path.read_text(encoding="utf-8"), str(path))
    for result in read_results(run):
        if episode_name(result.scene, result.index) == folder.resolve().name:
            return result
    raise InputError(f"{run} has no finished episode {folder.name}")
