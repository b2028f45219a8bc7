"""Recordings of posed RGB-D frames: folders in the layout of 7-Scenes.

    camera-intrinsics.txt     3 x 3 matrix K
    frame-000000.color.jpg    or .png
    frame-000000.depth.png    16 bit; 0 and 65535 are no return
    frame-000000.pose.txt     4 x 4 world_from_camera, optical axes
    recording.json            optional, see `RecordingMetadata`

Such recordings say neither which axis of their world points up nor where the floor is; what the
metadata or the caller leaves open is estimated from the frames.
"""

from __future__ import annotations

import json
import math
import re
import zlib
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from PIL import Image
from pydantic import Field, ValidationError

from toponav.config_model import ConfigModel
from toponav.envs.leveling import (
    SurfacePatches,
    estimate_floor,
    estimate_up,
    leveling_rotation,
)
from toponav.errors import InputError, PoseError, RecordingError
from toponav.geometry import Intrinsics, Pose
from toponav.geometry.conventions import WORLD_FROM_HABITAT
from toponav.types import Observation

WorldAxes = Literal["z-up", "y-up", "y-down"]
"""Which way a recording's world points up."""

WORLD_FROM_AXES: dict[WorldAxes, Pose] = {
    "z-up": Pose.identity(),
    "y-up": WORLD_FROM_HABITAT,
    "y-down": Pose.from_rotation(
        np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]]), np.zeros(3)
    ),
}
"""Our world (z up) from a recording's: y-down is (x, y, z) -> (x, z, -y)."""

NO_RETURN = 65535
"""Depth value that 7-Scenes writes where the sensor saw nothing, besides 0."""

SURVEY_FRAMES = 40
"""Frames, evenly spread, from which up and the floor are estimated."""

SURVEY_DEPTH_M = 4.0
"""Depth beyond this is too noisy to tell which way a surface faces (Kinect)."""

UPRIGHT_DEG = 50.0
"""A camera's mean up must be this near to an axis for that axis to be taken as up."""

TRUSTED_TILT_DEG = 0.5
"""A smaller tilt than this is within the error of its estimate and left alone."""

VERTICAL_VIEW = 1e-3
"""Horizontal part of a unit viewing direction under which it has no heading."""

FRAME_FILE = re.compile(
    r"frame-(?P<number>\d+)\.(?P<kind>color|depth|pose)\.(?:jpg|jpeg|png|txt)", re.IGNORECASE
)

INTRINSICS_FILE = "camera-intrinsics.txt"
METADATA_FILE = "recording.json"


class RecordingMetadata(ConfigModel):
    """What `recording.json` may say."""

    world: WorldAxes | None = None
    """Which axis of the recording's world points up; estimated from the cameras when left out."""

    gravity_aligned: bool = False
    """Whether that axis is exactly vertical; otherwise the tilt is estimated and removed."""

    depth_scale: float = Field(default=0.001, gt=0.0)
    """Metres a depth unit."""

    camera_height: float | None = Field(default=None, gt=0.0)
    """Height of the camera over the floor that the agent stands on, metres, when it is fixed."""

    floor_z: float | None = None
    """Height of the floor in the z-up world, metres; estimated when this and `camera_height` are
    left out."""

    frame_rate_hz: float = Field(default=30.0, gt=0.0)
    """Frame numbers a second."""


@dataclass(frozen=True)
class FrameFiles:
    """The files of one frame."""

    number: int
    color: Path
    depth: Path
    pose: Path


@dataclass(frozen=True, eq=False)
class Recording:
    """Posed RGB-D frames in a z-up world; iterating reads them one by one.

    Attributes:
        path: The folder.
        frames: The files, in order.
        poses: world_from_camera of each frame, z up.
        intrinsics: The camera of both images.
        metadata: What is known of the recording.
        floor_z: Height of the floor, metres; None when `metadata.camera_height` tells it.
    """

    path: Path
    frames: tuple[FrameFiles, ...]
    poses: tuple[Pose, ...]
    intrinsics: Intrinsics
    metadata: RecordingMetadata
    floor_z: float | None

    def __len__(self) -> int:
        return len(self.frames)

    def __iter__(self) -> Iterator[Observation]:
        return (self.observation(index) for index in range(len(self)))

    def every(self, n: int) -> Recording:
        """The recording thinned to its first frame and every n-th after it.

        Raises:
            InputError: n is not positive.
        """
        if n < 1:
            raise InputError(f"every n-th frame: n is at least 1, not {n}")
        return replace(self, frames=self.frames[::n], poses=self.poses[::n])

    def observation(self, index: int) -> Observation:
        """Read one frame.

        Raises:
            RecordingError: An image is damaged or not of the camera's size; names the file.
        """
        frame, pose = self.frames[index], self.poses[index]
        size = (self.intrinsics.width, self.intrinsics.height)
        x, y, z = (float(value) for value in pose.translation)
        height = self.metadata.camera_height
        floor_z = z - height if height is not None else self.floor_z
        if floor_z is None:
            raise RecordingError(f"{self.path}: neither floor_z nor camera_height is known")
        return Observation(
            rgb=_read_color(frame.color, size),
            depth=_read_depth(frame.depth, size, self.metadata.depth_scale),
            world_from_camera=pose,
            world_from_base=Pose.from_yaw(_heading(pose), (x, y, floor_z)),
            intrinsics=self.intrinsics,
            step=index,
            timestamp_s=frame.number / self.metadata.frame_rate_hz,
        )


def open_recording(path: Path, world: WorldAxes | None = None) -> Recording:
    """Open a folder of posed RGB-D frames.

    All poses are read at once; images are read when they are asked for, but for those that tell
    what the metadata leaves open.

    Args:
        path: The folder.
        world: Which axis of its world points up; overrides the metadata.

    Raises:
        RecordingError: A file is missing or damaged, or up or the floor cannot be told; one line
            that names the file and says how to mend it.
    """
    metadata = _read_metadata(path / METADATA_FILE)
    frames = _find_frames(path)
    poses = [_read_pose(frame.pose) for frame in frames]
    intrinsics = _read_intrinsics(path / INTRINSICS_FILE, frames[0].depth)
    axes = world or metadata.world or _upward_axes(path, poses)
    turned = [WORLD_FROM_AXES[axes] @ pose for pose in poses]
    floor_known = metadata.camera_height is not None or metadata.floor_z is not None
    floor_z = metadata.floor_z
    if not (metadata.gravity_aligned and floor_known):
        patches = _survey(frames, turned, intrinsics, metadata.depth_scale)
        if not metadata.gravity_aligned:
            level = _leveling(patches)
            turned = [Pose.from_rotation(level, np.zeros(3)) @ pose for pose in turned]
            patches = patches.rotated(level)
        if not floor_known:
            floor_z = _floor_height(path, patches)
    return Recording(path, frames, tuple(turned), intrinsics, metadata, floor_z)


def _find_frames(path: Path) -> tuple[FrameFiles, ...]:
    """All frames of a folder by number, each with its three files."""
    if not path.is_dir():
        raise RecordingError(f"{path} is not a folder of posed RGB-D frames")
    files: dict[int, dict[str, Path]] = {}
    for file in sorted(path.iterdir()):
        match = FRAME_FILE.fullmatch(file.name)
        if match:
            files.setdefault(int(match["number"]), {})[match["kind"]] = file
    if not files:
        raise RecordingError(
            f"{path} holds no frames: frame-000000.color.jpg, .depth.png and .pose.txt are expected"
        )
    frames = []
    for number, found in sorted(files.items()):
        for kind in ("color", "depth", "pose"):
            if kind not in found:
                present = next(iter(found.values()))
                raise RecordingError(f"{present} has no .{kind} file beside it: add or remove it")
        frames.append(FrameFiles(number, found["color"], found["depth"], found["pose"]))
    return tuple(frames)


def _read_metadata(path: Path) -> RecordingMetadata:
    if not path.exists():
        return RecordingMetadata()
    try:
        return RecordingMetadata.model_validate(json.loads(path.read_text(encoding="utf-8")))
    except ValidationError as error:
        first = error.errors()[0]
        key = ".".join(str(part) for part in first["loc"]) or "the whole"
        raise RecordingError(f"{path}: {key}: {first['msg']}") from error
    except (OSError, ValueError) as error:
        raise RecordingError(f"{path} is not readable JSON: {error}") from error


def _read_matrix(path: Path, side: int) -> NDArray[np.float64]:
    """A (side, side) matrix of numbers separated by white space."""
    try:
        values = [float(word) for word in path.read_text(encoding="utf-8").split()]
    except (OSError, ValueError) as error:
        raise RecordingError(f"{path} is not a readable {side} x {side} matrix: {error}") from error
    if len(values) != side * side:
        raise RecordingError(f"{path} holds {len(values)} numbers instead of {side} x {side}")
    return np.array(values).reshape(side, side)


def _read_pose(path: Path) -> Pose:
    try:
        return Pose(_read_matrix(path, 4))
    except PoseError as error:
        raise RecordingError(f"{path}: {error}: mend it or remove the frame") from error


def _read_intrinsics(path: Path, image: Path) -> Intrinsics:
    """The camera, of the size of a depth image."""
    if not path.exists():
        raise RecordingError(f"{path} is missing: write the 3 x 3 camera matrix into it")
    K = _read_matrix(path, 3)
    height, width = _read_image(image).shape[:2]
    (fx, skew, cx), (_, fy, cy) = K[0], K[1]
    pinhole = np.allclose([skew, K[1, 0], *K[2]], [0.0, 0.0, 0.0, 0.0, 1.0], atol=1e-6)
    if not (pinhole and 0.0 < cx < width and 0.0 < cy < height):
        raise RecordingError(
            f"{path} is not the camera matrix of {width} x {height} images "
            f"(fx {fx:g}, fy {fy:g}, cx {cx:g}, cy {cy:g}): scale it to their size"
        )
    try:
        return Intrinsics(width, height, float(fx), float(fy), float(cx), float(cy))
    except InputError as error:
        raise RecordingError(f"{path}: {error}") from error


def _read_image(path: Path) -> NDArray[np.generic]:
    """An image as it is stored."""
    try:
        with Image.open(path) as image:
            return np.asarray(image)
    except (OSError, ValueError, SyntaxError, EOFError, zlib.error) as error:
        raise RecordingError(f"{path} is damaged or not an image: {error}") from error


def _check_size(path: Path, image: NDArray[np.generic], size: tuple[int, int]) -> None:
    height, width = image.shape[:2]
    if (width, height) != size:
        raise RecordingError(
            f"{path} is {width} x {height}, the recording's camera {size[0]} x {size[1]}: "
            "resample the images to one size"
        )


def _read_color(path: Path, size: tuple[int, int]) -> NDArray[np.uint8]:
    """(H, W, 3) uint8."""
    image = _read_image(path)
    _check_size(path, image, size)
    if image.dtype != np.uint8 or image.ndim != 3 or image.shape[2] not in (3, 4):
        raise RecordingError(f"{path} is not an RGB image of 8 bits a channel")
    return np.ascontiguousarray(image[..., :3], dtype=np.uint8)


def _read_depth(path: Path, size: tuple[int, int], scale: float) -> NDArray[np.float32]:
    """(H, W) float32 metres; 0 where there is no return."""
    image = _read_image(path)
    _check_size(path, image, size)
    if image.ndim != 2 or image.dtype.kind not in "ui" or image.dtype.itemsize < 2:
        raise RecordingError(f"{path} is not a depth image of one channel of 16 bits")
    units = np.where(image == NO_RETURN, 0, image)
    return (units * scale).astype(np.float32)


def _upward_axes(path: Path, poses: list[Pose]) -> WorldAxes:
    """The axis nearest to the cameras' mean up: people and robots hold them upright."""
    up = -np.mean([pose.rotation[:, 1] for pose in poses], axis=0)
    up /= max(float(np.linalg.norm(up)), np.finfo(np.float64).tiny)
    heights = {axes: float((turn.rotation @ up)[2]) for axes, turn in WORLD_FROM_AXES.items()}
    best = max(heights, key=lambda axes: heights[axes])
    if heights[best] < math.cos(math.radians(UPRIGHT_DEG)):
        raise RecordingError(
            f"{path}: cannot tell which axis of its world points up: "
            f"say one of {', '.join(WORLD_FROM_AXES)}"
        )
    return best


def _survey(
    frames: tuple[FrameFiles, ...], poses: list[Pose], camera: Intrinsics, scale: float
) -> SurfacePatches:
    """Surface patches of some frames, evenly spread."""
    chosen = np.unique(np.linspace(0, len(frames) - 1, SURVEY_FRAMES).astype(int))
    points, normals = [], []
    for index in chosen:
        depth = _read_depth(frames[index].depth, (camera.width, camera.height), scale)
        depth[depth > SURVEY_DEPTH_M] = 0.0
        patches = SurfacePatches.of_frame(depth, camera, poses[index])
        points.append(patches.points)
        normals.append(patches.normals)
    return SurfacePatches(np.concatenate(points), np.concatenate(normals))


def _leveling(patches: SurfacePatches) -> NDArray[np.float64]:
    """(3, 3) rotation that makes the recording's up vertical; the identity when it is unknown."""
    up = estimate_up(patches)
    if up is None or up[2] > math.cos(math.radians(TRUSTED_TILT_DEG)):
        return np.eye(3)
    return leveling_rotation(up)


def _floor_height(path: Path, patches: SurfacePatches) -> float:
    floor_z = estimate_floor(patches)
    if floor_z is None:
        raise RecordingError(
            f"{path}: no floor is seen in the frames: "
            f"write floor_z or camera_height into {path / METADATA_FILE}"
        )
    return floor_z


def _heading(world_from_camera: Pose) -> float:
    """Yaw of the viewing direction; of the image's upper edge when the camera looks straight down.

    Radians.
    """
    forward, up = world_from_camera.rotation[:, 2], -world_from_camera.rotation[:, 1]
    level = forward if np.hypot(forward[0], forward[1]) > VERTICAL_VIEW else up
    return math.atan2(level[1], level[0])
