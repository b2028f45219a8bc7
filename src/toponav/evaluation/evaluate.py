"""Many episodes in one process: every result is appended and flushed as it finishes."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

from toponav.config import config_json
from toponav.errors import EpisodeError, InputError
from toponav.evaluation.metrics import BENCHMARK_RADIUS_M
from toponav.evaluation.results import (
    EpisodeResult,
    json_ready,
    summarize,
    to_json,
)
from toponav.evaluation.rollout import EpisodeSpec, Rollout
from toponav.evaluation.run_config import RunConfig
from toponav.evaluation.runner import SceneRunner
from toponav.files import append_line, write_atomic
from toponav.scenes.loading import list_scenes, load_scene

OnResult = Callable[[int, int | None, EpisodeResult], None]
"""Called with the episodes done, the total when it is known, and the newest result."""


def evaluate(
    source: str,
    config: RunConfig,
    folder: Path,
    episodes: int | None = None,
    labels: Path | None = None,
    on_result: OnResult = lambda done, total, result: None,
) -> dict[str, Any]:
    """Run the episodes of `source`, scene by scene, and write them into `folder`.

    Args:
        source: A scene, a folder of scenes or a generator range.
        config: The run.
        folder: Gets `config.json`, `episodes.jsonl` and `summary.json`.
        episodes: How many in all, spread evenly over the scenes; None runs those the scenes bring.
        labels: Label table of mesh scenes.
        on_result: Progress.

    Returns:
        The summary: all episodes, those that stay on one floor, and those that change floor.

    Raises:
        InputError: Nothing to run, or the folder holds the episodes of another run.
    """
    if episodes is not None and episodes < 1:
        raise InputError(f"--episodes takes a positive number, not {episodes}")
    scenes = list_scenes(source)
    results_path = folder / "episodes.jsonl"
    if results_path.exists():
        raise InputError(f"{results_path} exists: choose another --out, or move it away")
    write_atomic(folder / "config.json", config_json(config))
    results: list[EpisodeResult] = []
    for number, spec in enumerate(scenes):
        runner = SceneRunner(load_scene(spec, labels), config)
        for episode in runner.episodes(_share(episodes, number, len(scenes))):
            result = _run(runner, episode)
            append_line(results_path, to_json(result))
            results.append(result)
            on_result(len(results), episodes, result)
    summary = {
        "source": source,
        "method": config.method,
        "preset": config.preset,
        "all": summarize(results),
        "same_floor": summarize([result for result in results if not result.floor_change]),
        "floor_change": summarize([result for result in results if result.floor_change]),
    }
    write_atomic(folder / "summary.json", json.dumps(json_ready(summary), indent=2) + "\n")
    return summary


def _run(runner: SceneRunner, episode: EpisodeSpec) -> EpisodeResult:
    """Run an episode; one that its scene cannot host is a failed result that says why."""
    try:
        return runner.run(episode)
    except EpisodeError as error:
        impossible = Rollout(math.inf, False, ended=f"error: {error}", distance_to_goal=math.inf)
        return runner.scored(episode, impossible, decisions=0)


def _share(total: int | None, number: int, scenes: int) -> int | None:
    """How many of `total` episodes scene `number` gets; the first ones get the remainder."""
    if total is None:
        return None
    return total // scenes + (1 if number < total % scenes else 0)


def summary_line(summary: dict[str, Any]) -> str:
    """The run in a few plain lines: one for each group that has episodes."""
    lines = [f"{summary['method']} (preset {summary['preset']}) on {summary['source']}"]
    for group in ("all", "same_floor", "floor_change"):
        row = summary[group]
        if row["n"]:
            lines.append(f"  {group.replace('_', ' '):13s}{_row(row)}")
    return "\n".join(lines)


def _row(row: dict[str, Any]) -> str:
    rate = row["sr"][str(BENCHMARK_RADIUS_M)]
    low, high = rate["interval"]
    dtg = "-" if row["dtg"] is None else f"{row['dtg']:.2f} m"
    return (
        f"n {row['n']}, SR@0.1 {100 * rate['rate']:.1f} % "
        f"[{100 * low:.1f}, {100 * high:.1f}], SR@1.0 {100 * row['sr']['1.0']['rate']:.1f} %, "
        f"SPL {row['spl']:.3f}, SoftSPL {row['soft_spl']:.3f}, DTG {dtg}, "
        f"unreachable {row['unreachable']}, steps {row['steps']:.0f}"
    )
