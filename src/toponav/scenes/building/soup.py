"""Collects the triangles of a scene, part by part, under uniquely named instances."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from toponav.scenes.mesh import Material, SceneMesh
from toponav.types import Instance


class TriangleSoup:
    """A growing scene mesh; every triangle has corners of its own."""

    def __init__(self) -> None:
        """Start empty."""
        self._instances: list[Instance] = []
        self._names: set[str] = set()
        self._materials: dict[int, tuple[int, Material]] = {}
        self._corners: list[NDArray[np.float64]] = []
        self._uv: list[NDArray[np.float32]] = []
        self._face_material: list[NDArray[np.int32]] = []
        self._face_instance: list[NDArray[np.int32]] = []
        self._colors: dict[int, NDArray[np.uint8]] = {}

    def instance(self, name: str, category: str) -> int:
        """Enter an instance; a name that is taken gets a number. Returns its id."""
        unique, count = name, 1
        while unique in self._names:
            count += 1
            unique = f"{name}#{count}"
        self._names.add(unique)
        self._instances.append(Instance(len(self._instances), unique, category))
        return self._instances[-1].id

    def material(self, material: Material) -> int:
        """The index of a material, which is entered when it is new."""
        entry = self._materials.setdefault(id(material), (len(self._materials), material))
        return entry[0]

    def add(
        self,
        instance: int,
        corners: NDArray[np.float64],
        uv: NDArray[np.float32],
        materials: Iterable[int],
        colors: NDArray[np.uint8] | None = None,
    ) -> None:
        """Add triangles of one instance.

        Args:
            instance: Its id.
            corners: (F, 3, 3) metres, world frame.
            uv: (F, 3, 2) texture coordinates, in repeats.
            materials: Index of each face's material.
            colors: (F, 3, 3) uint8 that multiply the texture, or None for white.
        """
        if not len(corners):
            return
        if colors is not None:
            self._colors[len(self._corners)] = colors
        self._corners.append(corners)
        self._uv.append(uv.astype(np.float32))
        self._face_material.append(np.fromiter(materials, np.int32, len(corners)))
        self._face_instance.append(np.full(len(corners), instance, np.int32))

    def mesh(self) -> SceneMesh:
        """Everything collected, as one mesh; `materials` and `instances` by index."""
        corners = np.concatenate([np.zeros((0, 3, 3)), *self._corners])
        colors = None
        if self._colors:
            colors = np.full((len(corners), 3, 3), 255, np.uint8)
            starts = np.cumsum([0, *(len(part) for part in self._corners)])
            for part, part_colors in self._colors.items():
                colors[starts[part] : starts[part + 1]] = part_colors
        return SceneMesh(
            vertices=corners.reshape(-1, 3),
            faces=np.arange(3 * len(corners), dtype=np.int32).reshape(-1, 3),
            face_uv=np.concatenate([np.zeros((0, 3, 2), np.float32), *self._uv]),
            face_material=np.concatenate([np.zeros(0, np.int32), *self._face_material]),
            face_instance=np.concatenate([np.zeros(0, np.int32), *self._face_instance]),
            materials=tuple(material for _, material in self._materials.values()),
            instances=tuple(self._instances),
            corner_colors=colors,
        )
