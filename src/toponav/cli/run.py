"""`toponav run`: one episode in a given scene."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated

import tyro

from toponav.cli.options import AgentOptions, JsonFlag, ShowOptions
from toponav.errors import InputError


@dataclass(frozen=True)
class Run:
    """Run one episode in a house file, a mesh scene or a generated house."""

    house: Annotated[str, tyro.conf.Positional, tyro.conf.arg(metavar="HOUSE")]
    """House file, DomestiGraph or ProcTHOR file, mesh scene, or generated:SEED."""

    target: str | None = None
    """What to find; by default what the scene's first episode asks for. Several goals, as
    chair,bed,toilet, are searched for one after the other from where the last search ended, with
    all that was learnt."""

    start: str | None = None
    """Start pose x,y,z,yaw in metres and radians; by default drawn from the seed."""

    memory: Path | None = None
    """File of what the agent knows of the building: read if it exists, and written at the end.
    Results with it are no cold starts: keep them apart."""

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
        """Load the scene and run an episode a goal."""
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
        from toponav.evaluation.recollection import Recollection
        from toponav.knowledge import load_knowledge, save_knowledge
        from toponav.scenes.loading import load_scene

        config = resolve_config(self.agent)
        start = None if self.start is None else start_pose(self.start)
        goals = _goals(self.target)
        output = Output(self.json, quiet=self.show.quiet)
        keeps = self.memory is not None or len(goals) > 1
        known = Recollection() if keeps else None
        if known is not None and self.memory is not None and self.memory.exists():
            known.knowledge = load_knowledge(self.memory, config.navigator.map)
        scene = load_scene(self.house, self.labels)
        folder = fresh_folder(self.out)
        lines, records = [], []
        for number, goal in enumerate(goals, start=1):
            own = folder if len(goals) == 1 else folder / f"{number}_{goal}"
            files = EpisodeFiles(own, self.house, self.labels, self.agent.cache, self.show.live())
            done = run_one(scene, config, EpisodeWish(goal, start, known), files, output)
            start = done.pose
            lines.append(result_line(done.result))
            records.append(result_data(done.result, own))
            if known is not None and known.knowledge is not None and self.memory is not None:
                save_knowledge(known.knowledge, self.memory)
        output.say(f"pictures and records: {folder}")
        data = records[0] if len(goals) == 1 else {"goals": records, "out": str(folder)}
        output.result("\n".join(lines), data)


def _goals(text: str | None) -> list[str | None]:
    """The goals of `--target`; None stands for the scene's own.

    Raises:
        InputError: There is an empty one.
    """
    if text is None:
        return [None]
    goals = [goal.strip() for goal in text.split(",")]
    if not all(goals):
        raise InputError(f"--target takes one category or several, as chair,bed, not {text!r}")
    return list(goals)
