"""`toponav run`: one episode in a given scene."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated

import tyro

from toponav.cli.options import AgentOptions, JsonFlag, ShowOptions


@dataclass(frozen=True)
class Run:
    """Run one episode in a house file, a mesh scene or a generated house."""

    house: Annotated[str, tyro.conf.Positional, tyro.conf.arg(metavar="HOUSE")]
    """House file, DomestiGraph or ProcTHOR file, mesh scene, or generated:SEED."""

    target: str | None = None
    """What to find; by default what the scene's first episode asks for."""

    start: str | None = None
    """Start pose x,y,z,yaw in metres and radians; by default drawn from the seed."""

    labels: Path | None = None
    """Label table of a mesh scene: JSON, node-name pattern to category."""

    out: Path = Path("runs/run")
    """Folder for the results."""

    agent: Annotated[AgentOptions, tyro.conf.arg(name="")] = field(default_factory=AgentOptions)
    """The agent."""

    show: Annotated[ShowOptions, tyro.conf.arg(name="")] = field(default_factory=ShowOptions)
    """What to show of it."""

    json: JsonFlag = False
    """Print the result as one JSON object on stdout."""

    def run(self) -> None:
        """Load the scene and run the episode."""
        from toponav.cli.console import Output
        from toponav.cli.episode import (
            EpisodeFiles,
            EpisodeWish,
            result_data,
            result_line,
            run_one,
        )
        from toponav.cli.options import fresh_folder, start_pose
        from toponav.cli.resolve import resolve_config
        from toponav.scenes.loading import load_scene

        config = resolve_config(self.agent)
        start = None if self.start is None else start_pose(self.start)
        output = Output(self.json, quiet=self.show.quiet)
        scene = load_scene(self.house, self.labels)
        folder = fresh_folder(self.out)
        files = EpisodeFiles(folder, self.house, self.labels, self.agent.cache, self.show.live())
        result = run_one(scene, config, EpisodeWish(self.target, start), files, output)
        output.say(f"pictures and records: {folder}")
        output.result(result_line(result), result_data(result, folder))
