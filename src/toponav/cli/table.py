"""`toponav table`: finished runs as tables with intervals, and compared with each other."""

from __future__ import annotations

import shutil
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import tyro

from toponav.cli.options import JsonFlag
from toponav.errors import InputError

if TYPE_CHECKING:
    from toponav.cli.console import Output
    from toponav.evaluation.tables.report import Report
    from toponav.evaluation.tables.runs import Run


@dataclass(frozen=True)
class Table:
    """Set finished runs side by side: rates and means with 95 % intervals, paired differences.

    The runs are compared on the episodes that they share, with the first one or with --against.
    """

    runs: Annotated[tuple[Path, ...], tyro.conf.Positional, tyro.conf.arg(metavar="DIR")]
    """Folders that toponav eval wrote, or folders of such folders."""

    by: (
        Literal["category", "size", "size-fixed", "distance", "floor", "scene", "failure"] | None
    ) = None
    """Split the runs: by target, by navigable area (thirds, or 50/100/200 m2), by shortest path, by
    floor of the target, by scene, or by what became of the episodes."""

    against: Path | None = None
    """Run that the others are compared with; by default the first. It may be one of the runs or
    another one, which then comes first."""

    names: str | None = None
    """Names of the runs in the tables, separated by commas, in the order of the runs."""

    format: Literal["terminal", "markdown", "csv", "latex"] | None = None
    """By default what the suffix of --out says (.md, .csv, .tex), else terminal."""

    out: Path | None = None
    """Write the tables into this file instead of printing them."""

    plot: Path | None = None
    """Draw the success rates of the groups of --by into this .png, .svg or .pdf."""

    cluster: Annotated[bool, tyro.conf.FlagCreatePairsOff] = False
    """Resample whole scenes for every interval: episodes of one house are not independent."""

    resamples: int = 10_000
    """Resamples of the bootstrap."""

    json: JsonFlag = False
    """Print all figures as one JSON object on stdout."""

    def run(self) -> None:
        """Read, sum up and print."""
        from toponav.cli.console import Output
        from toponav.config import parse_config
        from toponav.evaluation.statistics import Resampling
        from toponav.evaluation.tables.report import ReportOptions, report

        self._check_plot()
        values = {"resamples": self.resamples, "unit": "scene" if self.cluster else "episode"}
        resampling = parse_config(Resampling, values, "the command line")
        runs, against = self._load()
        told = report(runs, ReportOptions(self.by, against, resampling))
        output = Output(self.json)
        if self.plot is not None:
            from toponav.viz.bars import report_chart, save_bars

            save_bars(report_chart(told), self.plot)
            output.say(f"picture: {self.plot}")
        self._print(told, output)

    def _check_plot(self) -> None:
        from toponav.viz.bars import check_kind

        if self.plot is None:
            return
        check_kind(self.plot)
        if self.by is None:
            raise InputError("--plot draws groups: add --by, as in --by category")

    def _load(self) -> tuple[list[Run], int]:
        """The runs, and which of them the others are compared with."""
        from toponav.evaluation.tables.runs import load_runs, run_folders

        folders = run_folders(self.runs)
        base = folders[0].resolve() if self.against is None else self._base(self.against)
        resolved = [folder.resolve() for folder in folders]
        if self.against is not None and base not in resolved:
            folders, resolved = [self.against, *folders], [base, *resolved]
        names = [] if self.names is None else [name.strip() for name in self.names.split(",")]
        return load_runs(folders, names), resolved.index(base)

    @staticmethod
    def _base(against: Path) -> Path:
        from toponav.evaluation.tables.runs import run_folders

        found = run_folders([against])
        if found != [against]:
            raise InputError(f"--against {against} holds several runs; give the folder of one")
        return against.resolve()

    def _print(self, told: Report, output: Output) -> None:
        """The tables into the file or on stdout, the figures for programs on stdout."""
        from toponav.evaluation.tables.formats import format_of, render
        from toponav.evaluation.tables.report_data import report_data
        from toponav.evaluation.tables.report_tables import report_tables
        from toponav.files import write_atomic

        form = self.format or format_of(self.out)
        to_terminal = self.out is None and sys.stdout.isatty()
        width = shutil.get_terminal_size().columns if to_terminal else None
        text = render(report_tables(told), form, width)
        if self.out is None:
            output.result(text, report_data(told))
            return
        write_atomic(self.out, text + "\n")
        output.say(f"tables: {self.out}")
        if self.json:
            output.result("", report_data(told))
