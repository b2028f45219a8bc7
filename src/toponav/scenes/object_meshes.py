"""Objects that bring a mesh file of their own."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from toponav.errors import SceneError
from toponav.scenes.gltf import load_mesh
from toponav.scenes.house import HouseObject
from toponav.scenes.mesh import SceneMesh


def load_object_mesh(item: HouseObject, base_dir: Path) -> SceneMesh:
    """The mesh of an object, scaled to its size, its base's centre at the origin, z up.

    Raises:
        SceneError: The file is missing or cannot be read.
    """
    assert item.mesh is not None
    path = base_dir / item.mesh
    if not path.is_file():
        raise SceneError(f"object {item.id}: its mesh {path} does not exist")
    mesh = load_mesh(path)
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    center = np.array([*(0.5 * (low + high))[:2], low[2]])
    scale = np.asarray(item.size) / np.maximum(high - low, 1e-9)
    return replace(mesh, vertices=(mesh.vertices - center) * scale)
