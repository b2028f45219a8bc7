"""The embedded simulator as a ROS 2 robot with an RGB-D camera: `/cmd_vel` or `/goal_pose` in."""

from __future__ import annotations

import json
import time
from collections import deque
from typing import Any

import numpy as np
from pydantic import Field

from toponav.config_model import ConfigModel
from toponav.geometry import Intrinsics, Pose
from toponav.robot.config import RobotConfig
from toponav.robot.frames import pose_of
from toponav.robot.motion import Twist
from toponav.robot.ros2_import import import_ros
from toponav.robot.ros2_messages import write_image, write_pose
from toponav.robot.sim_base import SimBase, SimBaseConfig
from toponav.robot.sim_env import RobotEnv
from toponav.robot.sim_faults import FaultConfig, Faults


class SimRobotConfig(ConfigModel):
    """Rates and faults of the simulated robot."""

    camera_hz: float = Field(default=15.0, gt=0.0)
    """Images a second."""

    pose_hz: float = Field(default=50.0, gt=0.0)
    """Poses a second."""

    base: SimBaseConfig = Field(default_factory=SimBaseConfig)
    """The body."""

    faults: FaultConfig = Field(default_factory=FaultConfig)
    """What goes wrong."""


class SimRobot:
    """Publishes colour, depth, camera_info, labels and poses of a `RobotEnv` that was reset."""

    def __init__(
        self, env: RobotEnv, robot: RobotConfig, config: SimRobotConfig, seed: int = 0
    ) -> None:
        """Make the node; `rclpy.init` has been called.

        Args:
            env: Where the robot is.
            robot: Names its topics.
            config: Rates and faults.
            seed: Of lost images.

        Raises:
            MissingExtraError: ROS 2 is not installed.
        """
        self._env, self._robot, self._config = env, robot, config
        self.faults = Faults(config.faults, np.random.default_rng(seed))
        self.base = SimBase(env, config.base)
        self.frames = 0
        self._late: deque[tuple[float, Any, Any]] = deque()
        self.node = import_ros("rclpy").create_node("sim_robot")
        self._publish_to()
        self._listen()
        env.look()  # compiles or loads the renderer before the clock runs
        self.node.create_timer(1.0 / config.pose_hz, self._move)
        self.node.create_timer(1.0 / config.camera_hz, self._look)

    def _publish_to(self) -> None:
        sensor, nav, std = (import_ros(f"{kind}_msgs.msg") for kind in ("sensor", "nav", "std"))
        qos, camera, make = import_ros("rclpy.qos"), self._robot.camera, self.node.create_publisher
        self._image, self._info, self._odometry = sensor.Image, sensor.CameraInfo, nav.Odometry
        sensing = qos.qos_profile_sensor_data
        latched = qos.QoSProfile(depth=1, durability=qos.DurabilityPolicy.TRANSIENT_LOCAL)
        self._rgb = make(sensor.Image, camera.color_topic, sensing)
        self._depth = make(sensor.Image, camera.depth_topic, sensing)
        self._labels = make(sensor.Image, camera.labels_topic, sensing)
        self._camera = make(sensor.CameraInfo, camera.info_topic, sensing)
        self._odom = make(nav.Odometry, self._robot.pose_topic, sensing)
        self._names = make(std.String, camera.names_topic, latched)
        categories = [instance.category for instance in self._env.scene.mesh.instances]
        self._names.publish(std.String(data=json.dumps(categories)))

    def _listen(self) -> None:
        geometry = import_ros("geometry_msgs.msg")
        cancel = import_ros("action_msgs.srv").CancelGoal
        listen = self.node.create_subscription
        listen(geometry.Twist, "cmd_vel", self._obey, 1)
        listen(geometry.PoseStamped, "goal_pose", self._go_to, 1)
        self.node.create_service(cancel, "navigate_to_pose/_action/cancel_goal", self._cancel)

    def _obey(self, message: Any) -> None:
        self.base.obey(Twist(message.linear.x, message.angular.z), time.time())

    def _go_to(self, message: Any) -> None:
        # The goal is in the SLAM's frame; the body drives in the true one.
        slam_from_true = self.faults.reported(Pose.identity())
        self.base.go_to(slam_from_true.inverse() @ pose_of(message))

    def _cancel(self, request: Any, response: Any) -> Any:
        del request
        self.base.cancel()
        return response

    def _move(self) -> None:
        now_s = time.time()
        self.base.advance(now_s)
        if self.base.twist.speed or self.base.twist.turn_rate:
            self.faults.moves(now_s, self.base.twist.speed)
        message = self._odometry()
        message.header.stamp = self._stamp(now_s)
        message.header.frame_id, message.child_frame_id = "odom", "base_link"
        write_pose(message.pose.pose, self.faults.reported(self._reported()))
        message.twist.twist.linear.x = self.base.twist.speed
        message.twist.twist.angular.z = self.base.twist.turn_rate
        self._odom.publish(message)
        while self._late and self._late[0][0] <= now_s:
            _, publisher, late = self._late.popleft()
            publisher.publish(late)

    def _reported(self) -> Pose:
        """The pose with the environment's drift."""
        return self._env.reported_pose()

    def _look(self) -> None:
        now_s = time.time()
        if self.faults.is_silent(now_s):
            return
        self.base.advance(now_s)
        stamp = self._stamp(now_s)
        seen = self._env.look()
        self.frames += 1
        millimetres = np.round(seen.depth * 1000.0).astype(np.uint16)
        labels = self._env.semantic_frame().instance_ids.astype(np.int32)
        self._send(self._camera, self._camera_info(seen.intrinsics, stamp), now_s)
        for publisher, encoding, pixels in (
            (self._labels, "32SC1", labels),
            (self._depth, "16UC1", millimetres),
            (self._rgb, "rgb8", seen.rgb),
        ):
            if self.faults.loses():
                continue
            message = self._image()
            message.header.stamp, message.header.frame_id = stamp, "camera_color_optical_frame"
            write_image(message, encoding, pixels)
            self._send(publisher, message, now_s)

    def _send(self, publisher: Any, message: Any, now_s: float) -> None:
        if self._config.faults.latency_s:
            self._late.append((now_s + self._config.faults.latency_s, publisher, message))
        else:
            publisher.publish(message)

    def _stamp(self, time_s: float) -> Any:
        nanoseconds = round(time_s * 1e9)
        return import_ros("builtin_interfaces.msg").Time(
            sec=nanoseconds // 10**9, nanosec=nanoseconds % 10**9
        )

    def _camera_info(self, camera: Intrinsics, stamp: Any) -> Any:
        message = self._info(width=camera.width, height=camera.height)
        message.header.stamp, message.header.frame_id = stamp, "camera_color_optical_frame"
        message.k = camera.matrix.ravel().tolist()
        return message
