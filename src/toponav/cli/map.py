"""`toponav map`: the map and the memory of a recording of posed RGB-D images."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import tyro

from toponav.cli.options import JsonFlag


@dataclass(frozen=True)
class Map:
    """Build map and memory from posed RGB-D images.

    Writes each cloud as PLY, the memory, the path and a top-down picture.
    """

    recording: tyro.conf.Positional[Path]
    """Folder of frame-*.color, .depth and .pose files (7-Scenes layout)."""

    world: Literal["z-up", "y-up", "y-down"] | None = None
    """Which way the poses' world points; by default what recording.json says, else z up."""

    every: int = 1
    """Take every n-th frame."""

    out: Path = Path("runs/map")
    """Folder for the results."""

    json: JsonFlag = False
    """Print the counts as one JSON object on stdout."""

    def run(self) -> None:
        """Map the recording and write what came of it."""
        from toponav.cli.console import Output
        from toponav.cli.map_recording import write_map

        write_map(self.recording, self.world, self.every, self.out, Output(self.json))
