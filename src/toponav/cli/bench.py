"""`toponav bench`: the performance figures, by command."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

import tyro

from toponav.cli.bench_habitat import Habitat, HabitatLab
from toponav.cli.bench_robot import FaultBench, RobotBench
from toponav.cli.options import JsonFlag, WorldOption
from toponav.errors import InputError, MissingExtraError


@dataclass(frozen=True)
class Sim:
    """The simulator's RGB, depth and ids with each renderer, taking turns."""

    scene: Annotated[str, tyro.conf.Positional, tyro.conf.arg(metavar="SCENE")] = "generated:0"
    """House, mesh scene or generated:SEED."""

    labels: Path | None = None
    """Label table of a mesh scene."""

    renderer: Literal["raster", "embree", "gl"] | None = None
    """Time this one alone; by default all that can be had."""

    cores: int | None = None
    """Cores that are used; by default all."""

    camera: str = "640x480"
    """Image size, WIDTHxHEIGHT."""

    frames: int = 50
    """Frames that are timed with each renderer."""

    json: JsonFlag = False
    """Print the figures as one JSON object on stdout."""

    def run(self) -> None:
        """Time and print."""
        from toponav.cli.console import Output
        from toponav.cli.options import image_size
        from toponav.envs.simulator.renderers import RENDERERS, why_missing
        from toponav.evaluation.bench_sim import bench_sim, only_cores
        from toponav.scenes.loading import load_scene

        if self.frames < 1:
            raise InputError(f"--frames takes a positive number, not {self.frames}")
        if self.cores is not None and self.cores < 1:
            raise InputError(f"--cores takes a positive number, not {self.cores}")
        size = image_size(self.camera)
        output = Output(self.json)
        with only_cores(self.cores):
            chosen = RENDERERS if self.renderer is None else (self.renderer,)
            missing = {name: reason for name in chosen if (reason := why_missing(name))}
            if missing and self.renderer is not None:
                raise MissingExtraError(missing[self.renderer])
            for reason in missing.values():
                output.say(reason)
            present = [name for name in chosen if name not in missing]
            figures = bench_sim(load_scene(self.scene, self.labels), present, size, self.frames)
        output.result(_sim_line(figures), figures)


def _sim_line(figures: dict[str, Any]) -> str:
    width, height = figures["size"]
    renderers = "; ".join(
        f"{name} {fps:.1f} frames/s (median {figures['frame_ms'][name]:.1f} ms, "
        f"{figures['cpu_ms'][name]:.1f} ms of processor time)"
        for name, fps in figures["sim_fps"].items()
    )
    return (
        f"{figures['scene']} at {width} x {height}, cores used {figures['cores']}: {renderers}; "
        f"{figures['triangles']} triangles; navigable surface in {figures['surface_s']:.2f} s"
    )


@dataclass(frozen=True)
class Map:
    """What integrating a frame costs, beside a pipeline of the usual kind on the same frames."""

    recording: Annotated[
        Path | None, tyro.conf.Positional, tyro.conf.arg(metavar="[RECORDING]")
    ] = None
    """Folder with posed RGB-D images; by default a tour of a furnished building."""

    world: WorldOption = None
    """Which way is up in the recording's world; told from the floor when left out."""

    detector: str | None = None
    """Labels the recording, outside the clock; by default four boxes stand for detections."""

    area: float = 150.0
    """Square metres of the tour's building."""

    camera: str = "640x480"
    """Image size of the tour, WIDTHxHEIGHT."""

    preset: Literal["default", "paper"] = "default"
    """Whose map."""

    open3d: Annotated[bool, tyro.conf.FlagCreatePairsOff] = False
    """Time the same frames in a pipeline on Open3D (pip install open3d)."""

    json: JsonFlag = False
    """Print the figures as one JSON object on stdout."""

    def run(self) -> None:
        """Time and print."""
        from toponav.cli.console import Output
        from toponav.cli.options import image_size
        from toponav.config import preset
        from toponav.evaluation.bench_map import bench_map
        from toponav.evaluation.bench_tour import Tour, recorded_frames

        config = preset(self.preset)
        if self.recording is None:
            frames = list(Tour(self.area, *image_size(self.camera)))
        else:
            frames = recorded_frames(self.recording, self.world, self.detector, config)
        figures = bench_map(frames, config.map, with_open3d=self.open3d)
        Output(self.json).result(_map_line(figures), figures)


def _map_line(figures: dict[str, Any]) -> str:
    width, height = figures["size"]
    usual = (
        ""
        if figures["open3d_ms"] is None
        else f"Open3D {figures['open3d_ms']:.1f} ms, {figures['open3d_ratio']:.0f} times as long; "
    )
    same = "the same voxels as" if figures["equal_to_reference"] else "OTHER VOXELS THAN"
    return (
        f"{figures['frames']} frames of {width} x {height} with labels: integrated in "
        f"{figures['integrate_ms']:.2f} ms (median; 95 % within "
        f"{figures['integrate_p95_ms']:.2f}), handed out in {figures['view_ms']:.2f} ms; "
        f"{usual}{figures['voxels']} voxels, {same} a reference in NumPy; one of "
        f"{figures['cores']} cores"
    )


@dataclass(frozen=True)
class Decide:
    """What a whole decision costs, and how much more in a large building."""

    small: float = 100.0
    """Square metres of the small building."""

    large: float = 1500.0
    """Square metres of the large building."""

    camera: str = "640x480"
    """Image size, WIDTHxHEIGHT."""

    decisions: int = 9
    """Decisions that count in each, the last ones of a tour."""

    preset: Literal["default", "paper"] = "default"
    """Whose navigator."""

    json: JsonFlag = False
    """Print the figures as one JSON object on stdout."""

    def run(self) -> None:
        """Time and print."""
        from toponav.cli.console import Output
        from toponav.cli.options import image_size
        from toponav.config import preset
        from toponav.evaluation.bench_decide import bench_decide

        size = image_size(self.camera)
        figures = bench_decide(
            preset(self.preset), self.small, self.large, size, max(1, self.decisions)
        )
        Output(self.json).result(
            f"a decision, twelve frames of {size[0]} x {size[1]} included: "
            f"{figures['decide_ms']:.0f} ms in {figures['small_m2']:.0f} m2, "
            f"{figures['decide_large_ms']:.0f} ms with {figures['large_m2']:.0f} m2 mapped, "
            f"{figures['decide_growth']:.2f} times",
            figures,
        )


@dataclass(frozen=True)
class Memory:
    """How much memory a map takes, and whether it grows without anything new to see."""

    area: float = 1500.0
    """Square metres of the building that is mapped."""

    camera: str = "640x480"
    """Image size, WIDTHxHEIGHT."""

    still: int = 10_000
    """Frames integrated while standing still at the end."""

    preset: Literal["default", "paper"] = "default"
    """Whose map."""

    json: JsonFlag = False
    """Print the figures as one JSON object on stdout."""

    def run(self) -> None:
        """Measure and print."""
        from toponav.cli.console import Output
        from toponav.cli.options import image_size
        from toponav.config import preset
        from toponav.evaluation.bench_memory import bench_memory

        size = image_size(self.camera)
        figures = bench_memory(preset(self.preset).map, self.area, size, self.still)
        Output(self.json).result(
            f"{figures['area_m2']:.0f} m2 mapped: {figures['rss_mb']:.0f} MB resident, of them "
            f"{figures['map_mb']:.1f} MB the map ({figures['map_bytes_per_m2'] / 1e3:.1f} kB a "
            f"square metre); {figures['rss_growth_mb']:+.1f} MB after {figures['still_frames']} "
            "frames standing still",
            figures,
        )


@dataclass(frozen=True)
class MovedThings:
    """What becomes of map and search when things are moved meanwhile, with and without clearing."""

    houses: int = 40
    """Generated houses; in each, three things are moved when the target comes into sight."""

    camera: str = "320x240"
    """Image size, WIDTHxHEIGHT."""

    json: JsonFlag = False
    """Print the figures as one JSON object on stdout."""

    def run(self) -> None:
        """Run and print."""
        from toponav.cli.console import Output
        from toponav.cli.options import image_size
        from toponav.config import preset, with_overrides
        from toponav.evaluation.bench_moved import bench_moved

        output, default = Output(self.json), preset("default")
        configs = {
            "clearing": default,
            "keeping": with_overrides(default, {"map.clearing": "null"}),
        }
        figures = bench_moved(
            configs,
            self.houses,
            image_size(self.camera),
            lambda house, outcome: output.say(f"{house}: {outcome}"),
        )
        shares = [
            f"{name}: found at the new place {100 * figures[name]['success']:.1f} %, stale voxels "
            f"{100 * figures[name]['stale_share']:.1f} % of {figures[name]['seen_again']}"
            for name in configs
        ]
        output.result(f"{figures['houses']} houses; " + "; ".join(shares), figures)


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
class DetectorCommand:
    """Precision and recall of a detector by class and distance, its clouds, its time."""

    detector: Annotated[str, tyro.conf.Positional, tyro.conf.arg(metavar="DETECTOR")]
    """A detector that sees pixels, such as onnx:MODEL.onnx."""

    scenes: Annotated[str, tyro.conf.Positional, tyro.conf.arg(metavar="SOURCE")] = "generated:0-4"
    """Scenes whose truth is known: a folder of houses or generated:FIRST-LAST."""

    classes: str | None = None
    """What the detector is asked for, with commas between; by default COCO's classes that houses
    hold."""

    camera: str = "640x480"
    """Image size, WIDTHxHEIGHT."""

    frames: int = 20
    """Images from random places of each scene."""

    seed: int = 0
    """Of the places."""

    json: JsonFlag = False
    """Print the figures as one JSON object on stdout."""

    def run(self) -> None:
        """Examine and print."""
        from toponav.categories import canonical
        from toponav.cli.console import Output
        from toponav.cli.options import image_size
        from toponav.evaluation.bench_detector import COCO_FURNISHING, DetectorBench
        from toponav.perception import DetectorContext, PerceptionConfig, make_detector
        from toponav.scenes.loading import list_scenes, load_scene

        if self.frames < 1:
            raise InputError(f"--frames takes a positive number, not {self.frames}")
        detector = make_detector(self.detector, DetectorContext(PerceptionConfig()))
        classes = COCO_FURNISHING if self.classes is None else tuple(self.classes.split(","))
        bench = DetectorBench(detector, tuple(canonical(name) for name in classes))
        for number, spec in enumerate(list_scenes(self.scenes)):
            size = image_size(self.camera)
            bench.examine(load_scene(spec), size, self.frames, self.seed + number)
        figures = bench.figures()
        Output(self.json).result(_detector_table(figures), figures)


def _detector_table(figures: dict[str, Any]) -> str:
    lines = [f"{'':18} objects  recall  precision  false"]
    for name, row in (*figures["by_distance"].items(), *figures["by_class"].items()):
        recall, precision = (_share(row[key]) for key in ("recall", "precision"))
        lines.append(
            f"{name:18} {row['objects']:7d}  {recall:>6}  {precision:>9}  {row['false']:5d}"
        )
    for name, row in figures["by_score"].items():
        precision = _share(row["precision"])
        lines.append(f"{name:18} {'':7}  {'':6}  {precision:>9}  {row['false']:5d}")
    if figures["centroid_m"] is not None:
        lines.append(
            f"clouds of found objects: centroid {figures['centroid_m']:.3f} m off, "
            f"IoU {figures['cloud_iou']:.2f} (medians)"
        )
    lines.append(f"{figures['detect_ms']:.0f} ms an image over {figures['frames']} images")
    return "\n".join(lines)


def _share(value: float | None) -> str:
    return "-" if value is None else f"{value:.2f}"


@dataclass(frozen=True)
class Bench:
    """Print performance figures, each with the command that measures it."""

    command: (
        Annotated[Map, tyro.conf.subcommand("map")]
        | Annotated[Decide, tyro.conf.subcommand("decide")]
        | Annotated[Memory, tyro.conf.subcommand("memory")]
        | Annotated[MovedThings, tyro.conf.subcommand("moved")]
        | Annotated[Sim, tyro.conf.subcommand("sim")]
        | Annotated[Scale, tyro.conf.subcommand("scale")]
        | Annotated[Habitat, tyro.conf.subcommand("habitat")]
        | Annotated[DetectorCommand, tyro.conf.subcommand("detector")]
        | Annotated[HabitatLab, tyro.conf.subcommand("habitat-lab")]
        | Annotated[RobotBench, tyro.conf.subcommand("robot")]
        | Annotated[FaultBench, tyro.conf.subcommand("faults")]
    )

    def run(self) -> None:
        """Run the chosen subcommand."""
        self.command.run()
