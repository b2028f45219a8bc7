"""Carrying out intents by goal poses: another follower, such as Nav2, drives the base."""

from __future__ import annotations

import math
import threading

import numpy as np

from toponav.geometry import Pose
from toponav.robot.intent import Follow, Intent, Turn
from toponav.robot.motion import MotionConfig
from toponav.robot.pilot import Outcome
from toponav.robot.stillness import Stillness
from toponav.robot.watchdog import Watchdog

REACHED_M = 0.3
"""Nav2 counts a goal as reached within 0.25 m by default; the pose is read a little later."""

REACHED_RAD = 0.3
"""The same for the heading: Nav2's is 0.25."""

STOOD_S = 0.4
"""A follower that has stood for so long where it should go has arrived."""

NEW_GOAL_M = 0.15
"""A way that ends this near to the last goal is no new goal: each one interrupts the follower."""

RESEND_S = 5.0
"""A goal is sent again after so long: the follower may not have been there to hear it."""


class GoalPilot:
    """The counterpart of `Pilot` that says where to go instead of how fast."""

    def __init__(self, config: MotionConfig, watchdog: Watchdog) -> None:
        """Send nothing until an intent comes."""
        self._config, self._watchdog = config, watchdog
        self._lock = threading.Lock()
        self._goal: Pose | None = None
        self._turns = False
        self._sent_s = -math.inf
        self._moving = False
        self._stillness = Stillness()
        self.outcome = Outcome.NONE
        self.objection = ""

    def begin(self, intent: Intent, pose: Pose, *, go_on: bool = False) -> None:
        """Carry out an intent from now on, from where the robot is; see `Pilot.begin`."""
        goal = _goal_pose(intent, pose)
        with self._lock:
            turns = isinstance(intent, Turn)
            near = self._goal is not None and not turns and not self._turns
            if near and self._goal is not None:
                apart = np.hypot(*(goal.translation - self._goal.translation)[:2])
                near = bool(apart < NEW_GOAL_M)
            if not (near and self.outcome is Outcome.UNDER_WAY):
                self._goal, self._turns, self._sent_s = goal, turns, -math.inf
            if not (go_on and self.outcome is Outcome.UNDER_WAY):
                self._stillness.restart()
            self.outcome = Outcome.UNDER_WAY

    def stop(self) -> None:
        """Stand still from now on."""
        with self._lock:
            self._goal = None
            self.outcome = Outcome.NONE

    def tick(self, pose: Pose | None, now_s: float) -> tuple[Pose | None, bool]:
        """A goal to send now, if any, and whether to cancel what was sent."""
        with self._lock:
            self.objection = self._watchdog.objection(now_s) or ""
            if self.objection or pose is None or self._goal is None:
                cancel, self._moving = self._moving, False
                self._sent_s = -math.inf
                self._stillness.restart()
                return None, cancel
            still_s = self._stillness.seconds(pose, now_s)
            if still_s > STOOD_S and self._reached(pose):
                self._goal, self._moving, self.outcome = None, False, Outcome.DONE
                return None, False
            if still_s > 2.0 * self._config.stall_s:
                self._goal, self._moving, self.outcome = None, False, Outcome.BLOCKED
                return None, True
            if now_s - self._sent_s < RESEND_S:
                return None, False
            self._sent_s, self._moving = now_s, True
            return self._goal, False

    def _reached(self, pose: Pose) -> bool:
        if self._goal is None:
            return False
        away = self._goal.inverse() @ pose
        if self._turns:
            return abs(away.yaw) <= REACHED_RAD
        return math.hypot(*away.translation[:2]) <= REACHED_M


def _goal_pose(intent: Intent, pose: Pose) -> Pose:
    """Where an intent ends, looking along the way's last piece."""
    match intent:
        case Turn(angle):
            return Pose.from_yaw(pose.yaw + angle, pose.translation)
        case Follow(way):
            end = way[-1]
            before = way[max(0, len(way) - 4)] if len(way) > 1 else pose.translation[:2]
            yaw = math.atan2(*(end - before)[::-1]) if np.any(end != before) else pose.yaw
            return Pose.from_yaw(yaw, (*end, pose.translation[2]))
