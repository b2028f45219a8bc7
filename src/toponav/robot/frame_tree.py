"""Frames of a robot and how they lie to each other, as `/tf` and `/tf_static` tell it."""

from __future__ import annotations

from typing import Any

from toponav.errors import PoseError
from toponav.geometry import Pose

DEEPEST = 100
"""A chain of more frames than this goes in a circle."""


class FrameTree:
    """The newest transform of every frame to its parent.

    The camera is taken to sit still on the robot: what lies between the two is not interpolated.
    """

    def __init__(self) -> None:
        """No frame is known."""
        self._parents: dict[str, tuple[str, Pose]] = {}

    def take(self, message: Any) -> None:
        """Take a tf2_msgs/TFMessage; transforms without a rotation are left out."""
        for stamped in message.transforms:
            at, turn = stamped.transform.translation, stamped.transform.rotation
            try:
                pose = Pose.from_quaternion((turn.x, turn.y, turn.z, turn.w), (at.x, at.y, at.z))
            except PoseError:
                continue
            self._parents[_bare(stamped.child_frame_id)] = _bare(stamped.header.frame_id), pose

    def between(self, target: str, source: str) -> Pose | None:
        """`target_from_source`; None while no chain of transforms joins the two."""
        from_target, from_source = self._ancestors(target), self._ancestors(source)
        for ancestor, ancestor_from_source in from_source.items():
            if ancestor in from_target:
                return from_target[ancestor].inverse() @ ancestor_from_source
        return None

    def _ancestors(self, frame: str) -> dict[str, Pose]:
        """`ancestor_from_frame` of a frame and all above it, the nearest first."""
        name, pose = _bare(frame), Pose.identity()
        ancestors = {name: pose}
        while name in self._parents and len(ancestors) < DEEPEST:
            name, parent_from_child = self._parents[name]
            pose = parent_from_child @ pose
            if name in ancestors:
                break
            ancestors[name] = pose
        return ancestors


def _bare(frame: str) -> str:
    """Without the slash that ROS 1 wrote before it."""
    return frame.removeprefix("/")
