"""Level and upright faces of plan shapes, textured in world coordinates so that they join."""

from __future__ import annotations

import mapbox_earcut
import numpy as np
from numpy.typing import NDArray
from shapely import Geometry, Polygon, get_parts, simplify
from shapely.geometry.polygon import orient

PLAN_GRID_M = 1e-5
"""Plan geometry is snapped to this grid: the seams of unions and differences then agree."""

_COLLINEAR_M = 1e-6
_MIN_AREA_M2 = 1e-6


def polygons(shape: Geometry) -> list[Polygon]:
    """The polygons of a plan shape, their outer rings counter-clockwise, without slivers."""
    found = [part for part in get_parts(shape) if isinstance(part, Polygon)]
    plain = [simplify(part, _COLLINEAR_M) for part in found if part.area > _MIN_AREA_M2]
    return [orient(part) for part in plain if isinstance(part, Polygon) and not part.is_empty]


def level_faces(shape: Geometry, z: float, upward: bool) -> NDArray[np.float64]:
    """(F, 3, 3) triangles of a plan shape at height z, facing up or down."""
    faces = [np.zeros((0, 3, 3))]
    for polygon in polygons(shape):
        flat = _triangulate(polygon)
        corners = np.concatenate([flat, np.full((len(flat), 3, 1), z)], axis=2)
        faces.append(corners if upward else corners[:, ::-1])
    return np.concatenate(faces)


def _triangulate(polygon: Polygon) -> NDArray[np.float64]:
    """(F, 3, 2) triangles of a polygon with holes, counter-clockwise."""
    rings = [np.asarray(ring.coords)[:-1, :2] for ring in (polygon.exterior, *polygon.interiors)]
    points = np.concatenate(rings)
    ends = np.cumsum([len(ring) for ring in rings]).astype(np.uint32)
    corners = points[
        mapbox_earcut.triangulate_float64(points, ends).reshape(-1, 3).astype(np.int64)
    ]
    edge_a, edge_b = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    clockwise = edge_a[:, 0] * edge_b[:, 1] - edge_a[:, 1] * edge_b[:, 0] < 0.0
    corners[clockwise] = corners[clockwise][:, ::-1]
    return corners


def boundary_edges(shape: Geometry) -> NDArray[np.float64]:
    """(E, 2, 2) directed edges of a plan shape; its inside is on their left."""
    edges = [np.zeros((0, 2, 2))]
    for polygon in polygons(shape):
        for ring in (polygon.exterior, *polygon.interiors):
            points = np.asarray(ring.coords)[:, :2]
            edges.append(np.stack([points[:-1], points[1:]], axis=1))
    return np.concatenate(edges)


def upright_faces(edges: NDArray[np.float64], low: float, high: float) -> NDArray[np.float64]:
    """(2 E, 3, 3) triangles over (E, 2, 2) edges from z = low to high, facing their right side."""
    a, b = edges[:, 0], edges[:, 1]
    quads = np.empty((len(edges), 4, 3))
    for corner, (point, z) in enumerate(((a, low), (b, low), (b, high), (a, high))):
        quads[:, corner, :2] = point
        quads[:, corner, 2] = z
    return np.stack([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]], axis=1).reshape(-1, 3, 3)


def level_uv(corners: NDArray[np.float64], repeat_m: float) -> NDArray[np.float32]:
    """(F, 3, 2) texture coordinates of level faces: world x and y."""
    return (corners[..., :2] / repeat_m).astype(np.float32)


def upright_uv(corners: NDArray[np.float64], repeat_m: float, floor: float) -> NDArray[np.float32]:
    """(F, 3, 2) texture coordinates of upright faces: along the wall, and above the floor."""
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[:, :2]
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
    along = np.stack([-normals[:, 1], normals[:, 0]], axis=1)
    u = np.einsum("fkc,fc->fk", corners[..., :2], along)
    return (np.stack([u, corners[..., 2] - floor], axis=2) / repeat_m).astype(np.float32)
