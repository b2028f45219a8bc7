"""Real small runs with everything recorded, for the tests of the explorer."""

from __future__ import annotations

from pathlib import Path

from small_house import small_config
from toponav.evaluation.evaluate import evaluate
from toponav.evaluation.run_folder import RunRequest
from toponav.evaluation.tables.runs import Run, load_runs
from toponav.viz.report.report import write_report

MAX_STEPS = 120


def explained_run(
    folder: Path, source: str, episodes: int, preset: str = "default", explain: bool = True
) -> Path:
    """Run episodes into a folder as `toponav eval` does."""
    config = small_config(preset=preset, max_steps=MAX_STEPS)
    folder.mkdir(parents=True)
    evaluate(RunRequest(source=source, episodes=episodes, explain=explain), config, folder)
    return folder


def report_of(path: Path, *folders: Path, names: tuple[str, ...] = ()) -> tuple[Path, list[Run]]:
    """The page of some runs, and what is on it."""
    runs = load_runs(folders, names)
    write_report(runs, path, max_mb=60.0)
    return path, runs
