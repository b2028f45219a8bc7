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
from toponav.robot.frames import COLOR, DEPTH, LABELS, TRANSFORM_TOPICS
from toponav.robot.intent import Intent
from toponav.robot.ros2_import import import_ros
from toponav.robot.ros2_node import SearchNode
from toponav.robot.ros2_run import interrupts
from toponav.robot.ros2_topics import robot_topics

WAITING = 50
"""Messages of a topic that may wait to be written."""


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
        self._beside = {robot.pose_topic, camera.info_topic, camera.names_topic, *TRANSFORM_TOPICS}
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
    for topic, (kind, profile) in robot_topics(robot, WAITING, labels=True).items():
        name, text = node.resolve_topic_name(topic), type_name(kind)

        def came(data: bytes, name: str = name, text: str = text) -> None:
            bag.write(name, text, time.time(), data)

        node.create_subscription(kind, topic, came, profile, raw=True)
