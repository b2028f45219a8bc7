"""For how long a robot has stood still."""

from __future__ import annotations

import math

from toponav.geometry import Pose

MOVED_M = 0.03
"""Less than this is jitter of the pose, metres."""

MOVED_RAD = math.radians(3.0)
"""The same for the heading."""


class Stillness:
    """Told poses, says since when they have been the same."""

    def __init__(self) -> None:
        """Nothing is known yet."""
        self._since: tuple[float, Pose] | None = None

    def restart(self) -> None:
        """Count from the next pose on."""
        self._since = None

    def seconds(self, pose: Pose, now_s: float) -> float:
        """How long the robot has been where it is now."""
        if self._since is not None:
            since_s, there = self._since
            moved = there.inverse() @ pose
            if math.hypot(*moved.translation[:2]) <= MOVED_M and abs(moved.yaw) <= MOVED_RAD:
                return now_s - since_s
        self._since = now_s, pose
        return 0.0
