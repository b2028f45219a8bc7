"""`toponav study`: several runs on the same episodes that differ in one thing, and their table."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated

import tyro

from toponav.cli.options import AgentOptions, JsonFlag, QuietFlag, RunOptions


def _paper() -> AgentOptions:
    return AgentOptions(preset="paper")


@dataclass(frozen=True)
class Study:
    """Run a study, such as one of the paper's tables, and print its table."""

    name: Annotated[str, tyro.conf.Positional, tyro.conf.arg(metavar="NAME")]
    """goal-detection (Table II), node-information (Table III), categories (Fig. 5), affordances,
    panorama, merge-distance, default-parts, revisit or methods."""

    source: Annotated[str, tyro.conf.Positional, tyro.conf.arg(metavar="SOURCE")]
    """As for `toponav eval`."""

    out: Path = Path("runs/study")
    """Folder with a run a variant. What is done there is not run again, so that an interrupted
    study goes on, and studies of the same episodes share their first variant."""

    runs: Annotated[RunOptions, tyro.conf.arg(name="")] = field(default_factory=RunOptions)
    """How many episodes, and by how many workers."""

    agent: Annotated[AgentOptions, tyro.conf.arg(name="")] = field(default_factory=_paper)
    """What the variants change."""

    plot: Path | None = None
    """Draw the success rates of the study's groups into this .png, .svg or .pdf."""

    quiet: QuietFlag = False
    """Say nothing but the result, and errors."""

    json: JsonFlag = False
    """Print all figures as one JSON object on stdout."""

    def run(self) -> None:
        """Run the variants and compare them with the first."""
        from toponav.cli.console import Output
        from toponav.cli.progress import RunDisplay
        from toponav.cli.resolve import resolve_run
        from toponav.cli.table import Table
        from toponav.evaluation.studies import run_study, study

        chosen = study(self.name)
        request, config = resolve_run(self.source, self.runs, self.agent)
        output = Output(self.json, quiet=self.quiet)
        output.say(chosen.title)
        folders = run_study(
            chosen, request, config, self.out, lambda variant: RunDisplay(output, variant.name)
        )
        Table(runs=tuple(folders), by=chosen.by, plot=self.plot, json=self.json).run()
