"""Live progress of a run or an episode: a bar in a terminal, plain lines elsewhere."""

from __future__ import annotations

from types import TracebackType
from typing import Self

from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    SpinnerColumn,
    TextColumn,
    TimeRemainingColumn,
)

from toponav.categories import readable
from toponav.cli.console import Output
from toponav.evaluation.evaluate import RunProgress
from toponav.evaluation.funnel import ERROR
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
        self._figures = RunFigures()

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
        figures = self._figures.after(progress.results)
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


class EpisodeDisplay:
    """Tells in a terminal where one episode is: its stage, steps, metres, and the time left.

    The time is what the steps up to the limit would take: most searches end before.
    """

    def __init__(self, output: Output, max_steps: int) -> None:
        """Show progress on the output's stderr, of at most `max_steps` steps."""
        self.live = output.progress.is_terminal
        self._bar = Progress(
            SpinnerColumn(), TextColumn("{task.description}"), BarColumn(bar_width=16),
            MofNCompleteColumn(), TextColumn("steps{task.fields[walked]}, at most"),
            TimeRemainingColumn(), TextColumn("left"),
            console=output.progress, disable=not self.live, transient=True,
        )  # fmt: skip
        self._task = self._bar.add_task(
            "getting ready (the first run compiles: up to a minute)", walked="", total=max_steps
        )

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

    def enter(self, stage: str) -> None:
        """Name what is being done from now on."""
        self._bar.update(self._task, description=stage)

    def advance(self, step: int, walked_m: float) -> None:
        """Tell how far the episode is."""
        self._bar.update(self._task, completed=step, walked=f", {walked_m:.1f} m walked")


class RunFigures:
    """SR at the benchmark's radius, SPL and errors so far; looks at every result once."""

    def __init__(self) -> None:
        """Nothing is seen yet."""
        self._seen = self._found = self._errors = 0
        self._spl = 0.0

    def after(self, results: list[EpisodeResult]) -> str:
        """The figures in a few words; `results` are those of the last call and the new ones."""
        for result in results[self._seen :]:
            self._found += result.succeeded
            self._errors += result.failure == ERROR
            self._spl += result.spl
        self._seen = len(results)
        if not results:
            return ""
        rate, spl = self._found / len(results), self._spl / len(results)
        errors = f" errors {self._errors}" if self._errors else ""
        return f"SR {100 * rate:.1f} % SPL {spl:.3f}{errors}"


def episode_line(result: EpisodeResult) -> str:
    """One finished episode in a few words."""
    what = f"{result.scene} #{result.index} {readable(result.target)}"
    if result.failure == ERROR:
        return f"{what}: {result.ended}"
    outcome = f"SPL {result.spl:.2f}" if result.succeeded else result.failure
    return f"{what}: {outcome}, {result.steps} steps, {result.seconds['total']:.1f} s"
