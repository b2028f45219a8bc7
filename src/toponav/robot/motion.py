"""Intents as velocities: turning in place and following a way, within the body's limits."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from toponav.config_model import ConfigModel
from toponav.geometry import Pose
from toponav.robot.intent import Follow, Intent, Turn


class MotionConfig(ConfigModel):
    """Limits of the body, and when a motion has reached its end."""

    max_speed: float = Field(default=0.4, gt=0.0)
    """Metres a second."""

    max_turn_rate: float = Field(default=0.8, gt=0.0)
    """Radians a second."""

    acceleration: float = Field(default=0.5, gt=0.0)
    """Metres a second squared, speeding up and slowing down."""

    turn_acceleration: float = Field(default=1.6, gt=0.0)
    """Radians a second squared."""

    tolerance_m: float = Field(default=0.1, gt=0.0)
    """A way is done this near to its end, metres: less than the agent takes for arrival."""

    tolerance_deg: float = Field(default=2.0, gt=0.0)
    """A turn is done this near to its end, degrees."""

    lookahead_m: float = Field(default=0.35, gt=0.0)
    """How far along the way the robot steers towards, metres: three of the planner's cells, so that
    it neither follows their staircase nor cuts corners by more than the planner's margin."""

    turn_first_deg: float = Field(default=40.0, gt=0.0, le=90.0)
    """Off its way by more than this, the robot turns in place before it drives."""

    settle_s: float = Field(default=0.25, ge=0.0)
    """Images taken sooner after a turn may be blurred and are not looked at, seconds."""

    stall_s: float = Field(default=2.0, gt=0.0)
    """A motion without progress for so long is blocked."""


@dataclass(frozen=True)
class Twist:
    """Forward speed (m/s; negative: backward) and turn rate (rad/s, counter-clockwise)."""

    speed: float = 0.0
    turn_rate: float = 0.0


STILL = Twist()

STEERING_GAIN = 2.0
"""Turn rate for every radian off the way, 1/s: settles within a second."""


class TurnMotion:
    """One turn in place from where the robot stands; any angle, also beyond half a circle."""

    def __init__(self, angle: float, start: Pose, config: MotionConfig) -> None:
        """Turn by `angle` radians from pose `start` on."""
        self._config = config
        self._left = angle
        self._yaw = start.yaw

    def wanted(self, pose: Pose) -> Twist | None:
        """The velocity wanted at a pose; None once the turn is done."""
        self._left -= math.remainder(pose.yaw - self._yaw, math.tau)
        self._yaw = pose.yaw
        off = abs(self._left)
        if off <= math.radians(self._config.tolerance_deg):
            return None
        rate = min(
            self._config.max_turn_rate, math.sqrt(2.0 * self._config.turn_acceleration * off)
        )
        return Twist(turn_rate=math.copysign(rate, self._left))


class WayMotion:
    """Pure pursuit of a way (Coulter 1992), with a turn in place where it leads aside."""

    def __init__(self, way: NDArray[np.float64], config: MotionConfig) -> None:
        """Follow (K, 2) positions."""
        self._config = config
        self._way = way
        steps = np.hypot(*np.diff(way, axis=0).T) if len(way) > 1 else np.zeros(0)
        self._along = np.concatenate([[0.0], np.cumsum(steps)])

    def wanted(self, pose: Pose) -> Twist | None:
        """The velocity wanted at a pose; None once the end is reached."""
        config, here = self._config, pose.translation[:2]
        away = np.hypot(*(self._way - here).T)
        to_end = float(away[-1])
        nearest = int(np.argmin(away))
        left = max(to_end, float(self._along[-1] - self._along[nearest]))
        if left <= config.tolerance_m:
            return None
        ahead = int(np.searchsorted(self._along, self._along[nearest] + config.lookahead_m))
        x, y = self._way[min(ahead, len(self._way) - 1)] - here
        off = math.remainder(math.atan2(y, x) - pose.yaw, math.tau)
        turn_rate = max(-config.max_turn_rate, min(config.max_turn_rate, STEERING_GAIN * off))
        aside = abs(off) / math.radians(config.turn_first_deg)
        speed = min(config.max_speed, math.sqrt(2.0 * config.acceleration * left))
        return Twist(max(0.0, 1.0 - aside) * speed, turn_rate)


RETREAT_M = 0.25
"""How far a body backs out of a place where it cannot turn, metres."""

RETREAT_SPEED = 0.1
"""How fast: it does not see where it goes, metres a second."""


class RetreatMotion:
    """Straight back, where the robot came from."""

    def __init__(self, start: Pose) -> None:
        """Back out from pose `start`."""
        self._start = start

    def wanted(self, pose: Pose) -> Twist | None:
        """The velocity wanted at a pose; None once it is out."""
        away = np.hypot(*(pose.translation - self._start.translation)[:2])
        return Twist(-RETREAT_SPEED) if away < RETREAT_M else None


Motion = TurnMotion | WayMotion | RetreatMotion
"""Any of them."""


def motion_of(intent: Intent, start: Pose, config: MotionConfig) -> TurnMotion | WayMotion:
    """The motion that carries out an intent from a pose on."""
    match intent:
        case Turn(angle):
            return TurnMotion(angle, start, config)
        case Follow(way):
            return WayMotion(way, config)


def within_limits(wanted: Twist, last: Twist, elapsed_s: float, config: MotionConfig) -> Twist:
    """The velocity nearest to the one wanted that the limits allow so long after the last one."""
    gain, turn_gain = config.acceleration * elapsed_s, config.turn_acceleration * elapsed_s
    speed = max(last.speed - gain, min(last.speed + gain, wanted.speed))
    turn_rate = max(last.turn_rate - turn_gain, min(last.turn_rate + turn_gain, wanted.turn_rate))
    return Twist(
        max(-RETREAT_SPEED, min(config.max_speed, speed)),
        max(-config.max_turn_rate, min(config.max_turn_rate, turn_rate)),
    )
