"""`toponav scenes`: generate houses, tell about scenes, export them."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

import tyro

from toponav.cli.options import JsonFlag


@dataclass(frozen=True)
class Generate:
    """Write generated houses as house files."""

    spec: Annotated[str, tyro.conf.Positional, tyro.conf.arg(metavar="SPEC")] = "generated:0"
    """generated:SEED or generated:FIRST-LAST, with options as in generated:7?rooms=8&levels=2."""

    out: Path = Path("runs/scenes")
    """Folder for the files."""

    furniture: Path | None = None
    """A furniture catalogue (.sh3f) of Sweet Home 3D, or a folder of them: objects get its models
    where one suits, the drawn shapes elsewhere."""

    json: JsonFlag = False
    """Print the files' names as one JSON object on stdout."""

    def run(self) -> None:
        """Generate and save."""
        from toponav.cli.console import Output
        from toponav.cli.options import fresh_folder
        from toponav.scenes.catalog_furnishing import FurnitureLibrary
        from toponav.scenes.house_io import save_house
        from toponav.scenes.loading import list_scenes, load_house_spec
        from toponav.scenes.sweet_home import read_catalogs

        output = Output(self.json)
        specs = list_scenes(self.spec)
        pieces = [] if self.furniture is None else read_catalogs(self.furniture)
        folder = fresh_folder(self.out)
        library = FurnitureLibrary(pieces, folder)
        files = []
        for spec in specs:
            house = library.furnish(load_house_spec(spec))
            path = folder / f"{house.name}.json"
            save_house(house, path)
            files.append(str(path))
            output.say(str(path))
        output.result(f"{len(files)} houses in {folder}", {"files": files})


@dataclass(frozen=True)
class Info:
    """Tell what a scene holds: size, floors, objects, episodes, targets that can be reached."""

    scene: Annotated[str, tyro.conf.Positional, tyro.conf.arg(metavar="SCENE")]
    """House, mesh scene or generated:SEED."""

    labels: Path | None = None
    """Label table of a mesh scene."""

    json: JsonFlag = False
    """Print it as one JSON object on stdout."""

    def run(self) -> None:
        """Load and describe."""
        from toponav.cli.console import Output
        from toponav.evaluation.scene_info import scene_info
        from toponav.scenes.loading import load_scene

        info = scene_info(load_scene(self.scene, self.labels))
        Output(self.json).result(_described(info), info)


def _described(info: dict[str, Any]) -> str:
    objects = ", ".join(f"{count} {name}" for name, count in info["objects"].items())
    floors = ", ".join(f"{z:.2f}" for z in info["floors"])
    return "\n".join(
        [
            f"{info['name']}: {info['triangles']} triangles, floors at z = {floors} m",
            f"  rooms: {', '.join(info['rooms']) or 'unknown'}",
            f"  objects: {objects or 'none'}",
            f"  navigable: {info['navigable_m2']:.1f} m2",
            f"  targets: {', '.join(info['targets']) or 'none'}",
            f"  episodes: {len(info['episodes'])}",
        ]
    )


@dataclass(frozen=True)
class Export:
    """Write houses or scenes for other tools.

    House JSON, glTF with categories, or a dataset that Habitat runs.
    """

    scene: Annotated[str, tyro.conf.Positional, tyro.conf.arg(metavar="SCENE")]
    """House, mesh scene or generated:SEED; with --format habitat also several: a folder of them or
    generated:FIRST-LAST."""

    out: Annotated[Path, tyro.conf.Positional, tyro.conf.arg(metavar="OUT")]
    """A .json (houses only) or .glb file; with --format habitat Habitat's data folder."""

    format: Literal["json", "gltf", "habitat"] | None = None
    """By default what the suffix of OUT names."""

    labels: Path | None = None
    """Label table of a mesh scene."""

    name: str = "toponav"
    """Name of a Habitat dataset."""

    split: str = "val"
    """Split of a Habitat dataset's episodes."""

    episodes: int | None = None
    """Episodes of each scene of a Habitat dataset; by default those that it brings."""

    seed: int = 0
    """Seed of the episodes that are drawn."""

    json: JsonFlag = False
    """Print the files' names as one JSON object on stdout."""

    def run(self) -> None:
        """Load and write."""
        from toponav.cli.console import Output
        from toponav.scenes.export import export_house
        from toponav.scenes.loading import load_house_spec, load_scene

        if self.format == "habitat":
            self._export_dataset()
            return
        path = self.out
        if self.format is not None:
            path = path.with_suffix({"json": ".json", "gltf": ".glb"}[self.format])
        if path.suffix.lower() == ".json":
            export_house(load_house_spec(self.scene), path)
        else:
            export_house(load_scene(self.scene, self.labels), path)
        Output(self.json).result(f"wrote {path}", {"file": str(path)})

    def _export_dataset(self) -> None:
        from toponav.cli.console import Output
        from toponav.cli.options import fresh_folder
        from toponav.evaluation.objectnav_export import DatasetPlan, export_dataset
        from toponav.scenes.loading import list_scenes, load_scene

        output = Output(self.json)
        folder = fresh_folder(self.out)
        plan = DatasetPlan(folder, self.name, self.split, self.episodes, self.seed)
        specs = list_scenes(self.scene)
        files = export_dataset((load_scene(spec, self.labels) for spec in specs), plan)
        output.result(
            f"{len(specs)} scenes and their episodes; toponav eval {files[-1]} --data {folder}",
            {"files": [str(path) for path in files], "episodes": str(files[-1])},
        )


@dataclass(frozen=True)
class Scenes:
    """Generate, describe and export scenes."""

    command: (
        Annotated[Generate, tyro.conf.subcommand("generate")]
        | Annotated[Info, tyro.conf.subcommand("info")]
        | Annotated[Export, tyro.conf.subcommand("export")]
    )

    def run(self) -> None:
        """Run the chosen subcommand."""
        self.command.run()
