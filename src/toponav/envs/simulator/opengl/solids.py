"""Parts of a scene whose surface is closed: from outside, the backs of their faces are hidden."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from toponav.envs.simulator.opengl.numbering import number_rows

OPEN = -1


class Solids(NamedTuple):
    """S solids among F faces.

    Attributes:
        of_face: (F,) the solid that a face belongs to; OPEN for none.
        low: (S, 3) least coordinates of each, metres.
        high: (S, 3) greatest coordinates of each, metres.
    """

    of_face: NDArray[np.int64]
    low: NDArray[np.float64]
    high: NDArray[np.float64]


def find_solids(vertices: NDArray[np.float64], faces: NDArray[np.int32]) -> Solids:
    """Solids among (F, 3) faces with (V, 3) vertices, metres.

    A solid is a connected part whose every edge joins two faces that run along it in opposite
    directions, and whose faces, counter-clockwise from outside, enclose a positive volume.
    """
    point = number_rows(list(vertices.T))
    points = np.empty((point.max() + 1, 3))
    points[point] = vertices
    corners = point[faces]
    edges = np.stack([corners, np.roll(corners, -1, axis=1)], axis=2)
    part = _parts(edges.reshape(-1, 2), len(points))
    of_face, count = part[corners[:, 0]], int(part.max()) + 1
    solid = _enclosed(points[corners], of_face, count) > 0.0
    covers = (edges[..., 0] != edges[..., 1]).all(axis=1)
    solid[part[_loose(edges[covers].reshape(-1, 2), len(points))]] = False
    low, high = np.full((count, 3), np.inf), np.full((count, 3), -np.inf)
    np.minimum.at(low, part, points)
    np.maximum.at(high, part, points)
    number = np.where(solid, np.cumsum(solid) - 1, OPEN)
    return Solids(number[of_face], low[solid], high[solid])


def _parts(edges: NDArray[np.int64], points: int) -> NDArray[np.int64]:
    """(points,) the connected part of each point; edges are (E, 2)."""
    graph = coo_matrix((np.ones(len(edges), np.bool_), edges.T), (points, points))
    _, part = connected_components(graph, directed=False)
    return np.asarray(part, np.int64)


def _enclosed(
    corners: NDArray[np.float64], part: NDArray[np.int64], count: int
) -> NDArray[np.float64]:
    """(count,) volume that the (F, 3, 3) corners of each part's faces enclose, if it is closed."""
    about = corners - corners.mean(axis=(0, 1))
    tetrahedra = np.einsum("fi,fi->f", about[:, 0], np.cross(about[:, 1], about[:, 2])) / 6.0
    return np.bincount(part, tetrahedra, count).astype(np.float64)


def _loose(edges: NDArray[np.int64], points: int) -> NDArray[np.int64]:
    """Points at edges that are not there exactly once in each direction."""
    there = edges[:, 0] * points + edges[:, 1]
    back = edges[:, 1] * points + edges[:, 0]
    known, times = np.unique(there, return_counts=True)
    paired = np.isin(back, known) & ~np.isin(there, known[times > 1])
    loose: NDArray[np.int64] = edges[~paired, 0]
    return loose
