"""Results as `toponav eval` would write them, made without running anything."""

from __future__ import annotations

import json
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from toponav.evaluation.results import EpisodeResult, score_episode, to_json
from toponav.evaluation.run_config import run_config
from toponav.evaluation.tables.runs import Run


def made_result(scene: str = "s", index: int = 0, **changes: Any) -> EpisodeResult:
    """A result whose scores follow from its distances, however these are changed."""
    values: dict[str, Any] = {
        "target": "bed", "method": "toponav", "seed": 3, "stop_called": True,
        "distance_to_goal": 0.05, "shortest_path": 4.0, "path_length": 5.0, "steps": 30,
        "collisions": 1, "decisions": 2, "seconds": {"total": 1.5}, "ended": "stop",
        "floor_change": False, "config_sha": "0" * 12, "scene_m2": 60.0,
    }  # fmt: skip
    values.update(changes)
    names = ("stop_called", "distance_to_goal", "shortest_path", "path_length")
    score = score_episode(*(values[name] for name in names))
    scores = {"success": score.success, "spl": score.spl, "soft_spl": score.soft_spl}
    return EpisodeResult(scene=scene, index=index, **{**values, **scores})


def missed(scene: str = "s", index: int = 0, **changes: Any) -> EpisodeResult:
    """A result that fails 2 m from the target at the step limit."""
    values = {"stop_called": False, "distance_to_goal": 2.0, "ended": "step-limit",
              "failure": "step limit", **changes}  # fmt: skip
    return made_result(scene, index, **values)


def made_run(name: str, results: Iterable[EpisodeResult], **config: Any) -> Run:
    """A run in memory."""
    return Run(name, Path(name), {**made_config(), **config}, tuple(results))


def made_config() -> dict[str, Any]:
    """The configuration that `config.json` of a run with the defaults holds."""
    return dict(run_config("default").model_dump(mode="json"))


def write_run(folder: Path, results: Iterable[EpisodeResult], **config: Any) -> Path:
    """A run's folder."""
    folder.mkdir(parents=True)
    (folder / "config.json").write_text(json.dumps({**made_config(), **config}))
    (folder / "episodes.jsonl").write_text("".join(to_json(result) + "\n" for result in results))
    return folder
