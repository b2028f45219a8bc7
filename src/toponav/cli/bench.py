"""`toponav bench`: the performance figures, by command."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import tyro

from toponav.cli.options import JsonFlag
from toponav.errors import InputError


@dataclass(frozen=True)
class Sim:
    """The simulator's RGB, depth and ids on one core."""

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


@dataclass(frozen=True)
class Scale:
    """What an evaluation's bookkeeping costs: blank episodes, many workers, some of which die."""

    episodes: int = 2000
    """Episodes, without any rendering."""

    workers: int = 64
    """Workers."""

    deaths: float = 0.05
    """Share of the runs in which the worker dies."""

    ray: Annotated[bool, tyro.conf.FlagCreatePairsOff] = False
    """Workers are real Ray processes that really die; without, they are feigned in this one."""

    json: JsonFlag = False
    """Print the figures as one JSON object on stdout."""

    def run(self) -> None:
        """Drive and print; the run's files are thrown away."""
        from tempfile import TemporaryDirectory

        from toponav.cli.console import Output
        from toponav.cli.progress import RunDisplay
        from toponav.config import parse_config
        from toponav.evaluation.bench_scale import ScaleConfig, bench_scale

        options = {
            "episodes": self.episodes,
            "workers": self.workers,
            "deaths": self.deaths,
            "ray": self.ray,
        }
        config = parse_config(ScaleConfig, options, "the command line")
        output = Output(self.json)
        with TemporaryDirectory() as folder, RunDisplay(output, "bookkeeping") as display:
            figures = bench_scale(config, Path(folder), display.on_progress)
        output.result(_scale_line(figures), figures)


def _scale_line(figures: dict[str, Any]) -> str:
    growth = figures["rss_growth_mb"]
    return (
        f"{figures['episodes']} blank episodes, {figures['workers']} "
        f"{'Ray processes' if figures['ray'] else 'feigned workers'}: "
        f"{figures['episodes_per_s']:.0f} episodes/s, {figures['seconds']:.1f} s in all; "
        f"{figures['died']} workers died, {figures['given_up']} episodes given up; "
        f"driver grew by {'an unknown number of' if growth is None else f'{growth:.1f}'} MB, "
        f"journal {figures['journal_kb']:.0f} kB; "
        f"{figures['duplicates']} duplicates, {figures['lost']} lost"
    )


@dataclass(frozen=True)
class Bench:
    """Print performance figures, each with the command that measures it."""

    command: (
        Annotated[Sim, tyro.conf.subcommand("sim")]
        | Annotated[Scale, tyro.conf.subcommand("scale")]
    )

    def run(self) -> None:
        """Run the chosen subcommand."""
        self.command.run()
