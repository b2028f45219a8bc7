"""Poses by time: an image is posed where the robot was when it was taken."""

from __future__ import annotations

from bisect import bisect_left
from collections import deque

from scipy.spatial.transform import Rotation, Slerp

from toponav.geometry import Pose


class PoseBuffer:
    """The poses of the last seconds, interpolated between and never beyond them."""

    def __init__(self, kept_s: float = 10.0) -> None:
        """Keep poses for `kept_s` seconds."""
        self._kept_s = kept_s
        self._stamps: deque[float] = deque()
        self._poses: deque[Pose] = deque()

    def __len__(self) -> int:
        return len(self._stamps)

    def add(self, stamp_s: float, pose: Pose) -> None:
        """Take a pose; one that is not newer than the last is ignored."""
        if self._stamps and stamp_s <= self._stamps[-1]:
            return
        self._stamps.append(stamp_s)
        self._poses.append(pose)
        while self._stamps[0] < stamp_s - self._kept_s:
            self._stamps.popleft()
            self._poses.popleft()

    @property
    def newest_s(self) -> float | None:
        """Stamp of the newest pose; None before the first."""
        return self._stamps[-1] if self._stamps else None

    @property
    def newest(self) -> Pose | None:
        """The newest pose; None before the first."""
        return self._poses[-1] if self._poses else None

    def at(self, stamp_s: float) -> Pose | None:
        """The pose at a time; None before the first pose kept and after the last."""
        if not self._stamps or not self._stamps[0] <= stamp_s <= self._stamps[-1]:
            return None
        after = bisect_left(self._stamps, stamp_s)
        if self._stamps[after] == stamp_s:
            return self._poses[after]
        start, end = self._poses[after - 1], self._poses[after]
        begun, span = self._stamps[after - 1], self._stamps[after] - self._stamps[after - 1]
        share = (stamp_s - begun) / span
        turns = Rotation.from_matrix([start.rotation, end.rotation])
        rotation = Slerp([0.0, 1.0], turns)(share).as_matrix()
        translation = (1.0 - share) * start.translation + share * end.translation
        return Pose.from_rotation(rotation, translation)
