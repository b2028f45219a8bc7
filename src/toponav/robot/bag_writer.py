"""Writing bags of ROS 2 (rosbag2 folders with MCAP inside); no ROS is needed."""

from __future__ import annotations

import shutil
import threading
from pathlib import Path
from types import TracebackType
from typing import Any

from toponav.errors import InputError
from toponav.robot.bag_import import import_bags, message_types


class BagWriter:
    """Writes serialised messages; safe to use from any thread."""

    def __init__(self, path: Path) -> None:
        """Make the bag's folder.

        Raises:
            MissingExtraError: rosbags is not installed.
            InputError: The folder exists and is no bag, or cannot be made.
        """
        rosbag2 = import_bags("rosbags.rosbag2")
        if (path / "metadata.yaml").exists():
            shutil.rmtree(path)
        if path.exists():
            raise InputError(f"{path} exists and is no bag: choose another name")
        path.parent.mkdir(parents=True, exist_ok=True)
        self._types = message_types()
        self._writer = rosbag2.Writer(path, version=9, storage_plugin=rosbag2.StoragePlugin.MCAP)
        self._writer.open()
        self._connections: dict[str, Any] = {}
        self._lock = threading.Lock()
        self._open = True
        self.messages = 0

    def __enter__(self) -> BagWriter:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Finish the bag."""
        with self._lock:
            self._open = False
            self._writer.close()

    def write(self, topic: str, message_type: str, time_s: float, data: bytes) -> None:
        """Add a message; after the bag was finished, nothing.

        Args:
            topic: Its full name.
            message_type: Such as sensor_msgs/msg/Image.
            time_s: When it came.
            data: In CDR, as DDS carries it.
        """
        with self._lock:
            if not self._open:
                return
            connection = self._connections.get(topic)
            if connection is None:
                connection = self._writer.add_connection(topic, message_type, typestore=self._types)
                self._connections[topic] = connection
            self._writer.write(connection, round(time_s * 1e9), data)
            self.messages += 1


def type_name(message_class: Any) -> str:
    """`sensor_msgs/msg/Image` of rclpy's class."""
    package, kind, *_ = message_class.__module__.split(".")
    return f"{package}/{kind}/{message_class.__name__}"
