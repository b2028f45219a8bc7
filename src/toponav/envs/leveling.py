"""Which way is up in a recording, and where its floor lies, from the geometry of its frames."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from toponav.geometry import Intrinsics, Pose, back_project

BLOCKS_ACROSS = 80
"""Depth is averaged over blocks, this many a row (8 pixels a side of 640), so that noise hardly
tilts a normal."""

EDGE_SPREAD = 0.05
"""A block whose depths spread by more than this share of their mean lies on an edge."""

SHRINKING_CONES_DEG = (45.0, 30.0, 15.0, 8.0, 5.0, 5.0)
"""Normals within these angles of the last estimate of up make the next one."""

LEVEL_CONE_DEG = 10.0
"""A patch is level when its normal is within this angle of up."""

MIN_LEVEL_PATCHES = 200
"""Fewer level patches than this say nothing about up or the floor."""

HEIGHT_BIN_M = 0.05
"""Width of the bins in which the floor is sought, metres."""

FLOOR_SHARE = 0.05
"""The floor is the lowest bin with this share of the fullest one's patches. Hand-held cameras see
table tops far better than the floor (by 5 to 1 in 7-Scenes' kitchen); reflections and noise below
the floor stay well under it."""


@dataclass(frozen=True, eq=False)
class SurfacePatches:
    """Small surface patches seen in some frames.

    Attributes:
        points: (N, 3) centres, world frame, metres.
        normals: (N, 3) unit normals that point to the camera.
    """

    points: NDArray[np.float64]
    normals: NDArray[np.float64]

    def rotated(self, rotation: NDArray[np.float64]) -> SurfacePatches:
        """The patches in a world frame turned by a (3, 3) rotation."""
        return SurfacePatches(self.points @ rotation.T, self.normals @ rotation.T)

    @classmethod
    def of_frame(
        cls, depth: NDArray[np.float32], intrinsics: Intrinsics, world_from_camera: Pose
    ) -> SurfacePatches:
        """Patches of one (H, W) depth image in metres."""
        side = max(1, depth.shape[1] // BLOCKS_ACROSS)
        rows, columns = depth.shape[0] // side, depth.shape[1] // side
        cut = (slice(0, rows * side), slice(0, columns * side))
        xyz = back_project(depth, intrinsics)[cut]
        blocks = xyz.reshape(rows, side, columns, side, 3)
        z = depth[cut].reshape(rows, side, columns, side)
        smooth = (z.min(axis=(1, 3)) > 0.0) & (
            np.ptp(z, axis=(1, 3)) < EDGE_SPREAD * z.mean(axis=(1, 3))
        )
        centers = blocks.mean(axis=(1, 3))
        across = centers[1:-1, 2:] - centers[1:-1, :-2]
        down = centers[2:, 1:-1] - centers[:-2, 1:-1]
        normals = np.cross(down, across)
        length = np.linalg.norm(normals, axis=-1)
        center = centers[1:-1, 1:-1]
        valid = smooth[1:-1, 1:-1] & smooth[1:-1, 2:] & smooth[1:-1, :-2] & (length > 0.0)
        valid &= smooth[2:, 1:-1] & smooth[:-2, 1:-1]
        # A neighbour across a depth edge is a different surface.
        extent = np.maximum(np.abs(across[..., 2]), np.abs(down[..., 2]))
        valid &= extent < 4.0 * EDGE_SPREAD * center[..., 2]
        unit = normals[valid] / length[valid, None]
        unit *= -np.sign(np.sum(unit * center[valid], axis=1))[:, None]
        return cls(world_from_camera.apply(center[valid]), unit @ world_from_camera.rotation.T)


def estimate_up(patches: SurfacePatches) -> NDArray[np.float64] | None:
    """The direction in which floors and table tops face.

    Args:
        patches: In a world frame whose z axis is up to within 45 degrees.

    Returns:
        (3,) unit vector, or None when too few surfaces face one way.
    """
    up = np.array([0.0, 0.0, 1.0])
    for cone in SHRINKING_CONES_DEG:
        near = patches.normals @ up > math.cos(math.radians(cone))
        if np.count_nonzero(near) < MIN_LEVEL_PATCHES:
            return None
        up = patches.normals[near].mean(axis=0)
        up /= np.linalg.norm(up)
    return up


def leveling_rotation(up: NDArray[np.float64]) -> NDArray[np.float64]:
    """The least (3, 3) rotation that turns the unit vector `up` to +z."""
    z_axis = np.array([0.0, 0.0, 1.0])
    axis = np.cross(up, z_axis)
    sine = float(np.linalg.norm(axis))
    if sine == 0.0:
        return np.eye(3)
    angle = math.atan2(sine, float(up @ z_axis))
    matrix: NDArray[np.float64] = Rotation.from_rotvec(axis / sine * angle).as_matrix()
    return matrix


def estimate_floor(patches: SurfacePatches) -> float | None:
    """Height of the lowest level surface of some extent.

    Args:
        patches: In a world frame whose z axis is up.

    Returns:
        z_floor in metres, or None when too few surfaces are level.
    """
    level = patches.normals[:, 2] > math.cos(math.radians(LEVEL_CONE_DEG))
    heights = patches.points[level, 2]
    if len(heights) < MIN_LEVEL_PATCHES:
        return None
    bins = np.floor(heights / HEIGHT_BIN_M).astype(np.int64)
    values, counts = np.unique(bins, return_counts=True)
    lowest = values[counts >= FLOOR_SHARE * counts.max()][0]
    return float(np.median(heights[np.abs(bins - lowest) <= 1]))
