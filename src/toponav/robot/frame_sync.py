"""The messages of one instant brought together: colour, depth, labels, and the pose then."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from toponav.geometry import Pose
from toponav.robot.pose_buffer import PoseBuffer


@dataclass(frozen=True, eq=False)
class Instant:
    """What was taken together.

    Attributes:
        stamp_s: Time of the depth image.
        parts: A message of each kind, by its name.
        world_from_base: Where the robot was.
    """

    stamp_s: float
    parts: dict[str, Any]
    world_from_base: Pose


class FrameSync:
    """Matches images by their stamps, in whatever order they come, and drops what stays alone."""

    def __init__(self, kinds: Sequence[str], slop_s: float, kept: int = 16) -> None:
        """Wait for one message of each kind.

        Args:
            kinds: The first one gives the instant its time.
            slop_s: Stamps may differ by this much.
            kept: Messages of each kind that are waited with.
        """
        self._slop_s = slop_s
        self._waiting: dict[str, deque[tuple[float, Any]]] = {
            kind: deque(maxlen=kept) for kind in kinds
        }
        self._taken_s = float("-inf")

    def add(self, kind: str, stamp_s: float, message: Any) -> None:
        """A message came."""
        self._waiting[kind].append((stamp_s, message))

    def newest(self, poses: PoseBuffer) -> Instant | None:
        """The newest whole instant that is newer than the last one taken; None without one."""
        instants = self._whole(poses)
        return self._taken(instants[-1]) if instants else None

    def oldest(self, poses: PoseBuffer) -> Instant | None:
        """The oldest whole instant not taken yet; None without one."""
        instants = self._whole(poses)
        return self._taken(instants[0]) if instants else None

    def clear(self) -> None:
        """Nothing that came so far can be placed any more."""
        for waiting in self._waiting.values():
            waiting.clear()

    def _whole(self, poses: PoseBuffer) -> list[Instant]:
        first, *others = self._waiting
        found = []
        for stamp_s, message in sorted(self._waiting[first], key=lambda item: item[0]):
            pose = poses.at(stamp_s) if stamp_s > self._taken_s else None
            if pose is None:
                continue
            parts = {first: message}
            for kind in others:
                partner = min(
                    self._waiting[kind], key=lambda item: abs(item[0] - stamp_s), default=None
                )
                if partner is not None and abs(partner[0] - stamp_s) <= self._slop_s:
                    parts[kind] = partner[1]
            if len(parts) == len(self._waiting):
                found.append(Instant(stamp_s, parts, pose))
        return found

    def _taken(self, instant: Instant) -> Instant:
        self._taken_s = instant.stamp_s
        for waiting in self._waiting.values():
            while waiting and waiting[0][0] < instant.stamp_s - self._slop_s:
                waiting.popleft()
        return instant
