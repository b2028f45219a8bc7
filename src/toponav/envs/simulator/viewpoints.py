"""Viewpoints of objects, as the benchmark defines success: within 1 m of one, and seeing it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from toponav.envs.simulator.raycaster import RayCaster
from toponav.envs.surface import Surface
from toponav.scenes.mesh import SceneMesh

GRID_M = 0.085
"""Spacing of the viewpoints in the published episode files."""
REACH_M = 1.0
"""Viewpoints are within this horizontal distance of the object's surface."""
EYE_M = 0.88
"""Height of the camera above the floor."""
MAX_ABOVE_M, MAX_BELOW_M = 2.2, 0.5
"""An object's lowest point is at most so far above and below a viewpoint's floor: pictures count,
what stands on another storey does not."""
SURFACE_SAMPLES = 2048
"""Points of an object's surface to which distances are measured."""
LOOKED_FOR = 64
"""How many of them, evenly spread, must be hidden before an object counts as hidden."""
FIRST_GLANCE = 8
"""How many of these, the nearest to the eye, are tried first."""


def viewpoints(
    surface: Surface,
    caster: RayCaster,
    mesh: SceneMesh,
    instance_ids: Sequence[int],
    eye_m: float = EYE_M,
) -> NDArray[np.float64]:
    """Places on the main island within 1 m of an instance, from which any part of it is seen.

    Args:
        surface: Where the agent can be.
        caster: Casts rays into the mesh.
        mesh: The scene.
        instance_ids: The instances, each of which counts.
        eye_m: Height of the camera above the foot point.

    Returns:
        (N, 3) foot points, metres, on a grid of 0.085 m, each once, in order; maybe none.
    """
    found = [_of_instance(surface, caster, mesh, k, eye_m) for k in instance_ids]
    return np.unique(np.concatenate([np.zeros((0, 3)), *found]), axis=0)


def _of_instance(
    surface: Surface, caster: RayCaster, mesh: SceneMesh, instance: int, eye_m: float
) -> NDArray[np.float64]:
    """(N, 3) viewpoints of one instance."""
    faces = mesh.faces[mesh.face_instance == instance]
    if not len(faces):
        return np.zeros((0, 3))
    samples = _surface_points(mesh.vertices[faces])
    candidates = _candidates(surface, samples)
    eyes = candidates + np.array([0.0, 0.0, eye_m])
    targets = samples[:: SURFACE_SAMPLES // LOOKED_FOR]
    nearest = np.argsort(np.linalg.norm(targets - eyes[:, None], axis=2), axis=1, kind="stable")
    seen = np.zeros(len(eyes), np.bool_)
    for looked_at in (nearest[:, :FIRST_GLANCE], nearest[:, FIRST_GLANCE:]):
        hidden = np.flatnonzero(~seen)
        directions = targets[looked_at[hidden]] - eyes[hidden, None]
        origins = np.broadcast_to(eyes[hidden, None], directions.shape)
        _, face = caster.first_hit(origins.reshape(-1, 3), directions.reshape(-1, 3))
        own = (face >= 0) & (mesh.face_instance[face] == instance)
        seen[hidden] = own.reshape(directions.shape[:2]).any(axis=1)
    return candidates[seen]


def _candidates(surface: Surface, samples: NDArray[np.float64]) -> NDArray[np.float64]:
    """(N, 3) grid points of the main island near the samples, on the object's own storey."""
    low, high = samples.min(axis=0), samples.max(axis=0)
    first = np.floor((low[:2] - REACH_M) / GRID_M)
    last = np.ceil((high[:2] + REACH_M) / GRID_M)
    x, y = (GRID_M * np.arange(a, b + 1) for a, b in zip(first, last, strict=True))
    grid = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)
    distance, _ = cKDTree(samples[:, :2]).query(grid, distance_upper_bound=REACH_M)
    points = surface.points_over(grid[np.isfinite(distance)])
    above = low[2] - points[:, 2]
    near: NDArray[np.float64] = points[(above >= -MAX_BELOW_M) & (above <= MAX_ABOVE_M)]
    return near


def _surface_points(corners: NDArray[np.float64]) -> NDArray[np.float64]:
    """(SURFACE_SAMPLES, 3) points spread by area over (F, 3, 3) triangles, always the same ones."""
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    total = np.cumsum(area) if area.any() else np.arange(1.0, len(area) + 1.0)
    quantile = (np.arange(SURFACE_SAMPLES) + 0.5) / SURFACE_SAMPLES
    face = np.searchsorted(total, quantile * total[-1])
    u, v = np.random.default_rng(0).random((2, SURFACE_SAMPLES, 1))
    u, v = np.where(u + v > 1.0, 1.0 - u, u), np.where(u + v > 1.0, 1.0 - v, v)
    points: NDArray[np.float64] = a[face] + u * (b[face] - a[face]) + v * (c[face] - a[face])
    return points
