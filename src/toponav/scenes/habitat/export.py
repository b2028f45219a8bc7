"""A scene as Habitat loads it: `.glb`, `.semantic.glb`, `.semantic.txt`, laid out as HM3D is.

Files are y up, as glTF specifies; `scene_dataset_config` says so to Habitat, which takes a bare
`.glb` to be z up. An object's id for Habitat is that of its instance plus one: 0 means no object.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path, PurePosixPath

import numpy as np
from numpy.typing import NDArray
from shapely.geometry import Point, Polygon

from toponav.categories import readable
from toponav.files import write_atomic
from toponav.geometry.conventions import HABITAT_FROM_WORLD
from toponav.scenes.export import scene_to_glb
from toponav.scenes.habitat.glb import colored_triangles_glb
from toponav.scenes.habitat.semantic_colors import palette
from toponav.scenes.habitat.semantic_text import SemanticObject, semantic_text
from toponav.scenes.mesh import Scene, SceneMesh

FIRST_ID = 1
"""Habitat's semantic id of instance 0."""


def write_habitat_scene(scene: Scene, folder: Path, name: str) -> Path:
    """Write the files of one scene; older ones are replaced.

    Args:
        scene: What to write.
        folder: Gets `<name>.glb`, `<name>.semantic.glb` and `<name>.semantic.txt`.
        name: Of the files.

    Returns:
        The `.glb`.

    Raises:
        OSError: The folder cannot be written.
    """
    linear, srgb = palette(len(scene.mesh.instances))
    regions = _regions(scene)
    objects = [
        SemanticObject(
            id=instance.id + FIRST_ID,
            color=(int(red), int(green), int(blue)),
            category=readable(instance.category),
            region=region,
        )
        for instance, (red, green, blue), region in zip(
            scene.mesh.instances, srgb, regions, strict=True
        )
    ]
    vertices = HABITAT_FROM_WORLD.apply(scene.mesh.vertices)
    semantic = colored_triangles_glb(vertices[scene.mesh.faces], linear[scene.mesh.face_instance])
    glb = folder / f"{name}.glb"
    write_atomic(glb, scene_to_glb(scene))
    write_atomic(folder / f"{name}.semantic.glb", semantic)
    write_atomic(folder / f"{name}.semantic.txt", semantic_text(objects))
    return glb


def as_stored(scene: Scene) -> Scene:
    """The scene as its file holds it, with vertices in single precision.

    A micrometre may decide whether a cell of the navigable surface is free, so what goes with the
    file (navmesh, starts, viewpoints) has to be found on this.
    """
    vertices = scene.mesh.vertices.astype(np.float32).astype(np.float64)
    return replace(scene, mesh=replace(scene.mesh, vertices=vertices))


def scene_dataset_config(scenes: Sequence[PurePosixPath]) -> str:
    """The `.scene_dataset_config.json` of a dataset, for the scenes' `.glb` files beside it."""
    content = {
        "stages": {
            "default_attributes": {
                "shader_type": "flat",
                "up": [0, 1, 0],
                "front": [0, 0, -1],
                "semantic_up": [0, 1, 0],
                "semantic_front": [0, 0, -1],
                "origin": [0, 0, 0],
                "semantic_descriptor_filename": "%%CONFIG_NAME_AS_ASSET_FILENAME%%.semantic.txt",
                "semantic_asset": "%%CONFIG_NAME_AS_ASSET_FILENAME%%.semantic.glb",
                "has_semantic_textures": False,
            },
            "paths": {".glb": [str(scene) for scene in scenes]},
        },
        "scene_instances": {
            "default_attributes": {"default_lighting": "no_lights"},
            "paths": {".json": []},
        },
    }
    return json.dumps(content, indent=2) + "\n"


def _regions(scene: Scene) -> list[int]:
    """The number of the room in which each instance's middle lies; their number outside of all."""
    rooms = [
        (Polygon(polygon), scene.floors[level] if level < len(scene.floors) else 0.0)
        for _, level, polygon in scene.room_types
    ]
    regions = []
    for middle in _middles(scene.mesh):
        here = [
            (abs(middle[2] - floor), number)
            for number, (polygon, floor) in enumerate(rooms)
            if polygon.contains(Point(middle[:2])) and middle[2] >= floor - 0.5
        ]
        regions.append(min(here)[1] if here else len(rooms))
    return regions


def _middles(mesh: SceneMesh) -> NDArray[np.float64]:
    """(N, 3) the mean of each instance's corners; the origin for one without triangles."""
    count = len(mesh.instances)
    centres = mesh.vertices[mesh.faces].mean(axis=1)
    weight = np.maximum(np.bincount(mesh.face_instance, minlength=count), 1)
    sums = [np.bincount(mesh.face_instance, centres[:, k], minlength=count) for k in range(3)]
    middles: NDArray[np.float64] = np.stack(sums, axis=-1) / weight[:, None]
    return middles
