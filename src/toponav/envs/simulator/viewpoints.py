"""Viewpoints of objects, as the benchmark defines success (docs/protocol.md)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from toponav.envs.simulator.navigation import NavigableSurface
from toponav.envs.simulator.raycaster import RayCaster
from toponav.scenes.mesh import SceneMesh

GRID_M = 0.085
"""Spacing of the viewpoints in the published episode files."""
REACH_M = 1.0
"""Viewpoints are within this horizontal distance of the object's surface."""
EYE_M = 0.88
"""Height of the camera above the floor."""
MAX_ABOVE_M, MAX_BELOW_M = 2.2, 0.5
"""A viewpoint's floor lies at most so far below and above the object's lowest point."""
SURFACE_SAMPLES = 96
"""Points of an object's surface that are looked for."""
LOOKED_FOR = 12
"""How many of them, the nearest to a viewpoint, are tried from there."""


def viewpoints(
    surface: NavigableSurface,
    caster: RayCaster,
    mesh: SceneMesh,
    instance_ids: Sequence[int],
    eye_m: float = EYE_M,
) -> NDArray[np.float64]:
    """Places on the main island within 1 m of an instance, from which it is seen.

    Args:
        surface: Where the agent can be.
        caster: Casts rays into the mesh.
        mesh: The scene.
        instance_ids: The instances, each of which counts.
        eye_m: Height of the camera above the foot point.

    Returns:
        (N, 3) foot points, metres, instance after instance; maybe none.
    """
    found = [_of_instance(surface, caster, mesh, k, eye_m) for k in instance_ids]
    return np.concatenate([np.zeros((0, 3)), *found])


def _of_instance(
    surface: NavigableSurface, caster: RayCaster, mesh: SceneMesh, instance: int, eye_m: float
) -> NDArray[np.float64]:
    faces = mesh.faces[mesh.face_instance == instance]
    if not len(faces):
        return np.zeros((0, 3))
    samples = _surface_points(mesh.vertices[faces])
    candidates = _candidates(surface, samples)
    if not len(candidates):
        return candidates
    eyes = candidates + np.array([0.0, 0.0, eye_m])
    count = min(LOOKED_FOR, len(samples))
    _, nearest = cKDTree(samples).query(eyes, k=[*range(1, count + 1)])
    targets = samples[nearest]
    directions = targets - eyes[:, None]
    origins = np.broadcast_to(eyes[:, None], directions.shape)
    _, face = caster.first_hit(origins.reshape(-1, 3), directions.reshape(-1, 3))
    own = (face >= 0) & (mesh.face_instance[face] == instance)
    seen: NDArray[np.float64] = candidates[own.reshape(len(candidates), count).any(axis=1)]
    return seen


def _candidates(surface: NavigableSurface, samples: NDArray[np.float64]) -> NDArray[np.float64]:
    """Grid points of the main island near the samples, on the object's own storey."""
    low, high = samples.min(axis=0), samples.max(axis=0)
    first = np.floor((low[:2] - REACH_M) / GRID_M)
    last = np.ceil((high[:2] + REACH_M) / GRID_M)
    x, y = (GRID_M * np.arange(a, b + 1) for a, b in zip(first, last, strict=True))
    grid = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)
    distance, _ = cKDTree(samples[:, :2]).query(grid)
    grid = grid[distance < REACH_M]
    heights = surface.heights_at(grid)
    points = [
        (x, y, z)
        for (x, y), levels in zip(grid, heights, strict=True)
        for z in levels
        if low[2] - MAX_ABOVE_M <= z <= low[2] + MAX_BELOW_M
    ]
    return np.array(points, dtype=np.float64).reshape(-1, 3)


def _surface_points(corners: NDArray[np.float64]) -> NDArray[np.float64]:
    """Points spread over (F, 3, 3) triangles by area, the same at every call."""
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    area = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)
    if area.sum() <= 0.0:
        return corners.reshape(-1, 3)
    rng = np.random.default_rng(0)
    total = np.cumsum(area) / area.sum()
    face = np.searchsorted(total, (np.arange(SURFACE_SAMPLES) + 0.5) / SURFACE_SAMPLES)
    u, v = rng.random((2, len(face), 1))
    flip = u + v > 1.0
    u, v = np.where(flip, 1.0 - u, u), np.where(flip, 1.0 - v, v)
    points: NDArray[np.float64] = a[face] + u * (b[face] - a[face]) + v * (c[face] - a[face])
    return points
