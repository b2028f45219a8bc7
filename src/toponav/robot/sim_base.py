"""The body of the simulated robot: continuous motion by velocities or to goals, and its trace."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from pydantic import Field

from toponav.config_model import ConfigModel
from toponav.geometry import Pose
from toponav.robot.motion import STILL, MotionConfig, TurnMotion, Twist, WayMotion, within_limits
from toponav.robot.sim_env import RobotEnv
from toponav.robot.sim_planner import SimPlanner


class SimBaseConfig(ConfigModel):
    """What the body can do, and how it follows goals."""

    motion: MotionConfig = Field(
        default_factory=lambda: MotionConfig(
            max_speed=1.0, max_turn_rate=2.0, acceleration=1.0, turn_acceleration=4.0
        )
    )
    """The body's own limits, which no command exceeds."""

    command_age_s: float = Field(default=0.5, gt=0.0)
    """The body brakes when its last command is older, as real bases do, seconds."""

    goal_speed: float = Field(default=0.4, gt=0.0)
    """Speed on the way to a goal, metres a second."""

    goal_turn_rate: float = Field(default=0.8, gt=0.0)
    """Turn rate on the way to a goal, radians a second."""

    goal_tolerance_m: float = Field(default=0.2, gt=0.0)
    """A goal is reached this near, metres; Nav2's default is 0.25."""

    goal_tolerance_deg: float = Field(default=8.0, gt=0.0)
    """The same for its heading, degrees; Nav2's default is 14."""


class TracePoint(NamedTuple):
    """The body at one time.

    Attributes:
        time_s: Of the clock that `advance` is told.
        x: Metres.
        y: Metres.
        yaw: Radians.
        speed: Metres a second.
        turn_rate: Radians a second.
        bumped: Whether it ran into something.
    """

    time_s: float
    x: float
    y: float
    yaw: float
    speed: float
    turn_rate: float
    bumped: bool


@dataclass(frozen=True, eq=False)
class Drive:
    """The way to a goal and the heading at its end, radians."""

    motion: WayMotion
    yaw: float


class SimBase:
    """Moves the body of a `RobotEnv` that was reset."""

    def __init__(self, env: RobotEnv, config: SimBaseConfig) -> None:
        """Stand still."""
        self._env, self._config = env, config
        self._planner = SimPlanner(env.surface, env.footprint.end_m)
        self._wanted, self._wanted_s = STILL, -math.inf
        self._drive: Drive | TurnMotion | None = None
        self._last_s: float | None = None
        self.twist = STILL
        self.travelled_m = 0.0
        self.bump_speed = 0.0
        self.bumps = 0
        self.trace: list[TracePoint] = []
        self._touching = False

    @property
    def pose(self) -> Pose:
        """The true pose of the foot point."""
        return Pose.from_yaw(self._env.yaw, self._env.position)

    def obey(self, twist: Twist, now_s: float) -> None:
        """Take a velocity; whoever sends those drives."""
        self._drive = None
        self._wanted, self._wanted_s = twist, now_s

    def go_to(self, goal: Pose) -> bool:
        """Drive to a pose by a way that keeps clear of walls; whether there is one."""
        way = self._planner.way(self._env.position, goal.translation)
        if not len(way):
            self.cancel()
            return False
        limits = {
            "max_speed": self._config.goal_speed,
            "max_turn_rate": self._config.goal_turn_rate,
            "tolerance_m": self._config.goal_tolerance_m,
            "tolerance_deg": self._config.goal_tolerance_deg,
        }
        motion = self._config.motion.model_copy(update=limits)
        self._drive = Drive(WayMotion(way, motion), goal.yaw)
        return True

    def cancel(self) -> None:
        """Brake."""
        self._drive, self._wanted = None, STILL

    def advance(self, now_s: float) -> None:
        """Move on until now."""
        elapsed_s = 0.0 if self._last_s is None else now_s - self._last_s
        self._last_s = now_s
        while elapsed_s > 1e-6:
            step_s = min(elapsed_s, 0.02)
            elapsed_s -= step_s
            self._step(now_s - elapsed_s, step_s)

    def _step(self, time_s: float, step_s: float) -> None:
        wanted = self._target(time_s)
        self.twist = within_limits(wanted, self.twist, step_s, self._config.motion)
        impact = 0.0
        if self.twist != STILL:
            before = self._env.position
            self._env.drive(self.twist.speed * step_s, self.twist.turn_rate * step_s)
            self.travelled_m += float(np.linalg.norm(self._env.position - before))
            impact = self._impact()
        bumped = impact > 0.0
        if bumped:
            if not self._touching:
                self.bumps += 1
                self.bump_speed = max(self.bump_speed, impact)
            speed = 0.0 if self._env.collided else self.twist.speed
            turn_rate = 0.0 if self._env.turn_collided else self.twist.turn_rate
            self.twist = Twist(speed, turn_rate)
        if bumped or self.twist.speed == 0.0:
            self._touching = bumped or (self._touching and wanted.speed != 0.0)
        else:
            self._touching = False
        x, y = self._env.position[:2]
        self.trace.append(
            TracePoint(time_s, x, y, self._env.yaw, self.twist.speed, self.twist.turn_rate, bumped)
        )

    def _impact(self) -> float:
        """How fast the body ran into something, ahead or with an end as it turned; 0 if it did not.

        Metres a second.
        """
        ahead = abs(self.twist.speed) if self._env.collided else 0.0
        end = abs(self.twist.turn_rate) * self._env.footprint.turning_radius_m
        return max(ahead, end if self._env.turn_collided else 0.0)

    def _target(self, now_s: float) -> Twist:
        """The velocity that is wanted now."""
        if isinstance(self._drive, Drive):
            wanted = self._drive.motion.wanted(self.pose)
            if wanted is not None:
                return wanted
            left = math.remainder(self._drive.yaw - self._env.yaw, math.tau)
            limits = {
                "max_turn_rate": self._config.goal_turn_rate,
                "tolerance_deg": self._config.goal_tolerance_deg,
            }
            config = self._config.motion.model_copy(update=limits)
            self._drive = TurnMotion(left, self.pose, config)
        if isinstance(self._drive, TurnMotion):
            wanted = self._drive.wanted(self.pose)
            if wanted is None:
                self.cancel()
                return STILL
            return wanted
        if now_s - self._wanted_s > self._config.command_age_s:
            return STILL
        return self._wanted
