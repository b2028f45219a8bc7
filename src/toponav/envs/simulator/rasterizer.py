"""Which triangle each pixel sees: a depth-buffered rasteriser in homogeneous pixel coordinates.

A corner X of a triangle becomes x = K R^T (X - eye), whose third entry is its depth. The pixel ray
p = (u, v, 1) meets the triangle (a, b, c) where (b x c) . p, (c x a) . p and (a x b) . p have the
sign of det(a, b, c): three functions that are linear in the pixel, for corners behind the camera
too, so that nothing needs clipping (Olano, Greer: "Triangle scan conversion using 2D homogeneous
coordinates", 1997). One over the depth is linear as well, so that the depth test costs one
multiplication and one addition a pixel. Every pixel centre that a ray cast through it would hit is
hit here; triangles that share an edge leave no gap, since both compute the same crossing.
"""

from __future__ import annotations

import math

import numpy as np
from numba import literal_unroll, njit
from numpy.typing import NDArray

from toponav.envs.simulator.homogeneous import (
    Vector,
    cross,
    dot,
    minus,
    pixels_from_world,
    to_pixel,
)
from toponav.envs.simulator.row_blocks import RowsOfFaces
from toponav.geometry import Intrinsics, Pose
from toponav.scenes.mesh import SceneMesh

NEAR_M = 1e-3
"""Surfaces nearer to the image plane than this are not drawn."""

NO_FACE = -1

Span = tuple[int, int]
Box = tuple[int, int, int, int]


class Rasterizer:
    """Finds the visible triangle of each pixel of one scene."""

    def __init__(self, mesh: SceneMesh) -> None:
        """Keep the triangles."""
        self._vertices = np.ascontiguousarray(mesh.vertices, dtype=np.float64)
        self._faces = np.ascontiguousarray(mesh.faces, dtype=np.int32)

    def visible_faces(self, world_from_camera: Pose, intrinsics: Intrinsics) -> NDArray[np.int32]:
        """(H, W) indices of the nearest triangles through the pixel centres; NO_FACE for none."""
        shape = (intrinsics.height, intrinsics.width)
        visible = np.full(shape, NO_FACE, np.int32)
        transform = pixels_from_world(world_from_camera, intrinsics)
        eye = np.array(world_from_camera.translation)
        corners = _project(self._vertices, transform, eye)
        _draw(corners, self._faces, np.zeros(shape, np.float32), visible)
        return visible

    def rows_of_faces(self, world_from_camera: Pose, intrinsics: Intrinsics) -> RowsOfFaces:
        """The same by rows; all are drawn at once."""
        visible = self.visible_faces(world_from_camera, intrinsics)
        return lambda first, end: visible[first:end]


@njit(cache=True, nogil=True)
def _project(
    vertices: NDArray[np.float64], transform: NDArray[np.float64], eye: NDArray[np.float64]
) -> NDArray[np.float64]:
    """(V, 3) homogeneous pixel coordinates."""
    corners = np.empty_like(vertices)
    for i in range(len(vertices)):
        corners[i, 0], corners[i, 1], corners[i, 2] = to_pixel(vertices, i, transform, eye)
    return corners


@njit(cache=True, nogil=True, error_model="numpy")
def _draw(
    corners: NDArray[np.float64],
    faces: NDArray[np.int32],
    inverse_depth: NDArray[np.float32],
    visible: NDArray[np.int32],
) -> None:
    """Draw all triangles; of triangles at the same depth the first stays."""
    height, width = visible.shape
    for f in range(len(faces)):
        a, b, c = (
            _corner(corners, faces[f, 0]),
            _corner(corners, faces[f, 1]),
            _corner(corners, faces[f, 2]),
        )
        left, right, top, bottom = _bounds(a, b, c, height, width)
        if left > right or top > bottom:
            continue
        normal = cross(minus(b, a), minus(c, a))
        offset = dot(normal, a)
        if offset == 0.0:  # seen edge-on
            continue
        if offset < 0.0:  # seen from behind
            b, c = c, b
        sides = (cross(b, c), cross(c, a), cross(a, b))
        slope = normal[0] / offset
        for v in range(top, bottom + 1):
            first, last = _span(sides, v, (left, right))
            at_row = (normal[1] * v + normal[2]) / offset
            for u in range(first, last + 1):
                inverse = np.float32(slope * u + at_row)
                if inverse_depth[v, u] < inverse < 1.0 / NEAR_M:
                    inverse_depth[v, u] = inverse
                    visible[v, u] = f


@njit(cache=True, nogil=True)
def _corner(corners: NDArray[np.float64], k: int) -> Vector:
    return corners[k, 0], corners[k, 1], corners[k, 2]


@njit(cache=True, nogil=True, error_model="numpy")
def _bounds(a: Vector, b: Vector, c: Vector, height: int, width: int) -> Box:
    """First and last column and row that a triangle may cover; empty outside the view.

    A triangle that reaches behind the camera may cover any.
    """
    right, bottom = width - 1, height - 1
    if (
        max(a[2], b[2], c[2]) < NEAR_M
        or max(a[0], b[0], c[0]) < 0.0
        or max(a[1], b[1], c[1]) < 0.0
        or min(a[0] - right * a[2], b[0] - right * b[2], c[0] - right * c[2]) > 0.0
        or min(a[1] - bottom * a[2], b[1] - bottom * b[2], c[1] - bottom * c[2]) > 0.0
    ):
        return 1, 0, 1, 0
    if min(a[2], b[2], c[2]) < NEAR_M:
        return 0, right, 0, bottom
    columns = (a[0] / a[2], b[0] / b[2], c[0] / c[2])
    rows = (a[1] / a[2], b[1] / b[2], c[1] / c[2])
    return (
        math.ceil(max(0.0, min(columns))),
        math.floor(min(float(right), max(columns))),
        math.ceil(max(0.0, min(rows))),
        math.floor(min(float(bottom), max(rows))),
    )


@njit(cache=True, nogil=True, error_model="numpy")
def _span(sides: tuple[Vector, Vector, Vector], v: int, columns: Span) -> Span:
    """First and last of the columns whose pixels in row v are on the inner side of all sides."""
    low, high = float(columns[0]), float(columns[1])
    for side in literal_unroll(sides):
        at_row = side[1] * v + side[2]
        if side[0] > 0.0:
            low = max(low, -at_row / side[0])
        elif side[0] < 0.0:
            high = min(high, -at_row / side[0])
        elif at_row < 0.0:
            return 1, 0
    if low > high:
        return 1, 0
    return math.ceil(low), math.floor(high)
