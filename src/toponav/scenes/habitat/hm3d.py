"""HM3D scenes: `X.basis.glb` or `X.glb`, with `X.semantic.glb` and `X.semantic.txt` beside it.

The semantic mesh says by its colours which object is where: colours of vertices in the first
release of the annotations, of a texture in later ones. This project's own exports are of the same
kind.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from toponav.errors import SceneError
from toponav.scenes.gltf import load_mesh
from toponav.scenes.habitat.annotated_mesh import (
    annotated_scene,
    load_stage,
    objects_of_faces,
    stage_up_axis,
)
from toponav.scenes.habitat.hm3d_categories import hm3d_category
from toponav.scenes.habitat.layout import stage_name
from toponav.scenes.habitat.semantic_colors import nearest_objects, srgb_from_linear
from toponav.scenes.habitat.semantic_text import SemanticObject, read_semantic_text
from toponav.scenes.habitat.semantic_transfer import SurfacePoints, spread_points
from toponav.scenes.mesh import Scene, SceneMesh
from toponav.types import Instance

SEMANTIC_MESH, SEMANTIC_TEXT = ".semantic.glb", ".semantic.txt"


def is_hm3d_stage(path: Path) -> bool:
    """Whether a `.glb` is a stage with HM3D's annotations beside it."""
    return (
        path.suffix.lower() == ".glb"
        and not path.name.endswith(SEMANTIC_MESH)
        and beside(path, SEMANTIC_TEXT).is_file()
    )


def beside(stage: Path, suffix: str) -> Path:
    """The annotation file of a stage."""
    return stage.with_name(stage_name(stage) + suffix)


def load_hm3d_scene(stage: Path) -> Scene:
    """Load a stage and its annotations.

    Raises:
        SceneError: One line: a file is missing or damaged, or none of the mesh's colours is that
            of an object.
    """
    for path in (stage, beside(stage, SEMANTIC_MESH), beside(stage, SEMANTIC_TEXT)):
        if not path.is_file():
            raise SceneError(
                f"{path}: no such file; HM3D's annotations lie beside {stage.name}, and the "
                "downloads hm3d_semantics_v0.1 and hm3d_semantics_v0.2 bring them"
            )
    text, labelled_file = beside(stage, SEMANTIC_TEXT), beside(stage, SEMANTIC_MESH)
    objects = read_semantic_text(text)
    labelled = load_mesh(labelled_file, up=stage_up_axis(stage))
    points = spread_points(labelled.vertices[labelled.faces])
    labels = _labels(labelled, points, objects)
    if not (labels >= 0).any():
        raise SceneError(f"{labelled_file}: has none of the colours that {text.name} names")
    mesh = load_stage(stage)
    instances = {
        item.id: Instance(item.id, f"{item.category}_{item.id}", hm3d_category(item.category))
        for item in objects
    }
    owner = objects_of_faces(mesh, labelled, points, labels)
    return annotated_scene(stage, mesh, owner, instances)


def _labels(
    mesh: SceneMesh, points: SurfacePoints, objects: Sequence[SemanticObject]
) -> NDArray[np.int64]:
    """(P,) semantic ids of points on a semantic mesh, -1 for none."""
    known = np.array([item.color for item in objects], dtype=np.uint8).reshape(-1, 3)
    index = nearest_objects(_colors(mesh, points), known)
    ids = np.array([item.id for item in objects] + [-1], dtype=np.int64)
    return ids[index]


def _colors(mesh: SceneMesh, points: SurfacePoints) -> NDArray[np.uint8]:
    """(P, 3) sRGB: of the texture where there is one, else of the vertices."""
    colors = np.full((len(points.face), 3), 255, np.uint8)
    if mesh.corner_colors is not None:
        # A triangle lies between objects where its corners disagree: the nearest corner decides.
        corner = np.argmax(points.weights, axis=1)
        colors = srgb_from_linear(mesh.corner_colors[points.face, corner])
    uv = points.interpolate(mesh.face_uv)
    material = mesh.face_material[points.face]
    for number, surface in enumerate(mesh.materials):
        height, width = surface.texture.shape[:2]
        if height == width == 1:
            continue
        here = np.flatnonzero(material == number)
        # Row 0 of a texture is v = 1.
        column = np.floor(uv[here, 0] % 1.0 * width).astype(np.int64).clip(0, width - 1)
        row = np.floor((1.0 - uv[here, 1] % 1.0) * height).astype(np.int64).clip(0, height - 1)
        colors[here] = surface.texture[row, column]
    return colors
