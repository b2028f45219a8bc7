"""`toponav eval`: many episodes, appended to episodes.jsonl as they finish."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated

import tyro

from toponav.cli.options import AgentOptions, JsonFlag, QuietFlag, RunOptions


@dataclass(frozen=True)
class Eval:
    """Run the episodes of scenes or of an ObjectNav episode file, and sum them up."""

    source: Annotated[str | None, tyro.conf.Positional, tyro.conf.arg(metavar="SOURCE")] = None
    """Scene, folder of scenes, generated:FIRST-LAST, an ObjectNav episode file (.json.gz), or a
    benchmark: objectnav-hm3d-v1, objectnav-hm3d-v2, objectnav-mp3d (name:split for a split other
    than val)."""

    out: Path = Path("runs/eval")
    """Folder for episodes.jsonl, config.json and summary.json; must not hold episodes yet."""

    resume: Annotated[bool, tyro.conf.FlagCreatePairsOff] = False
    """Go on with the run in --out: what is done stays, a line that a kill cut short is repaired."""

    shard: str | None = None
    """Run only part i of n of the episodes, as 2/8; each part into an --out of its own."""

    replay: Path | None = None
    """Run the episodes of an earlier run again, its model's answers given from its records, without
    a network; SOURCE and the agent's options are those of that run."""

    runs: Annotated[RunOptions, tyro.conf.arg(name="")] = field(default_factory=RunOptions)
    """How many, and by how many workers."""

    agent: Annotated[AgentOptions, tyro.conf.arg(name="")] = field(default_factory=AgentOptions)
    """The agent."""

    quiet: QuietFlag = False
    """Say nothing but the result, and errors."""

    json: JsonFlag = False
    """Print the summary as one JSON object on stdout."""

    def run(self) -> None:
        """Run and summarise."""
        from toponav.cli.console import Output
        from toponav.cli.progress import RunDisplay
        from toponav.cli.resolve import resolve_replay, resolve_run
        from toponav.evaluation.evaluate import evaluate, summary_line

        if self.replay is None:
            request, config = resolve_run(self.source, self.runs, self.agent, self.shard)
        else:
            request, config = resolve_replay(self.replay, self.source, self.runs, self.agent)
        output = Output(self.json, quiet=self.quiet)
        with RunDisplay(output) as display:
            summary = evaluate(request, config, self.out, self.resume, display.on_progress)
        output.result(summary_line(summary), summary)
