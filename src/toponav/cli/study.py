"""`toponav study`: several runs on the same episodes that differ in one thing, and their table."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated

import tyro

from toponav.cli.options import AgentOptions, JsonFlag, RunOptions


def _paper() -> AgentOptions:
    return AgentOptions(preset="paper")


@dataclass(frozen=True)
class Study:
    """Run a study, such as one of the paper's tables, and print its table."""

    name: Annotated[str, tyro.conf.Positional, tyro.conf.arg(metavar="NAME")]
    """goal-detection, node-information, categories, affordances, panorama, merge-distance or
    methods."""

    source: Annotated[str, tyro.conf.Positional, tyro.conf.arg(metavar="SOURCE")]
    """As for `toponav eval`."""

    out: Path = Path("runs/study")
    """Folder with a run a variant. What is done there is not run again, so that an interrupted
    study goes on, and studies of the same episodes share their first variant."""

    runs: Annotated[RunOptions, tyro.conf.arg(name="")] = field(default_factory=RunOptions)
    """How many episodes, and by how many workers."""

    agent: Annotated[AgentOptions, tyro.conf.arg(name="")] = field(default_factory=_paper)
    """What the variants change."""

    json: JsonFlag = False
    """Print the table as one JSON object on stdout."""

    def run(self) -> None:
        """Run the variants and compare them with the first."""
