"""`toponav demo`: one episode in a generated house."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated

import tyro

from toponav.cli.options import JsonFlag, ShowOptions


@dataclass(frozen=True)
class Demo:
    """Find an object in a generated house: no GPU, no simulator, no key.

    Writes the resolved configuration, the result, the path, every decision and pictures.
    """

    seed: int = 0
    """Seed of the house and of the episode."""

    target: str | None = None
    """What to find; by default what the house's first episode asks for."""

    out: Path = Path("runs/demo")
    """Folder for the results."""

    show: Annotated[ShowOptions, tyro.conf.arg(name="")] = field(default_factory=ShowOptions)
    """What to show of it."""

    json: JsonFlag = False
    """Print the result as one JSON object on stdout."""

    def run(self) -> None:
        """Generate the house and run its first episode."""
        from toponav.cli.console import Output
        from toponav.cli.episode import (
            EpisodeFiles,
            EpisodeWish,
            result_data,
            result_line,
            run_one,
        )
        from toponav.cli.options import AgentOptions, fresh_folder
        from toponav.cli.resolve import resolve_config
        from toponav.scenes.loading import load_scene

        output = Output(self.json, quiet=self.show.quiet)
        folder = fresh_folder(self.out)
        source = f"generated:{self.seed}"
        scene = load_scene(source)
        config = resolve_config(AgentOptions(seed=self.seed))
        files = EpisodeFiles(folder, source, live=self.show.live())
        result = run_one(scene, config, EpisodeWish(self.target), files, output).result
        output.say(f"pictures and records: {folder}")
        output.result(result_line(result), result_data(result, folder))
