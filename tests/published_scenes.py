"""Scenes in the exact formats in which HM3D and MP3D are published, made from a house."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import trimesh
from PIL import Image
from trimesh.visual import TextureVisuals
from trimesh.visual.material import PBRMaterial

from toponav.scenes.habitat.glb import colored_triangles_glb
from toponav.scenes.habitat.semantic_colors import palette
from toponav.scenes.mesh import Scene

TEXELS = 16


def write_hm3d(stage: Path, scene: Scene, *, textured: bool = True) -> Path:
    """`X.basis.glb`, `X.semantic.glb` and `X.semantic.txt`, z up.

    The annotations are those of a texture (as in HM3D-Semantics v0.2) or of vertices (v0.1).
    """
    name = stage.name.split(".")[0]
    stage.parent.mkdir(parents=True, exist_ok=True)
    mesh = scene.mesh
    corners = mesh.vertices[mesh.faces]
    linear, srgb = palette(len(mesh.instances))
    look = np.random.default_rng(0).integers(60, 220, (len(mesh.instances), 3), dtype=np.uint8)
    content = _textured_glb(corners, mesh.face_instance, look)
    stage.write_bytes(content)
    if textured:
        labelled = _textured_glb(corners, mesh.face_instance, srgb)
    else:
        labelled = colored_triangles_glb(corners, linear[mesh.face_instance])
    stage.with_name(f"{name}.semantic.glb").write_bytes(labelled)
    lines = ["HM3D Semantic Annotations"]
    for instance, (r, g, b) in zip(mesh.instances, srgb, strict=True):
        lines.append(f'{instance.id + 1},{r:02X}{g:02X}{b:02X},"{_raw(instance.category)}",0')
    stage.with_name(f"{name}.semantic.txt").write_text("\n".join(lines) + "\n")
    return stage


def write_mp3d(stage: Path, scene: Scene) -> Path:
    """`X.glb`, `X.house` and `X_semantic.ply`, z up."""
    stage.parent.mkdir(parents=True, exist_ok=True)
    mesh = scene.mesh
    corners = mesh.vertices[mesh.faces]
    look = np.random.default_rng(0).integers(60, 220, (len(mesh.instances), 3), dtype=np.uint8)
    stage.write_bytes(_textured_glb(corners, mesh.face_instance, look))
    stage.with_name(f"{stage.stem}_semantic.ply").write_bytes(
        _semantic_ply(corners, mesh.face_instance)
    )
    names = sorted({instance.category for instance in mesh.instances})
    zeros = " ".join(["0"] * 11)
    lines = ["ASCII 1.1", f"H {stage.stem} label {zeros} {zeros}", f"L 0 1 label 0 0 0 {zeros}"]
    lines += [
        f"C {k} {k} {_raw(name).replace(' ', '#')} {k} {_mpcat40(name)} 0 0 0 0 0"
        for k, name in enumerate(names)
    ]
    lines += [
        f"O {instance.id} 0 {names.index(instance.category)} 0 0 0 1 0 0 0 1 0 1 1 1 {zeros}"
        for instance in mesh.instances
    ]
    stage.with_suffix(".house").write_text("\n".join(lines) + "\n")
    return stage


def _raw(category: str) -> str:
    """What an annotator might have written."""
    return {"sofa": "couch", "chair": "armchair", "tv_monitor": "tv"}.get(
        category, category.replace("_", " ")
    )


def _mpcat40(category: str) -> str:
    known = {"bed", "chair", "sofa", "plant", "toilet", "tv_monitor", "wall", "floor", "ceiling",
             "door", "table", "sink", "cabinet"}  # fmt: skip
    return category if category in known else "objects"


def _textured_glb(corners: np.ndarray, part: np.ndarray, colors: np.ndarray) -> bytes:
    """Triangles whose uv point into an image with a block of colour for each part."""
    side = int(np.ceil(np.sqrt(len(colors))))
    image = np.zeros((side * TEXELS, side * TEXELS, 3), np.uint8)
    for k, color in enumerate(colors):
        row, column = divmod(k, side)
        image[row * TEXELS :, column * TEXELS :][:TEXELS, :TEXELS] = color
    row, column = np.divmod(part, side)
    uv = np.stack([(column + 0.5) / side, 1.0 - (row + 0.5) / side], axis=-1)
    material = PBRMaterial(name="atlas", baseColorTexture=Image.fromarray(image))
    visual = TextureVisuals(uv=np.repeat(uv, 3, axis=0), material=material)
    mesh = trimesh.Trimesh(
        corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3), visual=visual,
        process=False,
    )  # fmt: skip
    content: bytes = trimesh.Scene(mesh).export(file_type="glb")
    return content


def _semantic_ply(corners: np.ndarray, owner: np.ndarray) -> bytes:
    """Binary PLY with an `object_id` a triangle."""
    vertices = np.zeros(
        3 * len(corners),
        np.dtype([("p", "<f4", 3), ("n", "<f4", 3), ("c", "u1", 3)]),
    )
    vertices["p"] = corners.reshape(-1, 3)
    faces = np.zeros(len(corners), np.dtype([("k", "u1"), ("v", "<i4", 3), ("id", "<i4")]))
    faces["k"] = 3
    faces["v"] = np.arange(3 * len(corners)).reshape(-1, 3)
    faces["id"] = owner
    header = [
        "ply", "format binary_little_endian 1.0", f"element vertex {len(vertices)}",
        *(f"property float {name}" for name in ("x", "y", "z", "nx", "ny", "nz")),
        *(f"property uchar {name}" for name in ("red", "green", "blue")),
        f"element face {len(faces)}", "property list uchar int vertex_indices",
        "property int object_id", "end_header",
    ]  # fmt: skip
    return ("\n".join(header) + "\n").encode() + vertices.tobytes() + faces.tobytes()
