"""Solids for meshing: boxes, extruded polygons and flat polygons."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from mapbox_earcut import triangulate_float64
from numpy.typing import NDArray
from shapely.geometry import MultiPolygon, Polygon
from shapely.geometry.base import BaseGeometry
from shapely.geometry.polygon import orient

Triangles = tuple[NDArray[np.float64], NDArray[np.int32]]
"""(V, 3) vertices in metres and (F, 3) faces, outward normals counter-clockwise."""

MIN_AREA_M2 = 1e-4
"""Slivers left by cutting polygons are dropped."""

BOX_FACES = np.array(
    [
        (0, 2, 1), (0, 3, 2), (4, 5, 6), (4, 6, 7), (0, 1, 5), (0, 5, 4),
        (1, 2, 6), (1, 6, 5), (2, 3, 7), (2, 7, 6), (3, 0, 4), (3, 4, 7),
    ],
    dtype=np.int32,
)  # fmt: skip


def polygons_of(geometry: BaseGeometry) -> list[Polygon]:
    """The polygons in any geometry, without slivers."""
    if isinstance(geometry, Polygon):
        parts = [geometry]
    elif isinstance(geometry, MultiPolygon):
        parts = list(geometry.geoms)
    else:
        parts = [p for p in getattr(geometry, "geoms", ()) if isinstance(p, Polygon)]
    return [part for part in parts if part.area > MIN_AREA_M2]


def flat(polygon: Polygon, z: float, up: bool) -> Triangles:
    """A polygon, holes and all, as a surface at height z that faces up or down."""
    polygon = orient(polygon)
    rings = [np.asarray(ring.coords)[:-1] for ring in (polygon.exterior, *polygon.interiors)]
    points = np.concatenate(rings)
    ends = np.cumsum([len(ring) for ring in rings]).astype(np.uint32)
    faces = triangulate_float64(points, ends).reshape(-1, 3).astype(np.int32)
    a, b, c = (points[faces[:, k]] for k in range(3))
    turn = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
    wrong = (turn < 0.0) if up else (turn > 0.0)
    faces[wrong] = faces[wrong][:, ::-1]
    return np.column_stack([points, np.full(len(points), z)]), faces


def extrude(polygon: Polygon, low: float, high: float) -> Triangles:
    """A prism over a polygon between two heights, closed."""
    polygon = orient(polygon)
    parts = [flat(polygon, low, up=False), flat(polygon, high, up=True)]
    for ring in (polygon.exterior, *polygon.interiors):
        points = np.asarray(ring.coords)
        for a, b in pairwise(points):
            corners = np.array([(*a, low), (*b, low), (*b, high), (*a, high)])
            parts.append((corners, np.array([(0, 1, 2), (0, 2, 3)], np.int32)))
    return join(parts)


def cuboid(low: tuple[float, float, float], high: tuple[float, float, float]) -> Triangles:
    """An axis-aligned box between two corners."""
    (x0, y0, z0), (x1, y1, z1) = low, high
    corners = [
        (x0, y0, z0), (x1, y0, z0), (x1, y1, z0), (x0, y1, z0),
        (x0, y0, z1), (x1, y0, z1), (x1, y1, z1), (x0, y1, z1),
    ]  # fmt: skip
    return np.array(corners, dtype=np.float64), BOX_FACES.copy()


def join(parts: list[Triangles]) -> Triangles:
    """Several solids as one."""
    offsets = np.cumsum([0, *(len(vertices) for vertices, _ in parts[:-1])])
    vertices = np.concatenate([vertices for vertices, _ in parts])
    faces = [faces + offset for (_, faces), offset in zip(parts, offsets, strict=True)]
    return vertices, np.concatenate(faces).astype(np.int32)
