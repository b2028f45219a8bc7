"""The node's life as ROS 2 manages it: configured, active, inactive, cleaned up, shut down."""

from __future__ import annotations

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


def let_manage(node: Any, managed: Managed) -> None:
    """Pass a node's transitions on."""
    lifecycle = import_ros("rclpy.lifecycle")
    done = lifecycle.TransitionCallbackReturn.SUCCESS

    class Entity(lifecycle.ManagedEntity):  # type: ignore[misc]  # imported late
        """Turns rclpy's callbacks into calls."""

        def on_configure(self, state: Any) -> Any:
            del state
            managed.configure()
            return done

        def on_activate(self, state: Any) -> Any:
            del state
            managed.activate()
            return done

        def on_deactivate(self, state: Any) -> Any:
            del state
            managed.deactivate()
            return done

        def on_cleanup(self, state: Any) -> Any:
            del state
            managed.clean_up()
            return done

        def on_shutdown(self, state: Any) -> Any:
            del state
            managed.shut_down()
            return done

        def on_error(self, state: Any) -> Any:
            del state
            managed.clean_up()
            return done

    node.add_managed_entity(Entity())


def start_by_itself(node: Any) -> None:
    """Lead a node to its active state, where nobody else does."""
    node.trigger_configure()
    node.trigger_activate()
