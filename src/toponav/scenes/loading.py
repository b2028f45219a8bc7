"""From what a user types to a scene: house files, room graphs, meshes and generator specs.

HOUSE is one of these, told apart by suffix and content:

    house.json            the house format, or a ProcTHOR house
    home.yaml             a DomestiGraph room graph
    scene.glb .gltf .ply .obj
    X.glb beside X.semantic.txt (HM3D, and `scenes export --format habitat`) or X.house (MP3D)
    generated:7           the generator's house of that seed (options: see `generate`)

SOURCE is a HOUSE, a folder of house files, room graphs and meshes, or a range `generated:0-24`.
"""

from __future__ import annotations

import json
from enum import Enum
from pathlib import Path
from typing import Any

from toponav.errors import SceneError
from toponav.scenes.domestigraph import import_domestigraph
from toponav.scenes.generate import generate_house, house_name, parse_generator_spec
from toponav.scenes.gltf import MESH_SUFFIXES, load_mesh_scene
from toponav.scenes.habitat.hm3d import SEMANTIC_MESH as HM3D_LABELLED
from toponav.scenes.habitat.hm3d import is_hm3d_stage, load_hm3d_scene
from toponav.scenes.habitat.layout import stage_name
from toponav.scenes.habitat.mp3d import SEMANTIC_MESH as MP3D_LABELLED
from toponav.scenes.habitat.mp3d import is_mp3d_stage, load_mp3d_scene
from toponav.scenes.house import House
from toponav.scenes.house_io import load_house, read_text
from toponav.scenes.mesh import Scene
from toponav.scenes.meshing import build_scene
from toponav.scenes.procthor import import_procthor

GENERATOR_SCHEME = "generated:"
"""What the spec of a generated house begins with."""

LABELLED = (HM3D_LABELLED, MP3D_LABELLED)
"""How the names of labelled meshes end, which are parts of the scenes beside them."""

GRAPH_SUFFIXES = (".yaml", ".yml")
"""Files that hold room graphs."""


class SceneKind(Enum):
    """What a HOUSE is."""

    HOUSE = "house file"
    PROCTHOR = "ProcTHOR house"
    DOMESTIGRAPH = "room graph"
    MESH = "mesh scene"
    HM3D = "scene with HM3D's annotations"
    MP3D = "scene with MP3D's annotations"
    GENERATED = "generated house"


ANNOTATED = frozenset({SceneKind.HM3D, SceneKind.MP3D})
"""Meshes with annotations; a label table takes their place."""


def load_scene(spec: str, labels: Path | None = None) -> Scene:
    """Load what a simulator runs in.

    Args:
        spec: A HOUSE as above.
        labels: The label table of a mesh scene; other scenes know their categories.

    Raises:
        SceneError: One line with the file and what is wrong.
    """
    kind = scene_kind(spec)
    if kind is SceneKind.MESH or (kind in ANNOTATED and labels is not None):
        return load_mesh_scene(Path(spec), labels)
    if kind is SceneKind.HM3D:
        return load_hm3d_scene(Path(spec))
    if kind is SceneKind.MP3D:
        return load_mp3d_scene(Path(spec))
    if labels is not None:
        raise SceneError(f"{spec}: a label table names the parts of a mesh; this is a {kind.value}")
    base_dir = None if kind is SceneKind.GENERATED else Path(spec).parent
    return build_scene(load_house_spec(spec), base_dir)


def load_house_spec(spec: str) -> House:
    """The house that a spec stands for.

    Raises:
        SceneError: As `load_scene`; also for a mesh, which has no rooms or objects to tell of.
    """
    match scene_kind(spec):
        case SceneKind.HOUSE:
            return load_house(Path(spec))
        case SceneKind.PROCTHOR:
            return import_procthor(Path(spec))
        case SceneKind.DOMESTIGRAPH:
            return import_domestigraph(Path(spec))
        case SceneKind.GENERATED:
            houses = parse_generator_spec(spec)
            if len(houses) != 1:
                raise SceneError(f"{spec}: stands for {len(houses)} houses; give one seed")
            return generate_house(*houses[0])
        case SceneKind.MESH | SceneKind.HM3D | SceneKind.MP3D:
            raise SceneError(f"{spec}: a mesh has no plan of its rooms; give a house")


def scene_outline(spec: str) -> tuple[str, int]:
    """Name of a scene and how many episodes it brings, without building it.

    Raises:
        SceneError: As `load_scene`.
    """
    match scene_kind(spec):
        case SceneKind.GENERATED:
            [(seed, config)] = parse_generator_spec(spec)
            return house_name(seed), config.episodes
        case SceneKind.MESH:
            return Path(spec).stem, 0
        case SceneKind.HM3D | SceneKind.MP3D:
            return stage_name(Path(spec)), 0
        case _:
            house = load_house_spec(spec)
            return house.name, len(house.episodes)


def list_scenes(source: str) -> list[str]:
    """The scenes of a SOURCE, each as a spec for `load_scene`, in a stable order.

    Raises:
        SceneError: The source does not exist or holds no scene.
    """
    if source.startswith(GENERATOR_SCHEME):
        options = source.partition("?")[2]
        suffix = f"?{options}" if options else ""
        return [f"{GENERATOR_SCHEME}{seed}{suffix}" for seed, _ in parse_generator_spec(source)]
    path = Path(source)
    if not path.is_dir():
        scene_kind(source)
        return [source]
    scenes = _scenes_in(path)
    if not scenes:
        raise SceneError(f"{path}: no scene in this folder; scenes are {_known_suffixes()} files")
    return [str(scene) for scene in scenes]


def scene_kind(spec: str) -> SceneKind:
    """What a spec stands for.

    Raises:
        SceneError: No such file, or not a scene.
    """
    if spec.startswith(GENERATOR_SCHEME):
        return SceneKind.GENERATED
    path = Path(spec)
    if path.is_dir():
        raise SceneError(f"{path}: a folder; give one of the scenes in it")
    if not path.exists():
        raise SceneError(f"{path}: no such file; a scene is a file or {GENERATOR_SCHEME}SEED")
    suffix = path.suffix.lower()
    if suffix in MESH_SUFFIXES:
        return _mesh_kind(path)
    if suffix in GRAPH_SUFFIXES:
        return SceneKind.DOMESTIGRAPH
    if suffix == ".json":
        return _json_kind(_json_content(path)) or SceneKind.HOUSE
    raise SceneError(f"{path}: not a scene; scenes are {_known_suffixes()} files")


def _mesh_kind(path: Path) -> SceneKind:
    """Whether annotations lie beside a mesh."""
    if is_hm3d_stage(path):
        return SceneKind.HM3D
    return SceneKind.MP3D if is_mp3d_stage(path) else SceneKind.MESH


def _known_suffixes() -> str:
    return ", ".join((".json", *GRAPH_SUFFIXES, *MESH_SUFFIXES))


def _json_content(path: Path) -> Any:
    """The content of a JSON file; of a broken one an empty object, for the reader to complain."""
    try:
        return json.loads(read_text(path))
    except (json.JSONDecodeError, RecursionError):
        return {}


def _json_kind(content: Any) -> SceneKind | None:
    """What a JSON file holds, or None for neither a house nor a ProcTHOR house."""
    if not isinstance(content, dict):
        return None
    if "format" in content or "levels" in content:
        return SceneKind.HOUSE
    return SceneKind.PROCTHOR if {"rooms", "walls"} <= set(content) else None


def _scenes_in(folder: Path) -> list[Path]:
    """Scenes of a folder by name, without label tables and without the parts of its houses."""
    files = sorted(path for path in folder.iterdir() if path.is_file())
    files = [path for path in files if not path.name.startswith(".")]
    scenes, parts = [], set()
    for path in files:
        suffix = path.suffix.lower()
        if suffix == ".json":
            content = _json_content(path)
            if _json_kind(content) is not None or content == {}:
                scenes.append(path)
            parts |= _mesh_parts(content)
        elif suffix in (*GRAPH_SUFFIXES, *MESH_SUFFIXES) and not path.name.endswith(LABELLED):
            scenes.append(path)
    return [path for path in scenes if path.name not in parts]


def _mesh_parts(content: Any) -> set[str]:
    """File names of the meshes that a house's objects use."""
    try:
        objects = [item for level in content["levels"] for item in level["objects"]]
        return {str(item["mesh"]) for item in objects if item.get("mesh")}
    except (KeyError, TypeError, AttributeError):
        return set()
