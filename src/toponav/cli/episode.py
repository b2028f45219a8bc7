"""One episode with live progress and pictures: what `demo` and `run` share."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from toponav.categories import readable
from toponav.cli.console import Output
from toponav.cli.progress import EpisodeDisplay
from toponav.config import config_json
from toponav.evaluation.explanation import ExplanationRecorder
from toponav.evaluation.model_files import ModelFiles
from toponav.evaluation.recollection import Recollection
from toponav.evaluation.recorder import EpisodeRecorder
from toponav.evaluation.results import EpisodeResult, to_json
from toponav.evaluation.run_config import RunConfig
from toponav.evaluation.run_folder import CONFIG_FILE, RESULT_FILE, RUN_FILE, RunRequest
from toponav.evaluation.runner import SceneRunner, check_parts
from toponav.files import write_atomic
from toponav.mapping.view import MapView
from toponav.memory.graph import TopologicalMemory
from toponav.policy.decision import Decision
from toponav.scenes.mesh import Scene
from toponav.types import Action, Observation
from toponav.viz.live.stream import LiveOptions, check, watching
from toponav.viz.panorama import save_panorama
from toponav.viz.topdown import TopDownPicture, save_topdown


@dataclass(frozen=True)
class EpisodeWish:
    """What the user asked for; what is None is up to the scene and the seed.

    Attributes:
        target: Category to find.
        start: (x, y, z, yaw), metres and radians.
        known: What the agent knows of the building, before and after; None to begin and end cold.
    """

    target: str | None = None
    start: tuple[float, float, float, float] | None = None
    known: Recollection | None = None


@dataclass(frozen=True)
class FinishedEpisode:
    """What became of it.

    Attributes:
        result: Its record.
        pose: Where it ended: (x, y, z, yaw), metres and radians.
    """

    result: EpisodeResult
    pose: tuple[float, float, float, float]


@dataclass(frozen=True)
class EpisodeFiles:
    """Where an episode is written.

    Attributes:
        folder: Gets config.json, run.json, result.json, trajectory.jsonl, decisions.jsonl,
            memory.json, topdown.png and a panorama a decision.
        source: What the scene was loaded from, so that the episode can be shown again.
        labels: Label table of a mesh scene.
        cache: Folder of a model's answers, which are not asked for again.
        live: What is shown and recorded while it runs.
    """

    folder: Path
    source: str
    labels: Path | None = None
    cache: Path | None = None
    live: LiveOptions = field(default_factory=LiveOptions)


@dataclass
class Narrator:
    """Tells and draws an episode as it goes; never steers it."""

    output: Output
    display: EpisodeDisplay
    folder: Path
    target: str
    every_steps: int = 50
    walked_m: float = 0.0
    positions: list[NDArray[np.float64]] = field(default_factory=list)
    memory: TopologicalMemory | None = None
    map_view: MapView | None = None

    def on_step(self, observation: Observation, action: Action) -> None:
        """Remember the path; say now and then how far the episode is."""
        del action
        position = observation.world_from_base.translation
        if self.positions:
            self.walked_m += float(np.linalg.norm(position - self.positions[-1]))
        else:
            self.display.enter("looking around")
        self.positions.append(position)
        self.display.advance(observation.step, self.walked_m)
        quiet_for_long = observation.step and observation.step % self.every_steps == 0
        if quiet_for_long and not self.display.live:
            self.output.say(f"step {observation.step:3d}  {self.walked_m:.1f} m walked")

    def on_decision(self, decision: Decision) -> None:
        """Say what was decided and why, and draw the panorama it rests on."""
        self.display.enter(decision.phase.value)
        where = "" if decision.memory is None else f"  at node {decision.memory.current}"
        self.output.say(
            f"step {decision.step:3d}  {decision.phase.value}{where}  {_reasoning(decision)}"
        )
        if decision.panorama:
            name = f"panorama_{decision.index:02d}.jpg"
            save_panorama(decision.panorama, decision.guidance, self.target, self.folder / name)

    def on_close(self, map_view: MapView | None, memory: TopologicalMemory | None) -> None:
        """Keep the last map and memory for the picture."""
        self.map_view = map_view
        self.memory = memory


def _reasoning(decision: Decision) -> str:
    guidance = decision.guidance
    if guidance is None:
        return "" if decision.waypoint is None else "next frontier"
    return (
        f"room: {readable(guidance.room_type)}; next: node {guidance.node_id}, "
        f"view {guidance.direction}; {guidance.reason}"
    )


def run_one(
    scene: Scene,
    config: RunConfig,
    wish: EpisodeWish,
    files: EpisodeFiles,
    output: Output,
) -> FinishedEpisode:
    """Run one episode and write everything about it.

    Args:
        scene: Where.
        config: How.
        wish: What to find and from where, as far as the user said.
        files: Where it is written.
        output: Where to tell about it.

    Raises:
        EpisodeError: The target or the start does not fit the scene.
        InputError: The method keeps nothing of what it has learnt, or what was asked to be shown
            live cannot be.
    """
    check_parts(config)
    check(files.live)
    with EpisodeDisplay(output, config.env.max_steps) as display:
        return _run_one(scene, config, wish, files, output, display)


def _run_one(
    scene: Scene,
    config: RunConfig,
    wish: EpisodeWish,
    files: EpisodeFiles,
    output: Output,
    display: EpisodeDisplay,
) -> FinishedEpisode:
    folder = files.folder
    runner = SceneRunner(scene, config)
    spec = runner.spec(0, runner.env.episode(wish.target, wish.start, config.seed))
    runner.check(spec)
    for stale in folder.glob("panorama_*.jpg"):
        stale.unlink()
    write_atomic(folder / CONFIG_FILE, config_json(config))
    request = RunRequest(source=files.source, labels=files.labels, episodes=1)
    write_atomic(folder / RUN_FILE, config_json(request))
    recorder = EpisodeRecorder(folder)
    narrator = Narrator(output, display, folder, spec.episode.target)
    output.say(f"searching for a {readable(spec.episode.target)} in {scene.name}")
    access = ModelFiles(folder, files.cache).access(spec.scene, spec.index)
    explainer = ExplanationRecorder(folder, spec.episode.target, access.log)
    name = f"{readable(spec.episode.target)} in {scene.name}"
    with watching(files.live, spec.episode.target, name) as live:
        watchers = (recorder, narrator) if live is None else (recorder, narrator, live)
        result = runner.run(spec, watchers, (*watchers, explainer), access, wish.known)
    display.enter("drawing")
    if files.live.record is not None:
        output.say(f"recording: {files.live.record} (open it with: rerun {files.live.record})")
    write_atomic(folder / RESULT_FILE, to_json(result) + "\n")
    if narrator.map_view is not None:
        picture = TopDownPicture(
            map_view=narrator.map_view,
            trajectory=np.array(narrator.positions),
            memory=narrator.memory,
            target=result.target,
            title=headline(result),
            subtitle=figures(result),
        )
        save_topdown(picture, folder / "topdown.png")
    x, y, z = runner.env.position.tolist()
    return FinishedEpisode(result, (x, y, z, runner.env.yaw))


def result_line(result: EpisodeResult) -> str:
    """The episode in one plain line."""
    return f"{headline(result)}: {figures(result)}"


def headline(result: EpisodeResult) -> str:
    """Whether what was searched for was found."""
    found = "found" if result.succeeded else "did not find"
    return f"{found} {readable(result.target)} in {result.scene}"


def figures(result: EpisodeResult) -> str:
    """Steps, lengths and how it ended."""
    distance = (
        "no path to it"
        if np.isinf(result.distance_to_goal)
        else f"{result.distance_to_goal:.2f} m from it"
    )
    return (
        f"{result.steps} steps, {result.path_length:.1f} m "
        f"(shortest {result.shortest_path:.1f} m), SPL {result.spl:.2f}, "
        f"ended by {result.ended} {distance}"
    )


def result_data(result: EpisodeResult, folder: Path) -> dict[str, Any]:
    """The same for programs: the record of `result.json` and where it lies."""
    return {**json.loads(to_json(result)), "out": str(folder)}
