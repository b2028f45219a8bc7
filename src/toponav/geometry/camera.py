"""The pinhole camera: intrinsics, back-projection and projection (Section III-C, eq. 1-2)."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from toponav.errors import InputError


@dataclass(frozen=True)
class Intrinsics:
    """A pinhole camera without distortion.

    Pixel (u, v) = (column, row); integer coordinates are pixel centres, so a symmetric camera has
    its principal point at ((width - 1) / 2, (height - 1) / 2).

    Attributes:
        width: Columns of the image.
        height: Rows of the image.
        fx: Focal length along u, pixels.
        fy: Focal length along v, pixels.
        cx: Principal point, u.
        cy: Principal point, v.
    """

    width: int
    height: int
    fx: float
    fy: float
    cx: float
    cy: float

    def __post_init__(self) -> None:
        if self.width < 1 or self.height < 1 or not (self.fx > 0.0 and self.fy > 0.0):
            raise InputError(f"camera intrinsics need a positive size and focal lengths: {self}")

    @classmethod
    def from_hfov(cls, width: int, height: int, hfov_deg: float) -> Intrinsics:
        """Square pixels and a centred principal point from a horizontal field of view."""
        if not 0.0 < hfov_deg < 180.0:
            raise InputError(f"a horizontal field of view lies in (0, 180) degrees, not {hfov_deg}")
        focal = 0.5 * width / math.tan(math.radians(hfov_deg) / 2.0)
        return cls(width, height, focal, focal, (width - 1) / 2.0, (height - 1) / 2.0)

    @property
    def hfov(self) -> float:
        """Horizontal field of view of a centred camera, radians."""
        return 2.0 * math.atan(0.5 * self.width / self.fx)

    @property
    def matrix(self) -> NDArray[np.float64]:
        """K, (3, 3)."""
        return np.array([[self.fx, 0.0, self.cx], [0.0, self.fy, self.cy], [0.0, 0.0, 1.0]])

    def ray(self, u: ArrayLike, v: ArrayLike) -> NDArray[np.float64]:
        """(..., 3) directions of pixels in the camera frame with z = 1: K^-1 [u v 1]^T."""
        u, v = np.broadcast_arrays(u, v)
        return np.stack([(u - self.cx) / self.fx, (v - self.cy) / self.fy, np.ones(u.shape)], -1)

    def rays(self) -> NDArray[np.float64]:
        """(height, width, 3) directions in the camera frame with z = 1: K^-1 [u v 1]^T."""
        u = (np.arange(self.width) - self.cx) / self.fx
        v = (np.arange(self.height) - self.cy) / self.fy
        rays = np.ones((self.height, self.width, 3))
        rays[..., 0] = u[None, :]
        rays[..., 1] = v[:, None]
        return rays


def back_project(depth: ArrayLike, intrinsics: Intrinsics) -> NDArray[np.float64]:
    """Camera-frame points of every pixel, eq. (1): x_c = d K^-1 [u v 1]^T.

    Args:
        depth: (H, W) z coordinate in metres; 0 means no return and yields the origin.
        intrinsics: The camera; its size is that of `depth`.

    Returns:
        (H, W, 3) points, metres.
    """
    return intrinsics.rays() * np.asarray(depth, dtype=np.float64)[..., None]


def project(points: ArrayLike, intrinsics: Intrinsics) -> NDArray[np.float64]:
    """Pixel coordinates (u, v) of camera-frame points.

    Args:
        points: (..., 3) metres; those with z <= 0 project to NaN.
        intrinsics: The camera.

    Returns:
        (..., 2) pixels, not clipped to the image.
    """
    points = np.asarray(points, dtype=np.float64)
    z = np.where(points[..., 2] > 0.0, points[..., 2], np.nan)
    u = intrinsics.fx * points[..., 0] / z + intrinsics.cx
    v = intrinsics.fy * points[..., 1] / z + intrinsics.cy
    return np.stack([u, v], axis=-1)
