"""RGB, depth and instance ids of a scene from any pinhole camera; no GPU, no display."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from toponav.cores import usable_cores
from toponav.envs.simulator.homogeneous import pixels_from_world
from toponav.envs.simulator.rasterizer import Rasterizer
from toponav.envs.simulator.row_blocks import RowsOfFaces, for_row_blocks
from toponav.envs.simulator.shading import Images, Surfaces, View, shade
from toponav.geometry import Intrinsics, Pose
from toponav.scenes.mesh import SceneMesh


class Visibility(Protocol):
    """Finds the triangle that each pixel of a camera sees."""

    def rows_of_faces(self, world_from_camera: Pose, intrinsics: Intrinsics) -> RowsOfFaces:
        """The nearest triangles through the pixel centres, to be asked for by rows."""
        ...


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


class CameraRenderer(Protocol):
    """Renders one scene from any pose."""

    def render(self, world_from_camera: Pose, intrinsics: Intrinsics) -> RenderedFrame:
        """The scene as a camera sees it; the optical axis is the camera's +z."""
        ...


class Renderer:
    """Renders one scene: which triangle a pixel sees first, its colour and depth then."""

    def __init__(
        self, mesh: SceneMesh, visibility: Visibility | None = None, threads: int | None = None
    ) -> None:
        """Pack textures and normals.

        Args:
            mesh: The scene.
            visibility: What finds the visible triangles; a `Rasterizer` by default. A `RayCaster`
                finds the same ones, several times slower.
            threads: How many share the rows; by default as many as there are cores. Images do not
                depend on it.
        """
        self._visibility = visibility or Rasterizer(mesh)
        self._threads = threads or usable_cores()
        self._surfaces = pack(mesh)

    def render(self, world_from_camera: Pose, intrinsics: Intrinsics) -> RenderedFrame:
        """The scene as a camera sees it; the optical axis is the camera's +z."""
        shape = (intrinsics.height, intrinsics.width)
        images = Images(
            rgb=np.empty((*shape, 3), np.uint8),
            depth=np.empty(shape, np.float32),
            instance_ids=np.empty(shape, np.int32),
        )
        view = View(
            pixels_from_world=pixels_from_world(world_from_camera, intrinsics),
            eye=np.array(world_from_camera.translation),
            camera=(intrinsics.fx, intrinsics.fy, intrinsics.cx, intrinsics.cy),
        )
        faces = self._visibility.rows_of_faces(world_from_camera, intrinsics)

        def render_rows(first: int, end: int) -> None:
            shade(view, self._surfaces, faces(first, end), images, first)

        for_row_blocks(intrinsics.height, render_rows, self._threads)
        return RenderedFrame(images.rgb, images.depth, images.instance_ids)


def pack(mesh: SceneMesh) -> Surfaces:
    """The scene as the compiled kernel takes it."""
    textures = [material.texture for material in mesh.materials]
    size = np.array([texture.shape[:2] for texture in textures], dtype=np.int64)
    end = np.cumsum(size[:, 0] * size[:, 1])
    colors = np.zeros((0, 3, 3), np.uint8) if mesh.corner_colors is None else mesh.corner_colors
    return Surfaces(
        vertices=np.ascontiguousarray(mesh.vertices, np.float64),
        faces=np.ascontiguousarray(mesh.faces, np.int32),
        normals=_face_normals(mesh),
        uv=np.ascontiguousarray(mesh.face_uv, np.float32),
        material=np.ascontiguousarray(mesh.face_material, np.int32),
        instance=np.ascontiguousarray(mesh.face_instance, np.int32),
        corner_colors=np.ascontiguousarray(colors, np.uint8),
        texels=np.concatenate([texture.reshape(-1, 3) for texture in textures]),
        offset=np.concatenate([[0], end[:-1]]),
        size=size,
        lit=mesh.lit,
    )


def _face_normals(mesh: SceneMesh) -> NDArray[np.float64]:
    """(F, 3) unit normals; zero for degenerate triangles."""
    a, b, c = (mesh.vertices[mesh.faces[:, k]] for k in range(3))
    normals = np.cross(b - a, c - a)
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    unit: NDArray[np.float64] = normals / np.maximum(length, 1e-12)
    return unit
