"""`toponav bench`: the performance figures, by command."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

import tyro

from toponav.cli.options import JsonFlag
from toponav.errors import InputError


@dataclass(frozen=True)
class Bench:
    """Print performance figures; `sim`: the simulator's RGB, depth and ids on one core."""

    what: tyro.conf.Positional[Literal["sim"]]
    """What to time."""

    scene: Annotated[str, tyro.conf.Positional, tyro.conf.arg(metavar="SCENE")] = "generated:0"
    """House, mesh scene or generated:SEED."""

    labels: Path | None = None
    """Label table of a mesh scene."""

    camera: str = "640x480"
    """Image size, WIDTHxHEIGHT."""

    frames: int = 50
    """Frames that are timed."""

    json: JsonFlag = False
    """Print the figures as one JSON object on stdout."""

    def run(self) -> None:
        """Time and print."""
        from toponav.cli.console import Output
        from toponav.cli.options import image_size
        from toponav.evaluation.bench_sim import bench_sim
        from toponav.scenes.loading import load_scene

        if self.frames < 1:
            raise InputError(f"--frames takes a positive number, not {self.frames}")
        width, height = image_size(self.camera)
        figures = bench_sim(load_scene(self.scene, self.labels), width, height, self.frames)
        line = (
            f"{figures['scene']}: {figures['sim_fps']['raster']:.1f} frames/s "
            f"at {width} x {height} (median {figures['frame_ms']:.1f} ms, "
            f"with Embree {figures['sim_fps']['embree']:.1f} frames/s; "
            f"{figures['triangles']} triangles, one of {figures['cores']} cores); "
            f"navigable surface in {figures['surface_s']:.2f} s"
        )
        Output(self.json).result(line, figures)
