"""Mesh files that objects of a house bring with them, fitted to the object's size."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from toponav.errors import SceneError
from toponav.scenes.gltf import FORMAT_UP_AXIS, load_mesh
from toponav.scenes.mesh import SceneMesh


def load_object_mesh(path: Path, object_id: str) -> SceneMesh:
    """Read the mesh of an object, z up, as large as the file says.

    Formats that are y up by specification are turned so that their front, +z, faces -y here.

    Args:
        path: A `.glb`, `.gltf`, `.ply` or `.obj` file.
        object_id: Whose mesh it is, for messages.

    Raises:
        SceneError: One line: the file is missing, of another kind, damaged or empty.
    """
    try:
        # A scene's up axis is where its floor is; an object may have no level side at all.
        return load_mesh(path, up="y" if FORMAT_UP_AXIS.get(path.suffix.lower()) == "y" else "z")
    except SceneError as error:
        raise SceneError(f"object {object_id!r}: its mesh {error}") from None


def fitted(mesh: SceneMesh, size: tuple[float, float, float]) -> SceneMesh:
    """The mesh stretched to a size, the centre of its base at the origin."""
    used = mesh.vertices[mesh.faces].reshape(-1, 3)
    low, high = used.min(axis=0), used.max(axis=0)
    extents = high - low
    base_center = np.array([*(low + high)[:2] / 2.0, low[2]])
    scale = np.asarray(size) / np.where(extents > 0.0, extents, 1.0)
    return replace(mesh, vertices=(mesh.vertices - base_center) * scale)
