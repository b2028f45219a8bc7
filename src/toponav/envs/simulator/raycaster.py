"""Ray casting against a scene's triangles with Embree: no GPU, no display."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from embreex.mesh_construction import TriangleMesh
from embreex.rtcore_scene import EmbreeScene
from numba import njit
from numpy.typing import ArrayLike, NDArray

from toponav.envs.simulator.row_blocks import RowsOfFaces
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

    def __init__(self, mesh: SceneMesh) -> None:
        """Build Embree's search tree."""
        corners = mesh.vertices[mesh.faces]
        low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
        self._center = 0.5 * (low + high)
        self._scene = EmbreeScene()
        TriangleMesh(self._scene, (corners - self._center).astype(np.float32))

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

    def rows_of_faces(self, world_from_camera: Pose, intrinsics: Intrinsics) -> RowsOfFaces:
        """The triangles that the rays through a camera's pixel centres hit; cast when asked for."""
        eye = (world_from_camera.translation - self._center).astype(np.float32)
        camera = (intrinsics.fx, intrinsics.fy, intrinsics.cx, intrinsics.cy)
        rotation = np.ascontiguousarray(world_from_camera.rotation)

        def cast_rows(first: int, end: int) -> NDArray[np.int32]:
            rays = np.empty(((end - first) * intrinsics.width, 3), np.float32)
            _aim(rays, first, intrinsics.width, camera, rotation)
            hit = self._scene.run(np.broadcast_to(eye, rays.shape), rays, query="INTERSECT")
            return np.asarray(hit, np.int32).reshape(end - first, -1)

        return cast_rows

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
    for row in range(len(rays) // width):
        y = (first + row - cy) / fy
        for column in range(width):
            x = (column - cx) / fx
            for i in range(3):
                ray = rotation[i, 0] * x + rotation[i, 1] * y + rotation[i, 2]
                rays[row * width + column, i] = ray
