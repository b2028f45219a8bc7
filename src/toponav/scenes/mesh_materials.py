"""Appearance of mesh files: base colour textures, colour factors and vertex colours."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import trimesh
from numpy.typing import NDArray
from PIL.Image import Image

from toponav.scenes.mesh import Material

_WHITE = (255, 255, 255)


@dataclass(frozen=True, eq=False)
class SurfaceAppearance:
    """How the F faces of one mesh look.

    Attributes:
        material: Index into the table's materials.
        face_uv: (F, 3, 2) float32 texture coordinates, v up.
        corner_colors: (F, 3, 3) uint8, or None where no vertex has a colour.
    """

    material: int
    face_uv: NDArray[np.float32]
    corner_colors: NDArray[np.uint8] | None

    def colors_or_white(self, faces: NDArray[np.int64]) -> NDArray[np.uint8]:
        """(F, 3, 3) uint8: the corner colours, white without them."""
        if self.corner_colors is not None:
            return self.corner_colors
        return np.full((len(faces), 3, 3), 255, np.uint8)


class MaterialTable:
    """Collects the materials of a scene, each once."""

    def __init__(self) -> None:
        """Start empty."""
        self._materials: list[Material] = []
        self._index: dict[tuple[int, tuple[int, ...]], int] = {}
        self._images: list[Image] = []

    def materials(self) -> tuple[Material, ...]:
        """The materials collected so far."""
        return tuple(self._materials)

    def appearance(self, mesh: trimesh.Trimesh, mirrored: bool) -> SurfaceAppearance:
        """The appearance of a mesh, its corners in reverse order when it is `mirrored`."""
        visual: Any = mesh.visual
        faces = mesh.faces[:, ::-1] if mirrored else mesh.faces
        face_uv = np.zeros((len(faces), 3, 2), np.float32)
        if visual.kind == "texture":
            if visual.uv is not None and len(visual.uv) == len(mesh.vertices):
                face_uv = np.asarray(visual.uv, np.float32)[faces]
            colors = visual.vertex_attributes.get("color")
            material = self._textured(visual.material)
        else:
            colors = visual.vertex_colors if visual.kind == "vertex" else None
            material = self._material("plain", None, _WHITE)
        corner_colors = None
        if visual.kind == "face":
            corner_colors = np.repeat(_as_uint8(visual.face_colors)[:, None, :3], 3, axis=1)
        if colors is not None and len(colors) == len(mesh.vertices):
            corner_colors = _as_uint8(np.asarray(colors))[faces][..., :3]
        return SurfaceAppearance(material, face_uv, corner_colors)

    def _textured(self, material: Any) -> int:
        if isinstance(material, trimesh.visual.material.SimpleMaterial):
            material = _as_pbr(material)
        factor = _WHITE
        if material.baseColorFactor is not None:
            red, green, blue = _as_uint8(np.asarray(material.baseColorFactor))[:3].tolist()
            factor = (red, green, blue)
        return self._material(str(material.name or ""), material.baseColorTexture, factor)

    def _material(self, name: str, image: Image | None, factor: tuple[int, int, int]) -> int:
        """The index of the material, entered if it is new."""
        key = (0 if image is None else id(image), factor)
        if key not in self._index:
            self._index[key] = len(self._materials)
            if image is None:
                texture = np.array([[factor]], np.uint8)
            else:
                self._images.append(image)  # keeps its id from being given to another one
                pixels = np.asarray(image.convert("RGB"), np.float32)
                texture = np.round(pixels * (np.array(factor, np.float32) / 255.0)).astype(np.uint8)
            self._materials.append(Material(name, texture))
        return self._index[key]


def _as_pbr(material: Any) -> Any:
    """A Wavefront material as a glTF one."""
    return material.to_pbr()


def _as_uint8(colors: NDArray[Any]) -> NDArray[np.uint8]:
    """Colours as 0..255, from that or from floats in 0..1."""
    if colors.dtype.kind == "f":
        return np.clip(np.round(colors * 255.0), 0, 255).astype(np.uint8)
    if colors.dtype == np.uint16:
        return (colors >> 8).astype(np.uint8)
    return colors.astype(np.uint8)
