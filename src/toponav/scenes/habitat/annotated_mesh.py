"""A stage's mesh with the objects of its annotations as instances, whatever their format."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from toponav.errors import SceneError
from toponav.scenes.gltf import UpAxis, load_mesh
from toponav.scenes.habitat.layout import dataset_config, stage_name
from toponav.scenes.habitat.semantic_transfer import SurfacePoints, transfer_labels
from toponav.scenes.house_io import read_text
from toponav.scenes.mesh import Scene, SceneMesh
from toponav.scenes.mesh_floors import find_floors
from toponav.types import Instance

UNANNOTATED = "unannotated"
"""Name of what belongs to no object."""

UNKNOWN = "unknown"
"""Category of what belongs to no object; never a target."""


def stage_up_axis(stage: Path) -> UpAxis:
    """The up axis that Habitat takes a stage to have: its dataset's, or z.

    Raises:
        SceneError: The dataset's configuration is not JSON.
    """
    config = dataset_config(stage)
    if config is None:
        return "z"
    try:
        content = json.loads(read_text(config))
        up = content["stages"]["default_attributes"]["up"]
        return "y" if up[1] > up[2] else "z"
    except (KeyError, TypeError, IndexError):
        return "z"
    except ValueError as error:
        raise SceneError(f"{config}: not JSON ({error}); fetch it again") from error


def annotated_scene(
    stage: Path, mesh: SceneMesh, face_object: NDArray[np.int64], objects: Mapping[int, Instance]
) -> Scene:
    """The scene of a stage whose triangles' objects are known.

    Instances are numbered as Habitat's semantic sensor does; number 0, where it is no object, and
    every gap stand for what is not annotated.

    Args:
        stage: The `.glb`.
        mesh: Its mesh, z up.
        face_object: (F,) semantic id of each triangle; -1 for none.
        objects: Instances by semantic id.

    Raises:
        SceneError: There is no floor.
    """
    highest = max(objects, default=0)
    gaps = {k: Instance(k, f"{UNANNOTATED} {k}", UNKNOWN) for k in range(highest + 1)}
    instances = [objects.get(k, gaps[k]) for k in range(highest + 1)]
    spare = highest + 1 if 0 in objects else 0
    if spare:
        instances.append(Instance(spare, UNANNOTATED, UNKNOWN))
    owner = np.where(face_object >= 0, face_object, spare).astype(np.int32)
    mesh = replace(mesh, face_instance=owner, instances=tuple(instances), lit=False)
    try:
        floors = find_floors(mesh.vertices[mesh.faces])
    except SceneError as error:
        raise SceneError(f"{stage}: {error}") from None
    return Scene(name=stage_name(stage), mesh=mesh, floors=floors, stage=stage)


def load_stage(stage: Path) -> SceneMesh:
    """The mesh of a `.glb`, z up.

    Raises:
        SceneError: It is damaged or empty, or a texture cannot be decoded.
    """
    return load_mesh(stage, up=stage_up_axis(stage))


def objects_of_faces(
    mesh: SceneMesh, labelled: SceneMesh, points: SurfacePoints, labels: NDArray[np.int64]
) -> NDArray[np.int64]:
    """(F,) the semantic id of each triangle of a stage, by the points of its labelled mesh."""
    return transfer_labels(
        mesh.vertices[mesh.faces], labelled.vertices[labelled.faces], points, labels
    )
