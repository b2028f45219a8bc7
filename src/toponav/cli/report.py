"""`toponav report`: finished runs as one page to look through."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Annotated

import tyro

from toponav.cli.options import JsonFlag
from toponav.errors import InputError


@dataclass(frozen=True)
class Report:
    """Write runs into one HTML file that works offline: tables, filters and every decision.

    Each episode has its map, a slider over its decisions, and what they rested on; two runs are set
    side by side on the same episode.
    """

    runs: Annotated[tuple[Path, ...], tyro.conf.Positional, tyro.conf.arg(metavar="DIR")]
    """Folders that toponav eval, demo or run wrote, or folders of such folders."""

    out: Path | None = None
    """The page; by default report.html in the first DIR."""

    names: str | None = None
    """Names of the runs on the page, separated by commas, in the order of the runs."""

    max_mb: float = 60.0
    """Pictures are made smaller when the page would be larger, megabytes."""

    resamples: int = 10_000
    """Resamples of the bootstrap."""

    json: JsonFlag = False
    """Print what was written as one JSON object on stdout."""

    def run(self) -> None:
        """Read the runs and write the page."""
        from toponav.cli.console import Output
        from toponav.config import parse_config
        from toponav.evaluation.statistics import Resampling
        from toponav.evaluation.tables.runs import load_runs
        from toponav.viz.report.report import MEGABYTE, write_report

        if not self.max_mb > 0.0:
            raise InputError(f"--max-mb takes a positive number, not {self.max_mb:g}")
        names = [] if self.names is None else [name.strip() for name in self.names.split(",")]
        runs = load_runs(self.runs, names)
        resampling = parse_config(Resampling, {"resamples": self.resamples}, "the command line")
        output = Output(self.json)
        path = self.out if self.out is not None else self.runs[0] / "report.html"
        with output.progress.status("reading") as status:
            written = write_report(
                runs, path, self.max_mb, resampling,
                lambda done, total: status.update(f"read {done} of {total} episodes"),
            )  # fmt: skip
        size_mb = written.size / MEGABYTE
        if size_mb > self.max_mb:
            output.say(f"the page takes more than {self.max_mb:g} MB with the smallest pictures")
        if written.explained < written.episodes:
            bare = written.episodes - written.explained
            output.say(f"{bare} episodes have no maps: toponav eval --explain records them")
        count = "1 episode" if written.episodes == 1 else f"{written.episodes} episodes"
        line = f"{written.path}: {count}, {size_mb:.1f} MB"
        output.result(line, {**asdict(written), "path": str(written.path)})
