"""A synthetic recording: a hand-held camera in a hall with a wall across."""

import json
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image
from scipy.spatial.transform import Rotation

from toponav.geometry import Intrinsics, Pose
from toponav.geometry.conventions import BODY_FROM_OPTICAL

CAMERA = Intrinsics.from_hfov(160, 120, 79.0)
FLOOR_Z = -0.4
CAMERA_HEIGHT = 1.1


def camera_pose(x: float, yaw: float, pitch_down: float = 0.45) -> Pose:
    """A hand-held camera over the floor, in the z-up world."""
    tilt = Pose.from_rotation(Rotation.from_euler("y", pitch_down).as_matrix(), np.zeros(3))
    return Pose.from_yaw(yaw, (x, 0.0, FLOOR_Z + CAMERA_HEIGHT)) @ tilt @ BODY_FROM_OPTICAL


def hall_depth(pose: Pose) -> NDArray[np.float64]:
    """Depth of a hall: the floor, and a wall at x = 3."""
    rays = CAMERA.rays() @ pose.rotation.T
    origin = pose.translation
    with np.errstate(divide="ignore"):
        floor = np.where(rays[..., 2] < 0.0, (FLOOR_Z - origin[2]) / rays[..., 2], np.inf)
        wall = np.where(rays[..., 0] > 0.0, (3.0 - origin[0]) / rays[..., 0], np.inf)
    depth = np.minimum(floor, wall)
    return np.where(depth < 6.0, depth, 0.0)


def write_recording(
    folder: Path, world_from_z_up: Pose, count: int = 6, metadata: dict[str, object] | None = None
) -> list[Pose]:
    """A synthetic recording in some other world; returns the poses in the z-up one."""
    folder.mkdir(exist_ok=True)
    np.savetxt(folder / "camera-intrinsics.txt", CAMERA.matrix)
    poses = [camera_pose(0.2 * k, 0.3 * k - 0.7) for k in range(count)]
    for k, pose in enumerate(poses):
        stem = folder / f"frame-{10 * k:06d}"
        rgb = np.full((CAMERA.height, CAMERA.width, 3), (k, 20, 30), np.uint8)
        Image.fromarray(rgb).save(f"{stem}.color.png")
        millimetres = np.rint(1000.0 * hall_depth(pose)).astype(np.uint16)
        millimetres[0, 0], millimetres[0, 1] = 65535, 0
        Image.fromarray(millimetres).save(f"{stem}.depth.png")
        np.savetxt(f"{stem}.pose.txt", (world_from_z_up @ pose).matrix)
    if metadata is not None:
        (folder / "recording.json").write_text(json.dumps(metadata))
    return poses
