"""The triangle soup that every scene becomes before a simulator loads it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from toponav.types import Instance


@dataclass(frozen=True, eq=False)
class Material:
    """A surface: an image that repeats over uv space; a plain colour is a 1 x 1 image.

    Attributes:
        name: For people.
        texture: (h, w, 3) uint8, sRGB; row 0 is v = 1 (the top), as in OpenGL.
    """

    name: str
    texture: NDArray[np.uint8]


@dataclass(frozen=True, eq=False)
class SceneMesh:
    """Triangles of a whole scene with appearance and instance ids; z up, metres.

    Attributes:
        vertices: (V, 3) float64.
        faces: (F, 3) int32 indices into `vertices`.
        face_uv: (F, 3, 2) float32 texture coordinates of each corner, in repeats.
        face_material: (F,) int32 indices into `materials`.
        face_instance: (F,) int32 indices into `instances`.
        materials: At least one.
        instances: `instances[i].id == i`; structure (walls, floors, doors, ...) is among them.
        corner_colors: (F, 3, 3) uint8 that multiply the texture, or None.
        lit: Whether a renderer lights it; a scan's textures bring their light with them.
    """

    vertices: NDArray[np.float64]
    faces: NDArray[np.int32]
    face_uv: NDArray[np.float32]
    face_material: NDArray[np.int32]
    face_instance: NDArray[np.int32]
    materials: tuple[Material, ...]
    instances: tuple[Instance, ...]
    corner_colors: NDArray[np.uint8] | None = None
    lit: bool = True


@dataclass(frozen=True)
class SceneEpisode:
    """A target category and a start pose (foot point on the floor, yaw in radians)."""

    target: str
    start: tuple[float, float, float]
    yaw: float


@dataclass(frozen=True, eq=False)
class Scene:
    """What an environment loads.

    Attributes:
        name: Unique among the scenes of a run.
        mesh: Geometry, appearance and labels.
        floors: z of each known floor, ascending; empty when the simulator must find them.
        episodes: Episodes that the scene brings with it, maybe none.
        room_types: Room labels by polygon, for statistics and tests only: (type, level, (n, 2)).
        viewpoints: (N, 3) goal viewpoints by canonical category, where a dataset brings them; of
            other categories the simulator finds them.
        stage: The file of a scene that Habitat can load itself; None for another one.
    """

    name: str
    mesh: SceneMesh
    floors: tuple[float, ...] = ()
    episodes: tuple[SceneEpisode, ...] = ()
    room_types: tuple[tuple[str, int, NDArray[np.float64]], ...] = ()
    viewpoints: Mapping[str, NDArray[np.float64]] = field(default_factory=dict)
    stage: Path | None = None
