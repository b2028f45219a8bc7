"""Collecting triangles, materials and instances into a `SceneMesh`."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from toponav.categories import canonical
from toponav.scenes.mesh import Material, SceneMesh
from toponav.scenes.textures import Surface
from toponav.types import Instance


class MeshBuilder:
    """Add surfaces part by part, then `build`."""

    def __init__(self) -> None:
        """Start empty."""
        self._vertices: list[NDArray[np.float64]] = []
        self._faces: list[NDArray[np.int32]] = []
        self._uv: list[NDArray[np.float32]] = []
        self._face_material: list[NDArray[np.int32]] = []
        self._face_instance: list[NDArray[np.int32]] = []
        self._materials: dict[int, int] = {}
        self._material_list: list[Material] = []
        self._instances: list[Instance] = []
        self._vertex_count = 0

    def instance(self, name: str, category: str) -> int:
        """Enter an instance; returns its id."""
        self._instances.append(Instance(len(self._instances), name, canonical(category)))
        return len(self._instances) - 1

    def material(self, material: Material) -> int:
        """Enter a material, once; returns its index."""
        if id(material) not in self._materials:
            self._materials[id(material)] = len(self._material_list)
            self._material_list.append(material)
        return self._materials[id(material)]

    def add_surface(
        self, vertices: ArrayLike, faces: ArrayLike, surface: Surface, instance: int
    ) -> None:
        """Add triangles covered with a surface, which repeats along the faces' main axes.

        Args:
            vertices: (V, 3) metres, world frame.
            faces: (F, 3) indices into these vertices.
            surface: What they look like.
            instance: Id of the instance.
        """
        points = np.asarray(vertices, dtype=np.float64).reshape(-1, 3)
        triangles = np.asarray(faces, dtype=np.int32).reshape(-1, 3)
        uv = planar_uv(points[triangles]) / np.float32(surface.repeat_m)
        self.add(points, triangles, self.material(surface.material), instance, uv)

    def add(
        self,
        vertices: NDArray[np.float64],
        faces: NDArray[np.int32],
        face_material: ArrayLike,
        instance: int,
        face_uv: NDArray[np.float32],
    ) -> None:
        """Add triangles of one instance.

        Args:
            vertices: (V, 3) metres, world frame.
            faces: (F, 3) indices into these vertices.
            face_material: (F,) material indices, or one for all.
            instance: Id of the instance.
            face_uv: (F, 3, 2) texture coordinates in repeats.
        """
        if not len(faces):
            return
        materials = np.broadcast_to(np.asarray(face_material, np.int32), len(faces))
        self._vertices.append(vertices)
        self._faces.append(faces + self._vertex_count)
        self._uv.append(np.asarray(face_uv, np.float32))
        self._face_material.append(materials.astype(np.int32))
        self._face_instance.append(np.full(len(faces), instance, np.int32))
        self._vertex_count += len(vertices)

    def build(self) -> SceneMesh:
        """The whole mesh."""
        return SceneMesh(
            vertices=np.concatenate(self._vertices),
            faces=np.concatenate(self._faces).astype(np.int32),
            face_uv=np.concatenate(self._uv),
            face_material=np.concatenate(self._face_material),
            face_instance=np.concatenate(self._face_instance),
            materials=tuple(self._material_list),
            instances=tuple(self._instances),
        )


def planar_uv(corners: NDArray[np.float64]) -> NDArray[np.float32]:
    """(F, 3, 2) coordinates of (F, 3, 3) corners along the faces' two main axes, in metres.

    On walls u runs along the wall and v up; on floors u is x and v is y.
    """
    normal = np.abs(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]))
    axis = normal.argmax(axis=1)
    u = np.where(axis == 0, 1, 0)
    v = np.where(axis == 2, 1, 2)
    rows = np.arange(len(corners))[:, None]
    columns = np.arange(3)[None, :]
    uv = np.stack([corners[rows, columns, u[:, None]], corners[rows, columns, v[:, None]]], -1)
    return uv.astype(np.float32)
