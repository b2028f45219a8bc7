"""What the robot has sensed so far: poses, images at their poses, and how fresh all of it is."""

from __future__ import annotations

import threading
from typing import Any

from toponav.geometry import Pose
from toponav.robot.frame_sync import FrameSync, Instant
from toponav.robot.frames import DEPTH, FrameReader
from toponav.robot.obstacle_guard import ObstacleGuard
from toponav.robot.pose_buffer import PoseBuffer
from toponav.robot.pose_continuity import PoseContinuity
from toponav.robot.timings import Timings
from toponav.robot.watchdog import Watchdog

JUMP_HOLD_S = 0.5
"""After its pose has jumped the robot stands for so long, until new images have come."""


class Senses:
    """Takes what comes from the topics; safe to use from any thread."""

    def __init__(
        self,
        reader: FrameReader,
        continuity: PoseContinuity,
        watchdog: Watchdog,
        guard: ObstacleGuard,
        slop_s: float,
    ) -> None:
        """Start without anything sensed."""
        self.reader, self.watchdog, self.guard = reader, watchdog, guard
        self.timings = Timings()
        self._continuity = continuity
        self._poses = PoseBuffer()
        self._frames = FrameSync(reader.kinds, slop_s)
        self._ahead = FrameSync((DEPTH,), 0.0)
        self._slam_pose: Pose | None = None
        self._unanswered_s: float | None = None
        self._lock = threading.RLock()

    @property
    def pose(self) -> Pose | None:
        """Where the robot is, in the search's frame; None before the first pose."""
        with self._lock:
            return self._poses.newest

    @property
    def slam_pose(self) -> Pose | None:
        """The same in the frame of the pose topic."""
        return self._slam_pose

    @property
    def slam_from_world(self) -> Pose:
        """The frame of the pose topic from the search's."""
        return self._continuity.slam_from_world

    @property
    def jumps(self) -> int:
        """How often the pose has jumped."""
        return self._continuity.jumps

    def pose_came(self, stamp_s: float, slam_from_base: Pose, now_s: float) -> None:
        """A pose arrived.

        Args:
            stamp_s: Its stamp.
            slam_from_base: In the topic's frame.
            now_s: By the steady clock.
        """
        with self._lock:
            newest_s = self._poses.newest_s
            if newest_s is not None and stamp_s <= newest_s:
                return
            pose, jumped = self._continuity.add(stamp_s, slam_from_base)
            self._slam_pose = slam_from_base
            self._poses.add(stamp_s, pose)
            self.watchdog.pose_came(now_s)
            if jumped:
                self.watchdog.hold(now_s + JUMP_HOLD_S, "the pose has jumped")
            self._look_ahead(now_s, stamp_s)

    def image_came(
        self, kind: str, stamp_s: float, message: Any, now_s: float, at_s: float
    ) -> None:
        """An image arrived.

        Args:
            kind: One of the reader's.
            stamp_s: When it was taken.
            message: The image.
            now_s: By the steady clock.
            at_s: Now, by the clock of the stamps.
        """
        with self._lock:
            self._frames.add(kind, stamp_s, message)
            if kind == DEPTH:
                self.watchdog.depth_came(now_s, at_s - stamp_s)
                self._ahead.add(kind, stamp_s, message)
                self._look_ahead(now_s, at_s)

    def newest(self) -> Instant | None:
        """The newest whole instant that has not been taken yet."""
        with self._lock:
            return None if self.reader.lacks else self._frames.newest(self._poses)

    def commanded(self, at_s: float) -> None:
        """A command went out that takes all images seen so far into account."""
        stamp_s, self._unanswered_s = self._unanswered_s, None
        if stamp_s is not None:
            self.timings.add("image to command", at_s - stamp_s)

    def _look_ahead(self, now_s: float, at_s: float) -> None:
        """Show the guard the newest depth image whose pose is known."""
        camera, mount = self.reader.intrinsics, self.reader.base_from_camera
        if camera is None or mount is None:
            return
        instant = self._ahead.newest(self._poses)
        if instant is None:
            return
        depth = self.reader.depth(instant.parts[DEPTH])
        if depth.shape != (camera.height, camera.width):
            return
        pose = instant.world_from_base
        placed = pose @ mount
        taken_s = now_s - max(0.0, at_s - instant.stamp_s)
        self.guard.see(depth, camera, placed, pose, taken_s)
        self._unanswered_s = instant.stamp_s
