"""From a labelled mesh to another one of the same rooms: which object each triangle belongs to.

Published scenes come as two meshes, one that looks real and one that is labelled. Triangles that
both have take their label over; any other takes that of most of the labelled points nearest to it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

SPACING_M = 0.04
"""Labelled points are about this far apart, at least one a triangle."""

MAX_POINTS = 4_000_000
"""A larger surface gets fewer points an area."""

SAME_TRIANGLE_M = 1e-3
"""Triangles whose middles and sizes differ by no more are the same one."""

REACH_M = 0.25
"""What has no labelled point this near belongs to no object."""

_INNER = np.array([[1 / 3, 1 / 3, 1 / 3], [2 / 3, 1 / 6, 1 / 6], [1 / 6, 2 / 3, 1 / 6],
                   [1 / 6, 1 / 6, 2 / 3]])  # fmt: skip
"""Barycentric places in a triangle at which its label is asked for, the middle first."""


@dataclass(frozen=True, eq=False)
class SurfacePoints:
    """Points on F triangles.

    Attributes:
        face: (P,) the triangle of each.
        weights: (P, 3) where in it, barycentric.
    """

    face: NDArray[np.int64]
    weights: NDArray[np.float64]

    def interpolate(self, corner_values: NDArray[np.floating]) -> NDArray[np.float64]:
        """(P, k) values at the points, of (F, 3, k) at the corners."""
        values: NDArray[np.float64] = np.einsum(
            "pc,pck->pk", self.weights, corner_values[self.face].astype(np.float64)
        )
        return values


def spread_points(corners: NDArray[np.float64]) -> SurfacePoints:
    """Points spread over (F, 3, 3) triangles by area, at least the middle of each."""
    area = 0.5 * np.linalg.norm(
        np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
    )
    spacing = max(SPACING_M, float(np.sqrt(area.sum() / MAX_POINTS)))
    extra = np.floor(area / spacing**2).astype(np.int64)
    face = np.concatenate([np.arange(len(corners)), np.repeat(np.arange(len(corners)), extra)])
    weights = np.full((len(face), 3), 1.0 / 3.0)
    u, v = np.random.default_rng(0).random((2, int(extra.sum())))
    folded = u + v > 1.0
    u, v = np.where(folded, 1.0 - u, u), np.where(folded, 1.0 - v, v)
    weights[len(corners) :] = np.stack([1.0 - u - v, u, v], axis=-1)
    return SurfacePoints(face, weights)


def transfer_labels(
    corners: NDArray[np.float64],
    labelled: NDArray[np.float64],
    points: SurfacePoints,
    labels: NDArray[np.int64],
) -> NDArray[np.int64]:
    """The label of every triangle of a mesh.

    Args:
        corners: (F, 3, 3) of the mesh, metres.
        labelled: (G, 3, 3) triangles of the labelled mesh, in the same frame.
        points: Points on the latter.
        labels: (P,) their labels, at least 0; -1 for none.

    Returns:
        (F,) labels; -1 where nothing labelled is near.
    """
    result = np.full(len(corners), -1, np.int64)
    if not len(labelled) or not len(corners):
        return result
    distance, same = cKDTree(_signature(labelled)).query(_signature(corners), workers=-1)
    shared = distance <= SAME_TRIANGLE_M
    result[shared] = _majorities(points.face, labels, len(labelled))[same[shared]]
    rest = np.flatnonzero(~shared)
    if len(rest):
        tree = cKDTree(points.interpolate(labelled))
        places = np.einsum("ic,fck->fik", _INNER, corners[rest]).reshape(-1, 3)
        distance, nearest = tree.query(places, distance_upper_bound=REACH_M, workers=-1)
        found = np.append(labels, -1)[np.where(np.isfinite(distance), nearest, len(labels))]
        votes = np.repeat(np.arange(len(rest)), len(_INNER))
        result[rest] = _majorities(votes, found, len(rest))
    return result


def _signature(corners: NDArray[np.float64]) -> NDArray[np.float64]:
    """(F, 4) the middle of each triangle and how far its corners lie from it, metres."""
    middle = corners.mean(axis=1)
    spread = np.sqrt(((corners - middle[:, None]) ** 2).sum(axis=(1, 2)))
    return np.column_stack([middle, spread])


def _majorities(
    group: NDArray[np.int64], labels: NDArray[np.int64], count: int
) -> NDArray[np.int64]:
    """(count,) the most frequent label of each group, -1 among them, the lower one at a tie."""
    pairs, votes = np.unique(np.column_stack([group, labels]), axis=0, return_counts=True)
    best = np.full(count, -1, np.int64)
    order = np.lexsort([-pairs[:, 1], votes])
    best[pairs[order, 0]] = pairs[order, 1]
    return best
