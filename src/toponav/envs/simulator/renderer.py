"""RGB, depth and instance ids of a scene from any pinhole camera, by ray casting."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from toponav.envs.simulator.raycaster import RayCaster, RayHits
from toponav.geometry import Intrinsics, Pose
from toponav.scenes.mesh import Material, SceneMesh

NO_INSTANCE = -1

AMBIENT = 0.42
"""Share of light that falls everywhere."""
SKY = 0.18
"""Share that falls from above: it tells table tops from their fronts."""
HEADLIGHT = 0.28
"""Share that comes from the camera: it shapes round things."""
SIDE = 0.16
"""Share that comes from one side: it tells a room's walls from each other."""
SIDE_DIRECTION = (0.48, 0.80, 0.36)
"""Unit vector towards the side light."""
FALLOFF_PER_M = 0.035
"""Darkening with distance, a depth cue; at most half."""


@dataclass(frozen=True, eq=False)
class RenderedFrame:
    """One image of the scene.

    Attributes:
        rgb: (H, W, 3) uint8; black where nothing is hit.
        depth: (H, W) float32, z coordinate in the camera frame, metres; 0 where nothing is hit.
        instance_ids: (H, W) int32 indices into the scene's instances, NO_INSTANCE for none.
    """

    rgb: NDArray[np.uint8]
    depth: NDArray[np.float32]
    instance_ids: NDArray[np.int32]


@dataclass(frozen=True, eq=False)
class _Atlas:
    """All textures in one array.

    Attributes:
        texels: (T, 3) uint8, row by row, material after material.
        offset: (M,) first texel of each material.
        size: (M, 2) rows and columns.
    """

    texels: NDArray[np.uint8]
    offset: NDArray[np.int64]
    size: NDArray[np.int64]


class Renderer:
    """Renders one scene; keeps the camera rays of the last intrinsics."""

    def __init__(self, mesh: SceneMesh, caster: RayCaster | None = None) -> None:
        """Pack textures and normals, and build the search tree unless one is given."""
        self.caster = caster or RayCaster(mesh)
        self._mesh = mesh
        self._atlas = _pack(mesh.materials)
        self._normals = _face_normals(mesh)
        self._uv = np.ascontiguousarray(mesh.face_uv, dtype=np.float32)
        no_colors = np.zeros((0, 3, 3), np.uint8)
        self._colors = no_colors if mesh.corner_colors is None else mesh.corner_colors
        self._rays: tuple[Intrinsics, NDArray[np.float32]] | None = None

    def render(self, world_from_camera: Pose, intrinsics: Intrinsics) -> RenderedFrame:
        """The scene as a camera sees it; the optical axis is the camera's +z."""
        directions = _rotated(
            self._camera_rays(intrinsics), world_from_camera.rotation.astype(np.float32)
        )
        hits = self.caster.cast_from(world_from_camera.translation, directions)
        shape = (intrinsics.height, intrinsics.width)
        rgb, depth, ids = self._shade(hits, directions)
        return RenderedFrame(rgb.reshape(*shape, 3), depth.reshape(shape), ids.reshape(shape))

    def _camera_rays(self, intrinsics: Intrinsics) -> NDArray[np.float32]:
        """(H * W, 3) directions with z = 1, so that the distance along a ray is its depth."""
        if self._rays is None or self._rays[0] != intrinsics:
            self._rays = (intrinsics, intrinsics.rays().reshape(-1, 3).astype(np.float32))
        return self._rays[1]

    def _shade(
        self, hits: RayHits, directions: NDArray[np.float32]
    ) -> tuple[NDArray[np.uint8], NDArray[np.float32], NDArray[np.int32]]:
        rgb = np.zeros((len(hits.face), 3), np.uint8)
        depth = np.zeros(len(hits.face), np.float32)
        ids = np.full(len(hits.face), NO_INSTANCE, np.int32)
        _shade_pixels(
            (hits.distance, hits.face, hits.u, hits.v, directions),
            (self._normals, self._uv, self._mesh.face_material, self._mesh.face_instance),
            (self._atlas.texels, self._atlas.offset, self._atlas.size, self._colors),
            (rgb, depth, ids),
        )
        return rgb, depth, ids


def _pack(materials: tuple[Material, ...]) -> _Atlas:
    sizes = np.array([material.texture.shape[:2] for material in materials], dtype=np.int64)
    counts = sizes[:, 0] * sizes[:, 1]
    texels = np.concatenate([material.texture.reshape(-1, 3) for material in materials])
    return _Atlas(texels, np.concatenate([[0], np.cumsum(counts)[:-1]]), sizes)


def _face_normals(mesh: SceneMesh) -> NDArray[np.float32]:
    """(F, 3) unit normals; zero for degenerate triangles."""
    a, b, c = (mesh.vertices[mesh.faces[:, k]] for k in range(3))
    normals = np.cross(b - a, c - a)
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    unit: NDArray[np.float32] = (normals / np.maximum(length, 1e-12)).astype(np.float32)
    return unit


_Floats = NDArray[np.float32]
_Rays = tuple[_Floats, NDArray[np.int32], _Floats, _Floats, _Floats]
_Faces = tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.int32], NDArray[np.int32]]
_Looks = tuple[NDArray[np.uint8], NDArray[np.int64], NDArray[np.int64], NDArray[np.uint8]]
_Images = tuple[NDArray[np.uint8], NDArray[np.float32], NDArray[np.int32]]


@njit(cache=True, nogil=True)
def _rotated(rays: _Floats, rotation: _Floats) -> _Floats:
    """(N, 3) camera rays in the world frame."""
    turned = np.empty_like(rays)
    for i in range(len(rays)):
        x, y, z = rays[i, 0], rays[i, 1], rays[i, 2]
        for k in range(3):
            turned[i, k] = rotation[k, 0] * x + rotation[k, 1] * y + rotation[k, 2] * z
    return turned


@njit(cache=True, nogil=True)
def _shade_pixels(rays: _Rays, faces: _Faces, looks: _Looks, images: _Images) -> None:
    """Depth, id, texture and light of every pixel in one pass."""
    distance, face, second, third, directions = rays
    normals, uv, material, instance = faces
    texels, offset, size, corner_colors = looks
    rgb, depth, ids = images
    for i in range(len(face)):
        f = face[i]
        if f < 0:
            continue
        depth[i] = distance[i]
        ids[i] = instance[f]
        b, c = second[i], third[i]
        a = 1.0 - b - c
        u = a * uv[f, 0, 0] + b * uv[f, 1, 0] + c * uv[f, 2, 0]
        v = a * uv[f, 0, 1] + b * uv[f, 1, 1] + c * uv[f, 2, 1]
        m = material[f]
        rows, columns = size[m, 0], size[m, 1]
        column = min(int((u - np.floor(u)) * columns), columns - 1)
        row = min(int((1.0 - (v - np.floor(v))) * rows), rows - 1)
        texel = offset[m] + row * columns + column
        dx, dy, dz = directions[i, 0], directions[i, 1], directions[i, 2]
        length = np.sqrt(dx * dx + dy * dy + dz * dz)
        nx, ny, nz = normals[f, 0], normals[f, 1], normals[f, 2]
        facing = (nx * dx + ny * dy + nz * dz) / length
        if facing > 0.0:  # seen from behind: light the side that is seen
            nx, ny, nz, facing = -nx, -ny, -nz, -facing
        side = nx * SIDE_DIRECTION[0] + ny * SIDE_DIRECTION[1] + nz * SIDE_DIRECTION[2]
        light = AMBIENT + SKY * (0.5 + 0.5 * nz) - HEADLIGHT * facing + SIDE * (0.5 + 0.5 * side)
        light *= max(0.5, 1.0 - FALLOFF_PER_M * distance[i] * length)
        for channel in range(3):
            value = light * texels[texel, channel]
            if len(corner_colors):
                tint = (
                    a * corner_colors[f, 0, channel]
                    + b * corner_colors[f, 1, channel]
                    + c * corner_colors[f, 2, channel]
                )
                value *= tint / 255.0
            rgb[i, channel] = min(255, int(value + 0.5))
