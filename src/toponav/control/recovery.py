"""What to do when the world disagrees with the map: bumps, no progress, waypoints in vain."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import Field

from toponav.config_model import ConfigModel
from toponav.geometry import Pose


class RecoveryConfig(ConfigModel):
    """When a heading, a cell or a waypoint is given up."""

    bump_radius_m: float = Field(default=0.2, ge=0.0)
    """A heading that was blocked is barred within this distance of the bump, metres."""

    bump_angle_deg: float = Field(default=20.0, ge=0.0)
    """Headings this close to a blocked one are barred with it, degrees: less than a turn."""

    bumps_to_block: int = Field(default=3, ge=1)
    """Bumps within `bump_radius_m` of each other after which the cell ahead counts as obstacle."""

    contact_m: float = Field(default=0.25, gt=0.0)
    """How far ahead of the agent's centre that cell lies, metres: the agent's 0.18 m radius and
    most of a 0.1 m cell."""

    patience_steps: int = Field(default=20, ge=1)
    """Steps without progress after which the waypoint is given up; a half turn takes six."""

    min_progress_m: float = Field(default=0.2, gt=0.0)
    """Progress is a cost-to-go this much lower than the lowest so far, metres: most of a step."""

    detour_m: float = Field(default=0.5, gt=0.0)
    """A cost-to-go that grows by this much in one step means that the map has shown a longer way:
    progress is counted anew from there."""

    max_detours: int = Field(default=10, ge=0)
    """Detours on one walk; later ones do not count anew, so that every walk ends."""

    barren_radius_m: float = Field(default=0.5, ge=0.0)
    """Waypoints this near to one that was given up are ruled out ..."""

    barren_decisions: int = Field(default=8, ge=0)
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

    def barred(self, xy: ArrayLike, heading: float) -> bool:
        """Whether a forward step at this heading (radians) was blocked near (2,) xy."""
        position = np.asarray(xy, dtype=np.float64)
        limit = math.radians(self._config.bump_angle_deg)
        return any(
            abs(math.remainder(heading - yaw, math.tau)) <= limit
            and math.dist(position, (x, y)) <= self._config.bump_radius_m
            for x, y, yaw in self._bumps
        )

    @property
    def blocked_xy(self) -> NDArray[np.float64]:
        """(N, 2) points that count as obstacles though no image shows one."""
        return np.asarray(self._blocked, dtype=np.float64).reshape(-1, 2)


class ProgressMonitor:
    """Notices that a walk gets no nearer to its goal, standing still or going in circles."""

    def __init__(self, config: RecoveryConfig) -> None:
        """Start a walk."""
        self._config = config
        self.restart()

    def restart(self) -> None:
        """A new goal: what came before does not count."""
        self._lowest_m = self._last_m = math.inf
        self._steps_without = 0
        self._detours = 0

    def stalled(self, cost_to_go_m: float) -> bool:
        """Add the cost-to-go of one step; whether patience has run out, or no way is left."""
        if not math.isfinite(cost_to_go_m):
            return True
        config = self._config
        detour = cost_to_go_m - self._last_m >= config.detour_m
        if detour and self._detours < config.max_detours:
            self._detours += 1
            self._lowest_m = math.inf
        self._last_m = cost_to_go_m
        if cost_to_go_m <= self._lowest_m - config.min_progress_m:
            self._lowest_m = cost_to_go_m
            self._steps_without = 0
            return False
        self._steps_without += 1
        return self._steps_without >= config.patience_steps


class BarrenWaypoints:
    """Waypoints that were given up, ruled out for some decisions and then forgiven."""

    def __init__(self, config: RecoveryConfig) -> None:
        """Start without any."""
        self._config = config
        self._until: list[tuple[NDArray[np.float64], int]] = []

    def add(self, waypoint: ArrayLike, decision: int) -> None:
        """Rule out a (2 or 3,) waypoint at the given decision count."""
        expiry = decision + self._config.barren_decisions
        self._until.append((np.asarray(waypoint, dtype=np.float64)[:2], expiry))

    def admissible(self, points: NDArray[np.floating], decision: int) -> NDArray[np.bool_]:
        """(N,) bool: which of (N, 2 or 3) points are not ruled out at this decision."""
        allowed = np.ones(len(points), dtype=np.bool_)
        for waypoint, expiry in self._until:
            if decision <= expiry:
                offset = points[:, :2] - waypoint
                allowed &= np.hypot(offset[:, 0], offset[:, 1]) > self._config.barren_radius_m
        return allowed
