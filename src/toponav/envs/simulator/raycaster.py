"""Ray casting against a scene's triangles with Embree: no GPU, no display."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from embreex.mesh_construction import TriangleMesh
from embreex.rtcore_scene import EmbreeScene
from numpy.typing import ArrayLike, NDArray

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

    def visible_faces(self, world_from_camera: Pose, intrinsics: Intrinsics) -> NDArray[np.int32]:
        """(H, W) triangles hit by the rays through a camera's pixel centres, -1 without a hit."""
        eye = (world_from_camera.translation - self._center).astype(np.float32)
        rotation = world_from_camera.rotation.astype(np.float32)
        camera_rays = intrinsics.rays().astype(np.float32).reshape(-1, 3)
        rays = np.einsum("ij,kj->ik", camera_rays, rotation)
        face = self._run(np.tile(eye, (len(rays), 1)), rays).face
        return face.reshape(intrinsics.height, intrinsics.width)

    def _run(self, origins: NDArray[np.float32], directions: NDArray[np.float32]) -> RayHits:
        hits = self._scene.run(origins, directions, query="INTERSECT", output=True)
        face = hits["primID"]
        distance = hits["tfar"]
        distance[face < 0] = np.inf
        return RayHits(distance, face)
