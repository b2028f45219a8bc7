"""Whether the robot may move: fresh depth, fresh pose, inside its area, nothing held."""

from __future__ import annotations

import math
from typing import Annotated

from pydantic import Field
from shapely import Polygon, contains_xy

from toponav.config_model import ConfigModel
from toponav.geometry import Pose

Corners = tuple[tuple[float, float], ...]
"""Of an area, metres."""


class WatchdogConfig(ConfigModel):
    """What counts as fresh, and where the robot must not go."""

    max_depth_silence_s: float = Field(default=0.6, gt=0.0)
    """No depth image for so long stops the robot, seconds."""

    max_pose_silence_s: float = Field(default=0.4, gt=0.0)
    """No pose for so long stops the robot, seconds."""

    max_depth_latency_s: float = Field(default=1.0, gt=0.0)
    """Depth that was taken longer ago, by its stamp, stops the robot, seconds."""

    keep_out: tuple[Annotated[Corners, Field(min_length=3)], ...] = ()
    """Areas in the pose's frame, each by its corners (metres), into which the robot must not go."""

    look_ahead_s: float = Field(default=1.0, ge=0.0)
    """A keep-out area that would be entered within so long stops the robot, seconds."""


class Watchdog:
    """Says why the robot must stand still, if it must. All times are of one steady clock."""

    def __init__(self, config: WatchdogConfig) -> None:
        """Nothing has arrived yet, so nothing may move."""
        self._config = config
        self._depth_s = self._pose_s = -math.inf
        self._latency_s = math.inf
        self._held_until_s, self._held_why = -math.inf, ""
        self._keep_out = [Polygon(corners) for corners in config.keep_out]

    def depth_came(self, now_s: float, latency_s: float = 0.0) -> None:
        """A depth image arrived that was taken `latency_s` ago."""
        self._depth_s, self._latency_s = now_s, latency_s

    def pose_came(self, now_s: float) -> None:
        """A pose arrived."""
        self._pose_s = now_s

    def hold(self, until_s: float, why: str) -> None:
        """Stand still until a time."""
        self._held_until_s, self._held_why = until_s, why

    def objection(self, now_s: float) -> str | None:
        """Why the robot must stand still; None when it may move."""
        config = self._config
        if now_s - self._pose_s > config.max_pose_silence_s:
            return "no fresh pose"
        if now_s - self._depth_s > config.max_depth_silence_s:
            return "no fresh depth"
        if self._latency_s > config.max_depth_latency_s:
            return "depth comes too late"
        return self._held_why if now_s < self._held_until_s else None

    def enters_keep_out(self, pose: Pose, speed: float) -> bool:
        """Whether going straight on at `speed` (m/s) would soon lead into a keep-out area.

        Args:
            pose: In the frame of the areas. Out of an area the robot may always turn and drive.
            speed: Forward.
        """
        if not self._keep_out or speed <= 0.0:
            return False
        reach = speed * self._config.look_ahead_s
        x, y = pose.translation[:2]
        a, b = x + reach * math.cos(pose.yaw), y + reach * math.sin(pose.yaw)
        return any(
            contains_xy(area, a, b) and not contains_xy(area, x, y) for area in self._keep_out
        )
