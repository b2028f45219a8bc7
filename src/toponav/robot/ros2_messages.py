"""Between arrays and ROS messages."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from toponav.geometry import Pose


def write_pose(message: Any, pose: Pose) -> None:
    """Fill a geometry_msgs/Pose."""
    position, orientation = message.position, message.orientation
    position.x, position.y, position.z = (float(v) for v in pose.translation)
    orientation.x, orientation.y, orientation.z, orientation.w = (
        float(v) for v in pose.quaternion_xyzw
    )


def write_image(message: Any, encoding: str, pixels: NDArray[Any]) -> None:
    """Fill a sensor_msgs/Image but for its header."""
    message.height, message.width = pixels.shape[:2]
    message.encoding, message.step = encoding, pixels.strides[0]
    message.data.frombytes(np.ascontiguousarray(pixels).tobytes())
