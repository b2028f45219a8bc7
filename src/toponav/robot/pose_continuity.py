"""Poses without jumps: what a SLAM's loop closures do to them is taken out again.

The map of a search is built in one continuous frame, as odometry is in ROS's REP 105: where the
pose jumps, the map stays where it is and the frame of the SLAM moves under it.
"""

from __future__ import annotations

import math

import numpy as np

from toponav.geometry import Pose


class PoseContinuity:
    """Turns poses in the SLAM's frame into poses in the search's."""

    def __init__(
        self, max_speed: float, max_turn_rate: float, slam_from_world: Pose | None = None
    ) -> None:
        """Take what moves faster than the robot can for a jump.

        Args:
            max_speed: Metres a second.
            max_turn_rate: Radians a second.
            slam_from_world: Where the frames stood to each other before; by default one on another.
        """
        self._max_speed = max_speed
        self._max_turn_rate = max_turn_rate
        self._last: tuple[float, Pose] | None = None
        self.slam_from_world = slam_from_world or Pose.identity()
        self.jumps = 0

    def add(self, stamp_s: float, slam_from_base: Pose) -> tuple[Pose, bool]:
        """`world_from_base` of a pose, and whether the pose had jumped."""
        jumped = False
        if self._last is not None:
            before_s, before = self._last
            moved = before.inverse() @ slam_from_base
            if self._is_jump(moved, stamp_s - before_s):
                # The robot is where it was in the world; the SLAM's frame has moved.
                world_from_base = self.slam_from_world.inverse() @ before
                self.slam_from_world = slam_from_base @ world_from_base.inverse()
                self.jumps += 1
                jumped = True
        self._last = stamp_s, slam_from_base
        return self.slam_from_world.inverse() @ slam_from_base, jumped

    def _is_jump(self, moved: Pose, elapsed_s: float) -> bool:
        """Whether a body could not have moved so far in that time."""
        length = float(np.linalg.norm(moved.translation))
        possible_m = JUMP_M + 2.0 * self._max_speed * max(0.0, elapsed_s)
        possible_rad = JUMP_RAD + 2.0 * self._max_turn_rate * max(0.0, elapsed_s)
        return length > possible_m or abs(moved.yaw) > possible_rad


JUMP_M = 0.08
"""Smaller jumps than this are taken as motion: within a cell of the map they do no harm."""

JUMP_RAD = math.radians(4.0)
"""The same for the heading: 8 cm at a metre."""
