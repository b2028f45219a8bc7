"""What to do when the world disagrees with the map: bumps, no progress, waypoints in vain."""

from __future__ import annotations

import math
from collections import deque

import numpy as np
from numpy.typing import NDArray

from toponav.config_model import ConfigModel
from toponav.geometry import Pose


class RecoveryConfig(ConfigModel):
    """When a heading, a cell or a waypoint is given up."""

    bump_radius_m: float = 0.2
    """A heading that was blocked is barred within this distance of the bump."""

    bump_angle_deg: float = 20.0
    """Headings this close to a blocked one are barred with it."""

    bumps_to_block: int = 3
    """Bumps within `bump_radius_m` of each other after which the cell ahead counts as obstacle."""

    contact_m: float = 0.25
    """How far ahead of the agent's centre that cell lies: its radius and half a step of depth."""

    window_steps: int = 30
    """Steps over which progress is looked for."""

    min_progress_m: float = 0.3
    """Less than this within the window, turns in place included, and the waypoint is given up."""

    barren_radius_m: float = 0.5
    """Waypoints this near to one that was given up are ruled out ..."""

    barren_decisions: int = 8
    """... for this many decisions."""


class BumpMemory:
    """Remembers where forward steps were cut short."""

    def __init__(self, config: RecoveryConfig) -> None:
        """Start without bumps."""
        self._config = config
        self._bumps: list[tuple[float, float, float]] = []
        self._blocked: list[tuple[float, float]] = []

    def add(self, world_from_base: Pose) -> None:
        """A forward step ended here, blocked."""
        x, y = (float(v) for v in world_from_base.translation[:2])
        yaw = world_from_base.yaw
        self._bumps.append((x, y, yaw))
        near = sum(
            math.dist((x, y), bump[:2]) <= self._config.bump_radius_m for bump in self._bumps
        )
        if near >= self._config.bumps_to_block:
            reach = self._config.contact_m
            self._blocked.append((x + reach * math.cos(yaw), y + reach * math.sin(yaw)))

    def barred(self, xy: NDArray[np.float64], heading: float) -> bool:
        """Whether a forward step at this heading was blocked near here."""
        limit = math.radians(self._config.bump_angle_deg)
        return any(
            abs(math.remainder(heading - yaw, math.tau)) <= limit
            and math.dist(xy, (x, y)) <= self._config.bump_radius_m
            for x, y, yaw in self._bumps
        )

    @property
    def blocked_xy(self) -> NDArray[np.float64]:
        """(N, 2) points that count as obstacles though no image shows one."""
        return np.asarray(self._blocked, dtype=np.float64).reshape(-1, 2)


class ProgressMonitor:
    """Notices that the agent goes nowhere."""

    def __init__(self, config: RecoveryConfig) -> None:
        """Start with an empty window."""
        self._config = config
        self._window: deque[tuple[float, float]] = deque(maxlen=config.window_steps)

    def restart(self) -> None:
        """A new waypoint: what came before does not count."""
        self._window.clear()

    def stalled(self, xy: NDArray[np.float64]) -> bool:
        """Add a position; whether the whole window stays within `min_progress_m` of it."""
        here = (float(xy[0]), float(xy[1]))
        self._window.append(here)
        if len(self._window) < self._config.window_steps:
            return False
        return max(math.dist(here, p) for p in self._window) < self._config.min_progress_m


class BarrenWaypoints:
    """Waypoints that were given up, ruled out for some decisions and then forgiven."""

    def __init__(self, config: RecoveryConfig) -> None:
        """Start without any."""
        self._config = config
        self._until: list[tuple[NDArray[np.float64], int]] = []

    def add(self, waypoint: NDArray[np.float64], decision: int) -> None:
        """Rule out a waypoint at the given decision count."""
        expiry = decision + self._config.barren_decisions
        self._until.append((np.asarray(waypoint[:2], dtype=np.float64), expiry))

    def admissible(self, points: NDArray[np.floating], decision: int) -> NDArray[np.bool_]:
        """(N,) bool: which of (N, 2 or 3) points are not ruled out at this decision."""
        allowed = np.ones(len(points), dtype=np.bool_)
        for waypoint, expiry in self._until:
            if decision <= expiry:
                offset = points[:, :2] - waypoint
                allowed &= np.hypot(offset[:, 0], offset[:, 1]) > self._config.barren_radius_m
        return allowed
