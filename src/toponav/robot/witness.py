"""Somebody else on the robot's network: sees it move, and calls the node's services."""

from __future__ import annotations

import time
from collections.abc import Callable
from types import TracebackType
from typing import Any

from toponav.errors import TopoNavError
from toponav.robot.ros2_import import import_ros


class Witness:
    """A node of its own context, used as a context manager."""

    def __init__(self, domain: int, pose_topic: str = "odom") -> None:
        """Join the DDS domain.

        Raises:
            MissingExtraError: ROS 2 is not installed.
        """
        rclpy = import_ros("rclpy")
        self._context = import_ros("rclpy.context").Context()
        rclpy.init(context=self._context, domain_id=domain)
        self.node = rclpy.create_node("witness", context=self._context)
        self._executor = import_ros("rclpy.executors").SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self.node)
        self.speed = 0.0
        sensing = import_ros("rclpy.qos").qos_profile_sensor_data
        odometry = import_ros("nav_msgs.msg").Odometry
        self.node.create_subscription(odometry, pose_topic, self._odometry, sensing)

    def __enter__(self) -> Witness:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Leave."""
        self._executor.shutdown(timeout_sec=1.0)
        self.node.destroy_node()
        self._context.try_shutdown()

    def wait(self, until: Callable[[], bool], timeout_s: float, what: str) -> None:
        """Spin until something is so.

        Raises:
            TopoNavError: It is not within the time; `what` names it.
        """
        end_s = time.monotonic() + timeout_s
        while not until():
            if time.monotonic() > end_s:
                raise TopoNavError(f"waited {timeout_s:.0f} s in vain for {what}")
            self._executor.spin_once(timeout_sec=0.02)

    def wait_for_speed(self, speed: float, timeout_s: float) -> None:
        """Until the robot drives at `speed` (m/s).

        Raises:
            TopoNavError: It does not within the time.
        """
        self.wait(lambda: self.speed >= speed, timeout_s, f"a robot at {speed} m/s")

    def call(self, service: str, name: str, timeout_s: float = 10.0, **values: Any) -> float:
        """Call a std_srvs service of a kind; when it was called, by time.time().

        Raises:
            TopoNavError: Nobody offers it or answers.
        """
        kind = getattr(import_ros("std_srvs.srv"), service)
        client = self._client(kind, name, timeout_s)
        called_s = time.time()
        self._answer(client, kind.Request(**values), timeout_s)
        return called_s

    def ask(self, kind: Any, name: str, request: Any, timeout_s: float) -> Any:
        """Call a service of any kind; its response.

        Raises:
            TopoNavError: Nobody offers it or answers.
        """
        return self._answer(self._client(kind, name, timeout_s), request, timeout_s)

    def _client(self, kind: Any, name: str, timeout_s: float) -> Any:
        client = self.node.create_client(kind, name)
        self.wait(client.service_is_ready, timeout_s, name)
        return client

    def _answer(self, client: Any, request: Any, timeout_s: float) -> Any:
        answer = client.call_async(request)
        self.wait(answer.done, timeout_s, f"an answer of {client.service_name}")
        return answer.result()

    def _odometry(self, message: Any) -> None:
        self.speed = message.twist.twist.linear.x
