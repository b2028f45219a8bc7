"""Messages of an RGB-D camera as observations; works on rclpy's messages and on those of a bag."""

from __future__ import annotations

import json
import math
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from toponav.errors import ObservationError
from toponav.geometry import Intrinsics, Pose
from toponav.geometry.conventions import BODY_FROM_OPTICAL
from toponav.robot.config import CameraConfig
from toponav.robot.frame_sync import Instant
from toponav.robot.frame_tree import FrameTree
from toponav.robot.images import (
    colour_image,
    compressed_depth_image,
    compressed_image,
    depth_image,
    label_image,
)
from toponav.robot.labels import LabelImageDetector
from toponav.types import Observation

COLOR, DEPTH, LABELS = "color", "depth", "labels"
"""Kinds of images."""

TRANSFORMS, STATIC_TRANSFORMS = TRANSFORM_TOPICS = ("/tf", "/tf_static")
"""Where the frames of a robot lie to each other."""


class FrameReader:
    """Knows the camera, and makes an observation of what it took."""

    def __init__(self, camera: CameraConfig, labels: LabelImageDetector | None = None) -> None:
        """Know where the camera sits.

        Args:
            camera: Of the robot.
            labels: Shown the label image of each observation; None where there are none.
        """
        self._camera, self._labels = camera, labels
        self._frames = FrameTree() if camera.extrinsics == "tf" else None
        self.base_from_camera = None if self._frames is not None else camera_mount(camera)
        """Where the camera sits; None until /tf has told, where that is to tell."""
        self._optical_frame = ""
        self.intrinsics: Intrinsics | None = None
        self._names: tuple[str, ...] | None = None

    @property
    def kinds(self) -> tuple[str, ...]:
        """The images that belong to an instant; the first gives it its time."""
        return (DEPTH, COLOR) if self._labels is None else (DEPTH, COLOR, LABELS)

    @property
    def lacks(self) -> str:
        """What is still to come before an observation can be made; empty when all has."""
        if self.intrinsics is None:
            return f"no camera info on {self._camera.info_topic}"
        if self._labels is not None and self._names is None:
            return f"no label names on {self._camera.names_topic}"
        if self.base_from_camera is None:
            return f"no transform from {self._camera.base_frame} to {self._optical_frame} on /tf"
        return ""

    def take_info(self, message: Any) -> None:
        """Take a sensor_msgs/CameraInfo."""
        k = message.k if hasattr(message, "k") else message.K
        if self._frames is not None and self._optical_frame != message.header.frame_id:
            self._optical_frame = message.header.frame_id
            self._place_camera()
        size = int(message.width), int(message.height)
        self.intrinsics = Intrinsics(*size, float(k[0]), float(k[4]), float(k[2]), float(k[5]))

    def take_transforms(self, message: Any) -> None:
        """Take a tf2_msgs/TFMessage; without extrinsics from /tf it is ignored."""
        if self._frames is not None:
            self._frames.take(message)
            self._place_camera()

    def _place_camera(self) -> None:
        if self._frames is not None:
            frames = self._camera.base_frame, self._optical_frame
            self.base_from_camera = self._frames.between(*frames)

    def take_names(self, message: Any) -> None:
        """Take a std_msgs/String with a JSON list of names; anything else is ignored."""
        try:
            names = json.loads(message.data)
        except ValueError:
            return
        if isinstance(names, list):
            self._names = tuple(map(str, names))

    def depth(self, message: Any) -> NDArray[np.float32]:
        """(H, W) metres within the camera's range, 0 elsewhere."""
        if hasattr(message, "format"):
            depth = compressed_depth_image(message.format, message.data)
        else:
            size = int(message.height), int(message.width)
            depth = depth_image(message.encoding, size, int(message.step), message.data)
        depth[(depth < self._camera.min_depth_m) | (depth > self._camera.max_depth_m)] = 0.0
        return depth

    def observation(self, instant: Instant) -> Observation:
        """What was seen.

        Raises:
            ObservationError: An image of another size or encoding, or not all has come yet.
        """
        mount = self.base_from_camera
        if self.intrinsics is None or mount is None or self.lacks:
            raise ObservationError(self.lacks)
        color = instant.parts[COLOR]
        if hasattr(color, "format"):
            rgb = compressed_image(color.data)
        else:
            size = int(color.height), int(color.width)
            rgb = colour_image(color.encoding, size, int(color.step), color.data)
        if self._labels is not None and self._names is not None:
            message = instant.parts[LABELS]
            size = int(message.height), int(message.width)
            ids = label_image(message.encoding, size, int(message.step), message.data)
            self._labels.show(ids, self._names)
        return Observation(
            rgb=rgb,
            depth=self.depth(instant.parts[DEPTH]),
            world_from_camera=instant.world_from_base @ mount,
            world_from_base=instant.world_from_base,
            intrinsics=self.intrinsics,
            timestamp_s=instant.stamp_s,
        )


def camera_mount(camera: CameraConfig) -> Pose:
    """`base_from_camera` (optical) as the robot's file says."""
    down = Rotation.from_euler("y", math.radians(camera.tilt_deg)).as_matrix()
    return Pose.from_rotation(down, camera.xyz) @ BODY_FROM_OPTICAL


def seconds_of(stamp: Any) -> float:
    """Of a builtin_interfaces/Time."""
    nanoseconds = stamp.nanosec if hasattr(stamp, "nanosec") else stamp.nsec
    return float(stamp.sec + 1e-9 * nanoseconds)


def pose_of(message: Any) -> Pose:
    """Of an Odometry, PoseStamped or PoseWithCovarianceStamped.

    Raises:
        PoseError: The quaternion is none.
    """
    pose = message.pose
    while not hasattr(pose, "orientation"):
        pose = pose.pose
    at, turn = pose.position, pose.orientation
    return Pose.from_quaternion((turn.x, turn.y, turn.z, turn.w), (at.x, at.y, at.z))
