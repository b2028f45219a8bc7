"""What goes wrong with the simulated robot's sensors, and when."""

from __future__ import annotations

import math

import numpy as np
from pydantic import Field

from toponav.config_model import ConfigModel
from toponav.geometry import Pose

DRIVING = 0.2
"""A robot at this speed drives, m/s."""


class FaultConfig(ConfigModel):
    """Faults; none by default.

    Times are seconds after the robot's first motion; then the fault waits until the robot drives,
    so that there is something to stop.
    """

    drop: float = Field(default=0.0, ge=0.0, lt=1.0)
    """Share of images that are lost, colour and depth each by themselves."""

    latency_s: float = Field(default=0.0, ge=0.0)
    """Images come so much later than they were taken."""

    jump_at_s: float = math.inf
    """When the pose jumps, as by a loop closure, for good."""

    jump_m: float = Field(default=0.3, ge=0.0)
    """How far it jumps."""

    silent_at_s: float = math.inf
    """When the camera falls silent."""

    silent_s: float = Field(default=3.0, ge=0.0)
    """For how long."""


class Faults:
    """Tells what of the robot's messages is lost, late or wrong."""

    def __init__(self, config: FaultConfig, rng: np.random.Generator) -> None:
        """Draw losses from `rng`."""
        self.config = config
        self._rng = rng
        self._moved_s: float | None = None
        self._begun_s: dict[str, float] = {}

    def moves(self, now_s: float, speed: float) -> None:
        """The robot turns, or drives at `speed` (m/s)."""
        if self._moved_s is None:
            self._moved_s = now_s
        if speed < DRIVING:
            return
        config = self.config
        for name, at_s in (("jump", config.jump_at_s), ("silent", config.silent_at_s)):
            if now_s - self._moved_s >= at_s:
                self._begun_s.setdefault(name, now_s)

    def times(self) -> dict[str, float]:
        """When each fault set in, by the robot's clock."""
        return dict(self._begun_s)

    def is_silent(self, now_s: float) -> bool:
        """Whether the camera takes nothing now."""
        return now_s - self._begun_s.get("silent", -math.inf) < self.config.silent_s

    def loses(self) -> bool:
        """Whether this image is lost."""
        return self.config.drop > 0.0 and bool(self._rng.random() < self.config.drop)

    def reported(self, pose: Pose) -> Pose:
        """What the SLAM says of a pose."""
        if "jump" not in self._begun_s:
            return pose
        return Pose.from_rotation(np.eye(3), (self.config.jump_m, 0.0, 0.0)) @ pose
