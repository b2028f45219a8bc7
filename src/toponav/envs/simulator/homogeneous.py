"""Homogeneous pixel coordinates, (u z, v z, z) of a point, and vectors inside compiled kernels."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from toponav.geometry import Intrinsics, Pose

Vector = tuple[float, float, float]


def pixels_from_world(world_from_camera: Pose, intrinsics: Intrinsics) -> NDArray[np.float64]:
    """(3, 3) K R^T: it maps X - eye to homogeneous pixel coordinates."""
    return np.ascontiguousarray(intrinsics.matrix @ world_from_camera.rotation.T)


@njit(cache=True, nogil=True)
def to_pixel(
    vertices: NDArray[np.float64],
    k: int,
    transform: NDArray[np.float64],
    eye: NDArray[np.float64],
) -> Vector:
    """Homogeneous pixel coordinates of vertex k of (V, 3)."""
    x, y, z = vertices[k, 0] - eye[0], vertices[k, 1] - eye[1], vertices[k, 2] - eye[2]
    return (
        transform[0, 0] * x + transform[0, 1] * y + transform[0, 2] * z,
        transform[1, 0] * x + transform[1, 1] * y + transform[1, 2] * z,
        transform[2, 0] * x + transform[2, 1] * y + transform[2, 2] * z,
    )


@njit(cache=True, nogil=True)
def minus(a: Vector, b: Vector) -> Vector:
    """The difference a - b."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@njit(cache=True, nogil=True)
def dot(a: Vector, b: Vector) -> float:
    """The scalar product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@njit(cache=True, nogil=True)
def cross(a: Vector, b: Vector) -> Vector:
    """The vector product, exactly negated when a and b are exchanged."""
    return (
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    )
