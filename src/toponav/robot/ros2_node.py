"""The ROS 2 node: an RGB-D camera and a pose in, a search, `/cmd_vel` or `/goal_pose` out.

Three threads: the executor's takes messages, the agent's thinks, and the control thread sends
commands at its own rate whatever the others do.
"""

from __future__ import annotations

import json
import math
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

from toponav.errors import PoseError, TopoNavError
from toponav.geometry import Pose
from toponav.robot.config import RobotConfig
from toponav.robot.frames import (
    COLOR,
    DEPTH,
    LABELS,
    TRANSFORM_TOPICS,
    FrameReader,
    pose_of,
    seconds_of,
)
from toponav.robot.goal_pilot import GoalPilot
from toponav.robot.labels import LabelImageDetector
from toponav.robot.motion import STILL, Twist
from toponav.robot.obstacle_guard import ObstacleGuard
from toponav.robot.pilot import Outcome, Pilot
from toponav.robot.pose_continuity import PoseContinuity
from toponav.robot.process_cost import process_cost
from toponav.robot.ros2_display import Display
from toponav.robot.ros2_import import import_ros
from toponav.robot.ros2_lifecycle import create_managed_node, let_manage
from toponav.robot.ros2_messages import write_pose
from toponav.robot.ros2_topics import robot_topics
from toponav.robot.search import Search, SearchTiming, Status
from toponav.robot.senses import Senses
from toponav.robot.watchdog import Watchdog
from toponav.types import Agent

WAITING = 5
"""Images and poses that may wait to be taken in."""

STATUS_S = 0.5
"""Between two status messages, seconds."""

HOLD_S = 0.2
"""For how long a tick keeps the robot from moving: till some ticks later, seconds."""

GOAL_PARAMETER = "goal"
"""Set by the service that every node has for its parameters, it starts a search or changes it."""

GOAL_SETTLE_S = 0.5
"""Longer than for our own follower: another one may still be turning a little."""


@dataclass(frozen=True, eq=False)
class Task:
    """What the node is to do with the robot.

    Attributes:
        agent: Searches.
        labels: The agent's detector, where that is the camera's label images; else None.
        robot: The robot.
        slam_from_world: Where the search's frame lay in the pose topic's when it was last saved.
        remembered: Points of the map that the agent starts with.
    """

    agent: Agent
    labels: LabelImageDetector | None
    robot: RobotConfig
    slam_from_world: Pose | None = None
    remembered: int = 0


class SearchNode:
    """Joins the robot's topics to a `Search`; `rclpy.init` has been called.

    It is a managed node: it listens once configured, and moves the robot while active.
    """

    def __init__(self, task: Task) -> None:
        """Publish; nothing runs before `start`.

        Raises:
            MissingExtraError: ROS 2 is not installed.
        """
        robot = self._robot = task.robot
        self.node = create_managed_node("toponav")
        watchdog = Watchdog(robot.watchdog)
        guard = ObstacleGuard(robot.guard, robot.footprint, robot.motion)
        motion = robot.motion
        continuity = PoseContinuity(motion.max_speed, motion.max_turn_rate, task.slam_from_world)
        reader = FrameReader(robot.camera, task.labels)
        self.senses = Senses(reader, continuity, watchdog, guard, robot.camera.slop_s)
        self._pilot = Pilot(motion, watchdog, guard)
        self._goals = GoalPilot(motion, watchdog)
        by_goals = robot.drive == "goal_pose"
        timing = SearchTiming(
            turn_rad=math.radians(robot.turn_deg),
            settle_s=max(motion.settle_s, GOAL_SETTLE_S) if by_goals else motion.settle_s,
            max_age_s=robot.max_frame_age_s,
        )
        driver = self._goals if by_goals else self._pilot
        self.search = Search(task.agent, driver, self.senses, timing, self.now_s)
        self.display = Display(self.node, self.senses, task.agent)
        self.search.watchers.append(self.display.acted)
        self.enabled, self.active = True, False
        self.ended = threading.Event()
        """Set once a lifecycle manager has shut the node down."""
        self._subscriptions: list[Any] = []
        self._closing = threading.Event()
        self._failed: list[str] = []
        self.on_message: Callable[[str, Any], None] | None = None
        self._topics = robot_topics(robot, WAITING, labels=LABELS in reader.kinds)
        self._offer()
        let_manage(self.node, self, self._failed)
        self._threads = [
            threading.Thread(target=self._guarded, args=(work,), name=name, daemon=True)
            for name, work in (("agent", self.search.run), ("control", self._control))
        ]

    def start(self) -> None:
        """Set the agent's and the control thread going."""
        for thread in self._threads:
            thread.start()

    def close(self) -> None:
        """Stand still and let go of the agent."""
        self.search.close()
        self._closing.set()
        for thread in self._threads:
            if thread.ident is not None:
                thread.join(timeout=10.0)
        for _ in range(3):
            self._send(STILL)
        self._tick_goals(time.monotonic())  # takes back a goal that is still being driven to

    def configure(self) -> None:
        """Listen to the robot, and start on the goal of the node's arguments, if any."""
        self._subscribe()
        goal = str(self.node.get_parameter(GOAL_PARAMETER).value)
        if goal.strip() and not self.search.goal:
            self._pursue(goal)

    def activate(self) -> None:
        """The robot may move from now on."""
        self.active = True

    def deactivate(self) -> None:
        """Stand still from now on; the search waits."""
        self.active = False
        self._send(STILL)

    def clean_up(self) -> None:
        """End the search, and listen no more."""
        self.deactivate()
        self.search.cancel("cleaned up")
        while self._subscriptions:
            self.node.destroy_subscription(self._subscriptions.pop())

    def shut_down(self) -> None:
        """End for good."""
        self.clean_up()
        self.ended.set()

    def now_s(self) -> float:
        """By the clock of the stamps."""
        return float(self.node.get_clock().now().nanoseconds) * 1e-9

    def raise_failure(self) -> None:
        """Raise what ended one of the threads, if anything.

        Raises:
            TopoNavError: It did.
        """
        if self._failed:
            raise TopoNavError(self._failed[0])

    def status(self) -> dict[str, Any]:
        """Where the search stands, and what it takes."""
        driver = self._goals if self._robot.drive == "goal_pose" else self._pilot
        return {
            "status": self.search.status.value,
            "goal": self.search.goal,
            "steps": self.search.steps,
            "motion": driver.outcome.value,
            "reason": self.search.reason or driver.objection,
            "enabled": self.enabled,
            "active": self.active,
            "pose_jumps": self.senses.jumps,
            "found": self.display.found,
            "process": process_cost(),
            "timings": self.senses.timings.summary(),
        }

    def _subscribe(self) -> None:
        camera = self._robot.camera
        images = {
            camera.color_topic: COLOR,
            camera.depth_topic: DEPTH,
            camera.labels_topic: LABELS,
        }
        others = {
            camera.info_topic: self.senses.reader.take_info,
            camera.names_topic: self.senses.reader.take_names,
            self._robot.pose_topic: self._pose,
            **dict.fromkeys(TRANSFORM_TOPICS, self.senses.reader.take_transforms),
        }
        for topic, (kind, profile) in self._topics.items():
            take = others.get(topic) or partial(self._image, images[topic])

            def came(message: Any, topic: str = topic, take: Callable[[Any], None] = take) -> None:
                if self.on_message is not None:
                    self.on_message(topic, message)
                take(message)

            self._listen(kind, topic, came, profile)
        string = import_ros("std_msgs.msg").String
        self._listen(string, "toponav/goal", lambda m: self._pursue(m.data), 10)

    def _listen(self, kind: Any, topic: str, take: Callable[[Any], None], profile: Any) -> None:
        self._subscriptions.append(self.node.create_subscription(kind, topic, take, profile))

    def _offer(self) -> None:
        geometry, std = import_ros("geometry_msgs.msg"), import_ros("std_msgs.msg")
        services = import_ros("std_srvs.srv")
        self._twist, self._pose_stamped = geometry.Twist, geometry.PoseStamped
        make = self.node.create_publisher
        self._velocity = make(geometry.Twist, "cmd_vel", 1)
        self._goal_pose = make(geometry.PoseStamped, "goal_pose", 1)
        self._string = std.String
        self._status = make(std.String, "toponav/status", 10)
        self.node.create_service(services.Trigger, "toponav/cancel", self._on_cancel)
        self.node.create_service(services.SetBool, "toponav/enable", self._on_enable)
        self._accepted = import_ros("rcl_interfaces.msg").SetParametersResult(successful=True)
        self.node.declare_parameter(GOAL_PARAMETER, "")
        self.node.add_on_set_parameters_callback(self._on_parameters)
        cancel = import_ros("action_msgs.srv").CancelGoal
        self._cancel_request = cancel.Request
        self._cancel = self.node.create_client(cancel, "navigate_to_pose/_action/cancel_goal")
        self.node.create_timer(STATUS_S, self.tell)

    def _pose(self, message: Any) -> None:
        try:
            pose = pose_of(message)
        except PoseError as error:
            self.node.get_logger().warning(f"ignored: {error}", throttle_duration_sec=5.0)
            return
        self.display.frame = message.header.frame_id or "map"
        self.senses.pose_came(seconds_of(message.header.stamp), pose, time.monotonic())

    def _image(self, kind: str, message: Any) -> None:
        stamp_s = seconds_of(message.header.stamp)
        self.senses.image_came(kind, stamp_s, message, time.monotonic(), self.now_s())

    def _pursue(self, goal: str) -> None:
        """Search for another goal from now on; an empty one cancels."""
        self.display.found = None
        if goal.strip():
            self.search.start(goal.strip())
        else:
            self.search.cancel()

    def _on_parameters(self, parameters: list[Any]) -> Any:
        for parameter in parameters:
            if parameter.name == GOAL_PARAMETER:
                self._pursue(str(parameter.value))
        return self._accepted

    def _on_cancel(self, request: Any, response: Any) -> Any:
        del request
        self.search.cancel()
        self._send(STILL)
        response.success, response.message = True, "cancelled"
        return response

    def _on_enable(self, request: Any, response: Any) -> Any:
        self.enabled = bool(request.data)
        if not self.enabled:
            self._send(STILL)
        response.success, response.message = True, "enabled" if self.enabled else "disabled"
        return response

    def tell(self) -> None:
        """Publish the status, and the find once the search is done."""
        if self.search.status is Status.DONE and self.display.found is None:
            self.display.tell_find(self.search.goal)
        self._status.publish(self._string(data=json.dumps(self.status())))

    def _guarded(self, work: Callable[[], None]) -> None:
        """Run a thread's work; if it ends by an error, the robot stands and the node ends."""
        try:
            work()
        except Exception as error:  # told to whoever waits for the search
            self._failed.append(f"{type(error).__name__}: {error}")
            self._send(STILL)

    def _control(self) -> None:
        """Send commands until the node closes."""
        period_s = 1.0 / self._robot.control_hz
        tick = self._tick_goals if self._robot.drive == "goal_pose" else self._tick_velocity
        last_s = due_s = time.monotonic()
        while not self._closing.wait(max(0.0, due_s - time.monotonic())):
            now_s = time.monotonic()
            self.senses.timings.add("control period", now_s - last_s)
            last_s, due_s = now_s, max(due_s + period_s, now_s)
            tick(now_s)

    def _hold(self, now_s: float) -> None:
        """Keep the robot from moving where it may not."""
        if not (self.enabled and self.active):
            why = "disabled" if self.active else "not active"
            self.senses.watchdog.hold(now_s + HOLD_S, why)

    def _tick_velocity(self, now_s: float) -> None:
        self._hold(now_s)
        twist = self._pilot.tick(self.senses.pose, self.senses.slam_pose, now_s)
        idle = twist == STILL and self._pilot.outcome is Outcome.NONE
        if not idle or self.search.goal:
            self._send(twist)
            self.senses.commanded(self.now_s())

    def _tick_goals(self, now_s: float) -> None:
        self._hold(now_s)
        goal, cancel = self._goals.tick(self.senses.pose, now_s)
        if self._robot.dry_run:
            return
        if cancel:
            self._stand_still()
        if goal is not None:
            self._send_goal(self.senses.slam_from_world @ goal)
            self.senses.commanded(self.now_s())

    def _send(self, twist: Twist) -> None:
        if self._robot.dry_run or self._robot.drive == "goal_pose":
            return
        message = self._twist()
        message.linear.x, message.angular.z = float(twist.speed), float(twist.turn_rate)
        self._velocity.publish(message)

    def _send_goal(self, slam_from_goal: Pose) -> None:
        message = self._pose_stamped()
        message.header.stamp = self.node.get_clock().now().to_msg()
        message.header.frame_id = self.display.frame
        write_pose(message.pose, slam_from_goal)
        self._goal_pose.publish(message)

    def _stand_still(self) -> None:
        """Cancel Nav2's goal; where nobody offers that, the goal is where the robot stands."""
        if self._cancel.service_is_ready():
            self._cancel.call_async(self._cancel_request())
        elif self.senses.slam_pose is not None:
            self._send_goal(self.senses.slam_pose)
