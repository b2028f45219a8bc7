"""Rigid transformations, SE(3)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial.transform import Rotation

from toponav.errors import PoseError

ROTATION_TOLERANCE = 1e-3
"""How far R R^T may be from the identity (largest entry): poses written with few digits pass."""


@dataclass(frozen=True, eq=False)
class Pose:
    """A rigid transformation, named `a_from_b`: it maps points of frame b to frame a.

    Adjacent frames match when composed: `world_from_base @ base_from_camera`.

    Attributes:
        matrix: (4, 4) float64, read-only; the upper left 3 x 3 block is a rotation.
    """

    matrix: NDArray[np.float64]

    def __post_init__(self) -> None:
        matrix = np.array(self.matrix, dtype=np.float64)
        if matrix.shape != (4, 4):
            raise PoseError(f"a pose is a 4 x 4 matrix, not {matrix.shape}")
        if not np.isfinite(matrix).all():
            raise PoseError("a pose holds NaN or infinity")
        if not np.allclose(matrix[3], (0.0, 0.0, 0.0, 1.0), atol=1e-6):
            raise PoseError(f"the last row of a pose is 0 0 0 1, not {matrix[3].tolist()}")
        rotation = matrix[:3, :3]
        error = float(np.abs(rotation @ rotation.T - np.eye(3)).max())
        if error > ROTATION_TOLERANCE or np.linalg.det(rotation) < 0.0:
            raise PoseError(
                "the upper left 3 x 3 block of a pose is not a rotation "
                f"(R R^T is off by {error:.2g}, det R = {np.linalg.det(rotation):.2g})"
            )
        matrix.setflags(write=False)
        object.__setattr__(self, "matrix", matrix)

    @classmethod
    def identity(cls) -> Pose:
        """The transformation that moves nothing."""
        return cls(np.eye(4))

    @classmethod
    def from_rotation(cls, rotation: ArrayLike, translation: ArrayLike) -> Pose:
        """Build from a (3, 3) rotation matrix and a (3,) translation in metres."""
        matrix = np.eye(4)
        matrix[:3, :3] = rotation
        matrix[:3, 3] = translation
        return cls(matrix)

    @classmethod
    def from_quaternion(cls, quaternion_xyzw: Sequence[float], translation: ArrayLike) -> Pose:
        """Build from a quaternion (x, y, z, w), normalised here, and a translation in metres."""
        quaternion = np.asarray(quaternion_xyzw, dtype=np.float64)
        if quaternion.shape != (4,) or not np.linalg.norm(quaternion) > 1e-9:
            raise PoseError(f"not a quaternion (x, y, z, w): {list(quaternion_xyzw)}")
        return cls.from_rotation(Rotation.from_quat(quaternion).as_matrix(), translation)

    @classmethod
    def from_yaw(cls, yaw: float, translation: ArrayLike) -> Pose:
        """Build from a yaw about +z (radians, counter-clockwise from +x) and a translation."""
        return cls.from_rotation(Rotation.from_euler("z", yaw).as_matrix(), translation)

    @property
    def rotation(self) -> NDArray[np.float64]:
        """(3, 3) rotation matrix."""
        return self.matrix[:3, :3]

    @property
    def translation(self) -> NDArray[np.float64]:
        """(3,) metres."""
        return self.matrix[:3, 3]

    @property
    def quaternion_xyzw(self) -> NDArray[np.float64]:
        """(4,) unit quaternion (x, y, z, w) with w >= 0."""
        quaternion: NDArray[np.float64] = Rotation.from_matrix(self.rotation).as_quat(
            canonical=True
        )
        return quaternion

    @property
    def yaw(self) -> float:
        """Heading of the frame's x axis in the parent's xy plane, radians in (-pi, pi]."""
        return float(np.arctan2(self.matrix[1, 0], self.matrix[0, 0]))

    def inverse(self) -> Pose:
        """The transformation from a to b."""
        rotation = self.rotation.T
        return Pose.from_rotation(rotation, -rotation @ self.translation)

    def apply(self, points: ArrayLike) -> NDArray[np.float64]:
        """Map points of frame b, (..., 3), to frame a."""
        return np.asarray(points, dtype=np.float64) @ self.rotation.T + self.translation

    def __matmul__(self, other: Pose) -> Pose:
        return Pose(self.matrix @ other.matrix)
