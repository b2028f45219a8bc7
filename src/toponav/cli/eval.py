"""`toponav eval`: many episodes, in process, appended to episodes.jsonl as they finish."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated

import tyro

from toponav.cli.options import AgentOptions, JsonFlag


@dataclass(frozen=True)
class Eval:
    """Run the episodes of a scene, a folder of scenes or a generator range, and sum them up."""

    source: Annotated[str, tyro.conf.Positional, tyro.conf.arg(metavar="SOURCE")]
    """Scene, folder of scenes, or generated:FIRST-LAST."""

    episodes: int | None = None
    """Episodes in all, spread evenly over the scenes; by default those that the scenes bring."""

    labels: Path | None = None
    """Label table of mesh scenes: JSON, node-name pattern to category."""

    out: Path = Path("runs/eval")
    """Folder for episodes.jsonl, config.json and summary.json; must not hold episodes yet."""

    agent: Annotated[AgentOptions, tyro.conf.arg(name="")] = field(default_factory=AgentOptions)
    """The agent."""

    json: JsonFlag = False
    """Print the summary as one JSON object on stdout."""

    def run(self) -> None:
        """Run and summarise."""
        from toponav.cli.console import Output
        from toponav.cli.episode import resolve_config, result_line
        from toponav.cli.options import fresh_folder
        from toponav.evaluation.evaluate import evaluate, summary_line

        config = resolve_config(self.agent)
        output = Output(self.json)
        folder = fresh_folder(self.out)
        summary = evaluate(
            self.source,
            config,
            folder,
            episodes=self.episodes,
            labels=self.labels,
            on_result=lambda done, total, result: output.say(
                f"[{done}{'' if total is None else f'/{total}'}] {result_line(result)}"
            ),
        )
        output.result(summary_line(summary), summary)
