"""A finished piece of furniture: its parts joined and fitted to a size."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from toponav.scenes.furniture.primitives import Part
from toponav.scenes.mesh import Material

Size = tuple[float, float, float]
"""Extents along the local x (width), y (depth) and z (height), metres."""


@dataclass(frozen=True, eq=False)
class FurnitureMesh:
    """A piece in its local frame: base centre at the origin, z up, front towards -y.

    Attributes:
        vertices: (V, 3) float64 metres.
        faces: (F, 3) int32 indices into `vertices`.
        face_uv: (F, 3, 2) float32 texture coordinates, in repeats.
        face_material: (F,) int32 indices into `materials`.
        materials: At least one.
    """

    vertices: NDArray[np.float64]
    faces: NDArray[np.int32]
    face_uv: NDArray[np.float32]
    face_material: NDArray[np.int32]
    materials: tuple[Material, ...]


def fit(parts: Sequence[Part], size: Size) -> FurnitureMesh:
    """Join parts and stretch them so that they fill the box of `size` exactly."""
    corners = np.concatenate([part.corners for part in parts]).reshape(-1, 3)
    low, high = corners.min(axis=0), corners.max(axis=0)
    extents = high - low
    scale = np.asarray(size) / np.where(extents > 0.0, extents, 1.0)
    base_center = np.array([*(low + high)[:2] / 2.0, low[2]])
    index: dict[int, int] = {}
    materials: list[Material] = []
    for part in parts:
        material = part.surface.material
        if id(material) not in index:
            index[id(material)] = len(materials)
            materials.append(material)
    counts = [len(part.corners) for part in parts]
    of_part = [index[id(part.surface.material)] for part in parts]
    return FurnitureMesh(
        vertices=(corners - base_center) * scale,
        faces=np.arange(len(corners), dtype=np.int32).reshape(-1, 3),
        face_uv=np.concatenate([part.uv for part in parts]).astype(np.float32),
        face_material=np.repeat(of_part, counts).astype(np.int32),
        materials=tuple(materials),
    )
