"""Carrying out intents by velocities: at every tick the safe one, whatever the agent is doing."""

from __future__ import annotations

import math
import threading
from enum import Enum

from toponav.geometry import Pose
from toponav.robot.intent import Intent
from toponav.robot.motion import (
    STILL,
    Motion,
    MotionConfig,
    RetreatMotion,
    Twist,
    motion_of,
    within_limits,
)
from toponav.robot.obstacle_guard import ObstacleGuard
from toponav.robot.stillness import Stillness
from toponav.robot.watchdog import Watchdog

SLOWEST = 0.05
"""An obstacle that allows no more than this stops the robot, metres a second."""

SLOWEST_TURN = 0.1
"""The same for a turn, radians a second."""


ABOUT = Pose.from_yaw(math.pi, (0.0, 0.0, 0.0))
"""A body that backs up drives the other way about: its footprint is alike at both ends."""


class Outcome(Enum):
    """Where the last intent stands."""

    NONE = "none"
    UNDER_WAY = "under way"
    DONE = "done"
    BLOCKED = "blocked"


class Pilot:
    """Drives the base; `begin` and `stop` may be called from any thread, `tick` from one."""

    def __init__(self, config: MotionConfig, watchdog: Watchdog, guard: ObstacleGuard) -> None:
        """Stand still until an intent comes."""
        self._config, self._watchdog, self._guard = config, watchdog, guard
        self._lock = threading.Lock()
        self._motion: Motion | None = None
        self._after: Motion | None = None
        """What goes on once the robot has backed out of a place where it could not turn."""
        self._retreated = False
        self._last, self._last_s = STILL, -math.inf
        self._stillness = Stillness()
        self.outcome = Outcome.NONE
        self.objection = ""
        """Why the robot was made to stand still at the last tick, in words; empty otherwise."""

    def begin(self, intent: Intent, pose: Pose, *, go_on: bool = False) -> None:
        """Carry out an intent from now on, from where the robot is.

        Args:
            intent: What to do.
            pose: Where the robot is.
            go_on: The same way, planned anew: what stalled before stalls still.
        """
        with self._lock:
            self._motion, self._after = motion_of(intent, pose, self._config), None
            if not (go_on and self.outcome is Outcome.UNDER_WAY):
                self._stillness.restart()
                self._retreated = False
            self.outcome = Outcome.UNDER_WAY

    def stop(self) -> None:
        """Stand still from now on, at once."""
        with self._lock:
            self._end(Outcome.NONE)

    def tick(self, pose: Pose | None, slam_from_base: Pose | None, now_s: float) -> Twist:
        """The velocity for now.

        Args:
            pose: Where the robot is, in the frame of the intents.
            slam_from_base: The same in the frame of the keep-out areas.
            now_s: By a steady clock.
        """
        with self._lock:
            elapsed_s = min(max(0.0, now_s - self._last_s), 0.2)
            self._last_s = now_s
            self.objection = self._watchdog.objection(now_s) or ""
            if self.objection or pose is None or slam_from_base is None or self._motion is None:
                self._last = STILL
                self._stillness.restart()
                return STILL
            wanted = self._motion.wanted(pose)
            if wanted is None and self._after is not None:
                self._motion, self._after = self._after, None
                self._stillness.restart()
                wanted = self._motion.wanted(pose)
            if wanted is None:
                return self._end(Outcome.DONE)
            limits = self._limits(wanted, pose, slam_from_base)
            if self._stillness.seconds(pose, now_s) > self._config.stall_s:
                if wanted.speed != 0.0 or self._retreated:
                    return self._end(Outcome.BLOCKED)
                self._after, self._motion = self._motion, RetreatMotion(pose)
                self._retreated = True
                self._stillness.restart()
                wanted = STILL
            allowed = _no_faster(wanted, limits)
            twist = within_limits(allowed, self._last, elapsed_s, self._config)
            # Braking for an obstacle is not gentle.
            self._last = _no_faster(twist, limits)
            return self._last

    def _limits(self, wanted: Twist, pose: Pose, slam_from_base: Pose) -> Twist:
        """How fast the surroundings let it go on; says why where that is next to nothing."""
        if (wanted.speed or self._last.speed) < 0.0:
            pose, slam_from_base = pose @ ABOUT, slam_from_base @ ABOUT
        speed = self._guard.limit(pose, wanted.turn_rate)
        rate = self._guard.turn_limit(pose, wanted.turn_rate or self._last.turn_rate)
        if self._watchdog.enters_keep_out(slam_from_base, min(abs(wanted.speed), speed)):
            self.objection, speed = "a keep-out area is ahead", 0.0
        elif speed < abs(wanted.speed) and speed < SLOWEST:
            self.objection, speed = "an obstacle is ahead", 0.0
        if rate < abs(wanted.turn_rate) and rate < SLOWEST_TURN:
            self.objection, rate = "an obstacle is beside the robot", 0.0
        return Twist(speed, rate)

    def _end(self, outcome: Outcome) -> Twist:
        self._motion, self._after, self._last = None, None, STILL
        self.outcome = outcome
        return STILL


def _no_faster(twist: Twist, limits: Twist) -> Twist:
    """A velocity cut down, whichever way it goes."""
    speed, rate = min(abs(twist.speed), limits.speed), min(abs(twist.turn_rate), limits.turn_rate)
    return Twist(math.copysign(speed, twist.speed), math.copysign(rate, twist.turn_rate))
