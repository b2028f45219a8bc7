"""What a robot publishes that a search needs: the type of each topic, and its QoS."""

from __future__ import annotations

from typing import Any

from toponav.errors import MissingExtraError
from toponav.robot.config import RobotConfig
from toponav.robot.frames import STATIC_TRANSFORMS, TRANSFORMS
from toponav.robot.ros2_import import import_ros

TRANSFORMS_KEPT = 100
"""Every broadcaster of /tf_static sends once, and the last of each must come."""


def robot_topics(robot: RobotConfig, depth: int, *, labels: bool) -> dict[str, tuple[Any, Any]]:
    """Message class and QoS profile of each topic.

    Args:
        robot: Names them.
        depth: Images and poses that may wait.
        labels: Whether label images are among them.

    Raises:
        MissingExtraError: A message's package is not installed.
    """
    sensor, std = import_ros("sensor_msgs.msg"), import_ros("std_msgs.msg")
    package = "nav_msgs.msg" if robot.pose_type == "Odometry" else "geometry_msgs.msg"
    qos, camera = import_ros("rclpy.qos"), robot.camera
    sensing = qos.QoSProfile(depth=depth, reliability=qos.ReliabilityPolicy.BEST_EFFORT)
    latched = qos.QoSProfile(depth=1, durability=qos.DurabilityPolicy.TRANSIENT_LOCAL)
    images = [camera.color_topic, camera.depth_topic]
    topics = {
        camera.info_topic: (sensor.CameraInfo, sensing),
        robot.pose_topic: (getattr(import_ros(package), robot.pose_type), sensing),
    }
    if labels:
        images.append(camera.labels_topic)
        topics[camera.names_topic] = (std.String, latched)
    for topic in images:
        packed = topic.endswith(("/compressed", "/compressedDepth"))
        topics[topic] = (sensor.CompressedImage if packed else sensor.Image, sensing)
    return topics | (_transform_topics() if camera.extrinsics == "tf" else {})


def _transform_topics() -> dict[str, tuple[Any, Any]]:
    try:
        transforms = import_ros("tf2_msgs.msg").TFMessage
    except MissingExtraError as error:
        raise MissingExtraError(
            "tf2_msgs is missing, which comes with an installed ROS 2 alone (source its setup "
            "file): without it, camera.extrinsics is fixed, by xyz and tilt_deg"
        ) from error
    qos = import_ros("rclpy.qos")
    lasting = qos.DurabilityPolicy.TRANSIENT_LOCAL
    return {
        TRANSFORMS: (transforms, qos.QoSProfile(depth=TRANSFORMS_KEPT)),
        STATIC_TRANSFORMS: (
            transforms,
            qos.QoSProfile(depth=TRANSFORMS_KEPT, durability=lasting),
        ),
    }
