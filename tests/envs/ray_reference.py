"""The slow and obvious ray tracer."""

from __future__ import annotations

import numpy as np

from toponav.scenes.mesh import SceneMesh


def brute_force(
    mesh: SceneMesh, origin: np.ndarray, directions: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Moeller and Trumbore's test of every ray with every triangle.

    Returns:
        (N,) distances in lengths of the direction, infinite without a hit, and (N,) faces or -1.
    """
    a, b, c = (mesh.vertices[mesh.faces[:, k]] for k in range(3))
    edge_1, edge_2 = b - a, c - a
    p = np.cross(directions[:, None], edge_2[None])
    determinant = (edge_1 * p).sum(-1)
    with np.errstate(divide="ignore", invalid="ignore"):
        s = origin - a
        u = (s * p).sum(-1) / determinant
        q = np.cross(s, edge_1)
        v = (directions[:, None] * q).sum(-1) / determinant
        t = (edge_2 * q).sum(-1) / determinant
    hit = (np.abs(determinant) > 1e-12) & (u >= 0) & (v >= 0) & (u + v <= 1) & (t > 1e-6)
    t = np.where(hit, t, np.inf)
    face = t.argmin(axis=1)
    distance = t.min(axis=1)
    return distance, np.where(np.isfinite(distance), face, -1)
