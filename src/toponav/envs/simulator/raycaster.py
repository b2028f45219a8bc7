"""Ray casting against a scene's triangles with Embree: no GPU, no display."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from embreex.mesh_construction import TriangleMesh
from embreex.rtcore_scene import EmbreeScene
from numba import njit
from numpy.typing import ArrayLike, NDArray

from toponav.cores import usable_cores
from toponav.envs.simulator.row_blocks import for_row_blocks
from toponav.geometry import Intrinsics, Pose
from toponav.scenes.mesh import SceneMesh


@dataclass(frozen=True, eq=False)
class RayHits:
    """First hits of N rays.

    Attributes:
        distance: (N,) float32 in lengths of the ray's direction; infinite without a hit.
        face: (N,) int32 index of the triangle, -1 without a hit.
    """

    distance: NDArray[np.float32]
    face: NDArray[np.int32]


class RayCaster:
    """Casts rays into a scene; coordinates are shifted to the scene's centre for precision."""

    def __init__(self, mesh: SceneMesh, threads: int | None = None) -> None:
        """Build Embree's search tree.

        Args:
            mesh: The scene.
            threads: How many cast the rays of a camera; by default as many as there are cores.
        """
        corners = mesh.vertices[mesh.faces]
        low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
        self._center = 0.5 * (low + high)
        self._scene = EmbreeScene()
        TriangleMesh(self._scene, (corners - self._center).astype(np.float32))
        self._threads = threads or usable_cores()

    def cast(self, origins: ArrayLike, directions: ArrayLike) -> RayHits:
        """First hits of (N, 3) rays; directions need not be of unit length."""
        shifted = (np.asarray(origins, dtype=np.float64) - self._center).astype(np.float32)
        return self._run(shifted, np.ascontiguousarray(directions, dtype=np.float32))

    def first_hit(
        self, origins: ArrayLike, directions: ArrayLike
    ) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
        """(N,) distances in lengths of the direction, infinite without a hit, and (N,) faces."""
        hits = self.cast(origins, directions)
        return hits.distance.astype(np.float64), hits.face

    def visible_faces(self, world_from_camera: Pose, intrinsics: Intrinsics) -> NDArray[np.int32]:
        """(H, W) triangles hit by the rays through a camera's pixel centres, -1 without a hit."""
        eye = (world_from_camera.translation - self._center).astype(np.float32)
        camera = (intrinsics.fx, intrinsics.fy, intrinsics.cx, intrinsics.cy)
        rotation = np.ascontiguousarray(world_from_camera.rotation)
        faces = np.empty((intrinsics.height, intrinsics.width), np.int32)

        def cast_rows(first: int, end: int) -> None:
            rays = np.empty(((end - first) * intrinsics.width, 3), np.float32)
            _aim(rays, first, intrinsics.width, camera, rotation)
            hit = self._scene.run(np.tile(eye, (len(rays), 1)), rays, query="INTERSECT")
            faces[first:end] = hit.reshape(end - first, -1)

        for_row_blocks(intrinsics.height, cast_rows, self._threads)
        return faces

    def _run(self, origins: NDArray[np.float32], directions: NDArray[np.float32]) -> RayHits:
        hits = self._scene.run(origins, directions, query="INTERSECT", output=True)
        face = hits["primID"]
        distance = hits["tfar"]
        distance[face < 0] = np.inf
        return RayHits(distance, face)


@njit(cache=True, nogil=True)
def _aim(
    rays: NDArray[np.float32],
    first: int,
    width: int,
    camera: tuple[float, float, float, float],
    rotation: NDArray[np.float64],
) -> None:
    """Fill in the world directions, of length 1 along the optical axis, from row `first` on."""
    fx, fy, cx, cy = camera
    for k in range(len(rays)):
        x, y = (k % width - cx) / fx, (first + k // width - cy) / fy
        for i in range(3):
            rays[k, i] = rotation[i, 0] * x + rotation[i, 1] * y + rotation[i, 2]
