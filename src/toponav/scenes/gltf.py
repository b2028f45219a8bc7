"""Mesh scenes: glTF, PLY and OBJ files whose parts are walls, floors and objects.

A part (a node of the file) is an object when its glTF `extras.category`, or that of a node above
it, says so, or when a label table matches its name. A part called after a piece of structure
("HouseWall_01") is structure; any other is an instance of category "unknown".
"""

from __future__ import annotations

import io
import re
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
import trimesh
from numpy.typing import NDArray

from toponav.categories import canonical
from toponav.errors import SceneError
from toponav.geometry.conventions import WORLD_FROM_HABITAT
from toponav.scenes.basis_textures import uses_basis, without_basis
from toponav.scenes.label_table import LabelTable, load_label_table
from toponav.scenes.mesh import Scene, SceneMesh
from toponav.scenes.mesh_floors import detect_up_axis, find_floors
from toponav.scenes.mesh_materials import MaterialTable, SurfaceAppearance
from toponav.types import STRUCTURE_CATEGORIES, Instance

MESH_SUFFIXES = (".glb", ".gltf", ".ply", ".obj")
"""Files that hold mesh scenes."""

UNKNOWN = "unknown"
"""Category of a part that nothing names."""

FORMAT_UP_AXIS = {".glb": "y", ".gltf": "y", ".obj": "y", ".ply": "z"}
"""By specification (glTF) or custom; the geometry may speak against it."""

_WORD = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+")

UpAxis = Literal["y", "z"]


@dataclass(frozen=True, eq=False)
class _Part:
    """A mesh of a file, placed.

    Attributes:
        name: The object that it belongs to; several parts may share it.
        category: The object's category.
        vertices: (V, 3) metres, in the file's axes.
        faces: (F, 3) indices into `vertices`.
        appearance: Of its faces.
    """

    name: str
    category: str
    vertices: NDArray[np.float64]
    faces: NDArray[np.int64]
    appearance: SurfaceAppearance


def load_mesh_scene(
    path: Path | str, labels: Path | str | None = None, up: UpAxis | None = None
) -> Scene:
    """Load a mesh file as a scene.

    Args:
        path: A `.glb`, `.gltf`, `.ply` or `.obj` file, in metres.
        labels: A label table (see `label_table`).
        up: The file's up axis; None finds it from the geometry.

    Raises:
        SceneError: One line: the file is damaged, has no triangles or no floor, ...
    """
    path = Path(path)
    mesh = load_mesh(path, labels, up)
    try:
        floors = find_floors(mesh.vertices[mesh.faces])
    except SceneError as error:
        raise SceneError(f"{path}: {error}") from None
    return Scene(name=path.stem, mesh=mesh, floors=floors)


def load_mesh(
    path: Path | str, labels: Path | str | None = None, up: UpAxis | None = None
) -> SceneMesh:
    """Load a mesh file, z up, whether or not anybody can stand in it.

    Raises:
        SceneError: One line: the file is damaged or has no triangles.
    """
    path = Path(path)
    table = load_label_table(labels) if labels is not None else LabelTable()
    materials = MaterialTable()
    file = _read(path)
    try:
        mesh = _merge(_parts(file, table, materials), materials)
        axis = up or detect_up_axis(mesh.vertices[mesh.faces], FORMAT_UP_AXIS[path.suffix.lower()])
    except SceneError as error:
        raise SceneError(f"{path}: {error}") from None
    if axis == "y":
        mesh = replace(mesh, vertices=WORLD_FROM_HABITAT.apply(mesh.vertices))
    return mesh


def _read(path: Path) -> trimesh.Scene:
    if path.suffix.lower() not in MESH_SUFFIXES:
        raise SceneError(f"{path}: not a mesh; meshes are {', '.join(MESH_SUFFIXES)} files")
    if not path.is_file():
        raise SceneError(f"{path}: no such file")
    compressed = path.suffix.lower() == ".glb" and uses_basis(path)
    file = io.BytesIO(without_basis(path)) if compressed else path
    try:
        return trimesh.load_scene(file, file_type=path.suffix.lower()[1:], process=False)
    except Exception as error:
        # The readers of damaged files fail in as many ways as files can be damaged.
        reason = " ".join(str(error).split()) or type(error).__name__
        raise SceneError(f"{path}: damaged or incomplete: {reason}") from error


def _parts(scene: trimesh.Scene, table: LabelTable, materials: MaterialTable) -> list[_Part]:
    """The placed triangle meshes, by name of their object."""
    graph = scene.graph
    parts = []
    for node in graph.nodes_geometry:
        transform, geometry_name = graph[node]
        geometry = scene.geometry[geometry_name]
        if not isinstance(geometry, trimesh.Trimesh) or not len(geometry.faces):
            continue
        faces = np.asarray(geometry.faces, np.int64)
        if not np.isfinite(geometry.vertices).all():
            raise SceneError(f"part {node!r} has vertices that are NaN or infinite")
        if faces.min() < 0 or faces.max() >= len(geometry.vertices):
            raise SceneError(f"part {node!r} has faces without vertices")
        name, category = _identity(graph, node, geometry, table)
        mirrored = bool(np.linalg.det(transform[:3, :3]) < 0.0)
        parts.append(
            _Part(
                name,
                category,
                np.asarray(trimesh.transform_points(geometry.vertices, transform), np.float64),
                # A mirroring transformation turns faces inside out.
                faces[:, ::-1] if mirrored else faces,
                materials.appearance(geometry, mirrored),
            )
        )
    if not parts:
        raise SceneError("holds no triangles")
    return sorted(parts, key=lambda part: part.name)


def _identity(
    graph: Any, node: str, geometry: trimesh.Trimesh, table: LabelTable
) -> tuple[str, str]:
    """The name and category of the object that a node belongs to."""
    lineage = _lineage(graph, node)
    if geometry.metadata.get("from_gltf_primitive"):
        # Materials split a glTF mesh into primitives, which the reader names at random.
        lineage = lineage[1:]
    for name, extras in lineage:
        if isinstance(extras.get("category"), str):
            return name, canonical(extras["category"])
    names = [name for name, _ in lineage]
    for name in (*names, str(geometry.metadata.get("name", ""))):
        category = table.category(name)
        if category is not None:
            return name if name in names else names[0], category
    for name in names:
        category = structure_category(name)
        if category is not None:
            return names[0], category
    return names[0], UNKNOWN


def _lineage(graph: Any, node: str) -> list[tuple[str, dict[str, Any]]]:
    """(name, extras) of a node and of those above it, the nearest first, without the root."""
    parents, edges = graph.transforms.parents, graph.transforms.edge_data
    lineage = []
    while node in parents:
        lineage.append((node, edges[parents[node], node].get("metadata") or {}))
        node = parents[node]
    return lineage


def structure_category(name: str) -> str | None:
    """The structure that the last word of a part's name tells of: HouseWallB_01 is a wall."""
    words = [word.lower() for word in _WORD.findall(name) if len(word) > 1]
    last = canonical(words[-1]) if words else ""
    return last if last in STRUCTURE_CATEGORIES else None


def _merge(parts: list[_Part], materials: MaterialTable) -> SceneMesh:
    instances: dict[str, Instance] = {}
    for part in parts:
        instances.setdefault(part.name, Instance(len(instances), part.name, part.category))
    starts = np.cumsum([0, *(len(part.vertices) for part in parts)])
    counts = [len(part.faces) for part in parts]
    colors = None
    if any(part.appearance.corner_colors is not None for part in parts):
        colors = np.concatenate([part.appearance.colors_or_white(part.faces) for part in parts])
    return SceneMesh(
        vertices=np.concatenate([part.vertices for part in parts]),
        faces=np.concatenate(
            [part.faces + start for part, start in zip(parts, starts[:-1], strict=True)]
        ).astype(np.int32),
        face_uv=np.concatenate([part.appearance.face_uv for part in parts]),
        face_material=np.repeat([part.appearance.material for part in parts], counts).astype(
            np.int32
        ),
        face_instance=np.repeat([instances[part.name].id for part in parts], counts).astype(
            np.int32
        ),
        materials=materials.materials(),
        instances=tuple(instances.values()),
        corner_colors=colors,
    )
