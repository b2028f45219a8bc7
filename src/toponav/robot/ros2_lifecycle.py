"""The node's life as ROS 2 manages it: configured, active, inactive, cleaned up, shut down."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol

from toponav.robot.ros2_import import import_ros


class Managed(Protocol):
    """What is managed."""

    def configure(self) -> None:
        """Listen to the robot."""
        ...

    def activate(self) -> None:
        """The robot may move from now on."""
        ...

    def deactivate(self) -> None:
        """Stand still from now on; the search waits."""
        ...

    def clean_up(self) -> None:
        """End the search, and listen no more."""
        ...

    def shut_down(self) -> None:
        """End for good."""
        ...


def create_managed_node(name: str) -> Any:
    """A node that any lifecycle manager can lead through its states; `rclpy.init` has been called.

    Raises:
        MissingExtraError: ROS 2 is not installed.
    """
    return import_ros("rclpy.lifecycle").LifecycleNode(name)


def let_manage(node: Any, managed: Managed, failures: list[str]) -> None:
    """Pass a node's transitions on; what goes wrong in one is added to `failures`, in words."""
    lifecycle = import_ros("rclpy.lifecycle")
    returns, base = lifecycle.TransitionCallbackReturn, lifecycle.ManagedEntity

    def outcome(work: Callable[[], None]) -> Any:
        try:
            work()
        except Exception as error:  # rclpy would swallow it
            failures.append(str(error))
            return returns.FAILURE
        return returns.SUCCESS

    class Entity(base):  # type: ignore[misc, valid-type]  # imported late
        """Turns rclpy's callbacks into calls."""

        def on_configure(self, state: Any) -> Any:
            del state
            return outcome(managed.configure)

        def on_activate(self, state: Any) -> Any:
            del state
            return outcome(managed.activate)

        def on_deactivate(self, state: Any) -> Any:
            del state
            return outcome(managed.deactivate)

        def on_cleanup(self, state: Any) -> Any:
            del state
            return outcome(managed.clean_up)

        def on_shutdown(self, state: Any) -> Any:
            del state
            return outcome(managed.shut_down)

        def on_error(self, state: Any) -> Any:
            del state
            return outcome(managed.clean_up)

    node.add_managed_entity(Entity())


def start_by_itself(node: Any) -> None:
    """Lead a node to its active state where nobody else does; if it fails, it stays behind."""
    success = import_ros("rclpy.lifecycle").TransitionCallbackReturn.SUCCESS
    if node.trigger_configure() == success:
        node.trigger_activate()
