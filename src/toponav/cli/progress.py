"""Live progress of a run: a bar in a terminal, a line an episode elsewhere."""

from __future__ import annotations

from types import TracebackType
from typing import Self

from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from toponav.categories import readable
from toponav.cli.console import Output
from toponav.evaluation.evaluate import RunProgress
from toponav.evaluation.funnel import ERROR
from toponav.evaluation.metrics import finite_mean
from toponav.evaluation.results import EpisodeResult


class RunDisplay:
    """Tells how far a run is: episodes done, SR, SPL, errors and the time left."""

    def __init__(self, output: Output, name: str = "") -> None:
        """Show progress on the output's stderr, the run's name before it."""
        self._output = output
        self._bar = Progress(
            TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(),
            TextColumn("{task.fields[figures]}"), TimeRemainingColumn(),
            console=output.progress, disable=not output.progress.is_terminal,
        )  # fmt: skip
        self._task = self._bar.add_task(name, figures="", total=None)

    def __enter__(self) -> Self:
        self._bar.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._bar.stop()

    def on_progress(self, progress: RunProgress) -> None:
        """Move the bar; without a terminal, or on an error, say the episode in a line."""
        figures = run_figures(progress.results)
        self._bar.update(self._task, completed=progress.done, total=progress.total, figures=figures)
        if progress.outcome is None:
            if progress.done:
                self._output.say(f"going on after {progress.done} of {progress.total} episodes")
            return
        result = progress.outcome.result
        if result.failure == ERROR or not self._output.progress.is_terminal:
            self._output.say(
                f"[{progress.done}/{progress.total}] {figures}  {episode_line(result)}"
            )


def run_figures(results: list[EpisodeResult]) -> str:
    """SR at the benchmark's radius, SPL and errors so far."""
    if not results:
        return ""
    rate = sum(result.succeeded for result in results) / len(results)
    spl, _ = finite_mean([result.spl for result in results])
    errors = sum(result.failure == ERROR for result in results)
    return f"SR {100 * rate:.1f} % SPL {spl:.3f}" + (f" errors {errors}" if errors else "")


def episode_line(result: EpisodeResult) -> str:
    """One finished episode in a few words."""
    what = f"{result.scene} #{result.index} {readable(result.target)}"
    if result.failure == ERROR:
        return f"{what}: {result.ended}"
    outcome = f"SPL {result.spl:.2f}" if result.succeeded else result.failure
    return f"{what}: {outcome}, {result.steps} steps, {result.seconds['total']:.1f} s"
