"""Recording a robot's topics, or what its search looked at, as a bag."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from toponav.robot.bag_writer import BagWriter, type_name
from toponav.robot.config import RobotConfig
from toponav.robot.frame_sync import Instant
from toponav.robot.frames import COLOR, DEPTH, LABELS
from toponav.robot.intent import Intent
from toponav.robot.ros2_import import import_ros
from toponav.robot.ros2_node import SearchNode
from toponav.robot.ros2_run import interrupts


class SearchRecorder:
    """Writes every image that the agent was shown, and all poses: what its map was made of."""

    def __init__(self, node: SearchNode, bag: BagWriter, robot: RobotConfig) -> None:
        """Watch a node."""
        self._node, self._bag = node, bag
        camera = robot.camera
        self._topics = {
            DEPTH: camera.depth_topic,
            COLOR: camera.color_topic,
            LABELS: camera.labels_topic,
        }
        self._beside = {robot.pose_topic, camera.info_topic, camera.names_topic}
        self._serialize = import_ros("rclpy.serialization").serialize_message
        node.on_message = self._came
        node.search.watchers.append(self)

    def __call__(self, instant: Instant, intent: Intent | None) -> None:
        """Called in the agent's thread."""
        del intent
        for kind, message in instant.parts.items():
            self._write(self._topics[kind], message)

    def _came(self, topic: str, message: Any) -> None:
        if topic in self._beside:
            self._write(topic, message)

    def _write(self, topic: str, message: Any) -> None:
        name = self._node.node.resolve_topic_name(topic)
        kind = type_name(type(message))
        self._bag.write(name, kind, self._node.now_s(), self._serialize(message))


def record(robot: RobotConfig, path: Path, seconds: float, say: Callable[[str], None]) -> int:
    """Record a robot's topics as they come, until the time is up or the process is interrupted.

    Returns:
        Messages recorded.

    Raises:
        InputError: The bag cannot be made.
    """
    rclpy = import_ros("rclpy")
    handlers = import_ros("rclpy.signals").SignalHandlerOptions
    stopped = threading.Event()
    with interrupts(stopped), BagWriter(path) as bag:
        rclpy.init(signal_handler_options=handlers.NO)
        node = rclpy.create_node("toponav_record")
        _subscribe(node, robot, bag)
        executor = import_ros("rclpy.executors").SingleThreadedExecutor()
        executor.add_node(node)
        say(f"recording to {path}; Ctrl-C ends it")
        until_s = time.monotonic() + seconds
        try:
            while not stopped.is_set() and time.monotonic() < until_s:
                executor.spin_once(timeout_sec=0.1)
        finally:
            executor.shutdown(timeout_sec=1.0)
            rclpy.try_shutdown()
    return bag.messages


def _subscribe(node: Any, robot: RobotConfig, bag: BagWriter) -> None:
    sensor, std = import_ros("sensor_msgs.msg"), import_ros("std_msgs.msg")
    package = "nav_msgs.msg" if robot.pose_type == "Odometry" else "geometry_msgs.msg"
    qos, camera = import_ros("rclpy.qos"), robot.camera
    latched = qos.QoSProfile(depth=1, durability=qos.DurabilityPolicy.TRANSIENT_LOCAL)
    sensing = qos.QoSProfile(depth=50, reliability=qos.ReliabilityPolicy.BEST_EFFORT)
    topics = {
        camera.info_topic: (sensor.CameraInfo, sensing),
        camera.names_topic: (std.String, latched),
        robot.pose_topic: (getattr(import_ros(package), robot.pose_type), sensing),
    }
    for topic in (camera.color_topic, camera.depth_topic, camera.labels_topic):
        packed = topic.endswith("/compressed")
        topics[topic] = (sensor.CompressedImage if packed else sensor.Image, sensing)
    for topic, (kind, profile) in topics.items():
        name, text = node.resolve_topic_name(topic), type_name(kind)

        def came(data: bytes, name: str = name, text: str = text) -> None:
            bag.write(name, text, time.time(), data)

        node.create_subscription(kind, topic, came, profile, raw=True)
