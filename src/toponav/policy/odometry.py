"""Where the agent has been: S_hist and the way since the last waypoint."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from toponav.types import Observation

MIN_STEP_M = 0.01
"""Poses nearer than this to the last one (turns in place) are not kept."""


class Odometry:
    """Accumulates the base poses of an episode."""

    def __init__(self) -> None:
        """Start nowhere."""
        self._points: list[NDArray[np.float64]] = []
        self._since_arrival_m = 0.0

    def add(self, observation: Observation) -> None:
        """Take the pose of one observation."""
        point = observation.world_from_base.translation
        if self._points:
            moved = float(np.linalg.norm(point - self._points[-1]))
            if moved < MIN_STEP_M:
                return
            self._since_arrival_m += moved
        self._points.append(point)

    def arrive(self) -> None:
        """At a waypoint: measure the way to the next one from here."""
        self._since_arrival_m = 0.0

    @property
    def started(self) -> bool:
        """Whether any pose has been taken."""
        return bool(self._points)

    @property
    def position_xy(self) -> tuple[float, float]:
        """Where the agent stands, world frame, metres."""
        x, y, _ = self._points[-1]
        return float(x), float(y)

    @property
    def since_arrival_m(self) -> float:
        """Metres walked since the last `arrive`."""
        return self._since_arrival_m

    @property
    def history(self) -> NDArray[np.float64]:
        """S_hist: (N, 3) positions on the floor, in order."""
        return np.asarray(self._points, dtype=np.float64).reshape(-1, 3)
