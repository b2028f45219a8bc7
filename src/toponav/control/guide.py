"""Walks that somebody else plans: a guide that knows the scene, for comparison only.

Papers whose agents follow paths on the simulator's navmesh are compared on equal terms by
`--follower oracle`; a run that does so is named in every table.
"""

from __future__ import annotations

import math
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from toponav.geometry import Pose
from toponav.types import Action

CORNER_M = 0.1
"""A corner of the path this near has been passed."""

PATIENCE = 20
"""Steps without getting nearer after which a walk is given up."""

PROGRESS_M = 0.05
"""What counts as nearer."""


class Guide(Protocol):
    """Knows the way."""

    def path(self, goals: NDArray[np.float64]) -> NDArray[np.float64]:
        """(K, 2) corners from the agent to the nearest of (N, 2) goals; empty without a way."""
        ...


@runtime_checkable
class Guidable(Protocol):
    """An agent whose walks a guide can plan."""

    def follow(self, guide: Guide) -> None:
        """Walk as the guide says, from the next episode on."""
        ...


class GuidedWalk:
    """Follows a guide's path greedily: turn towards its next corner, then step."""

    def __init__(self, guide: Guide, turn_rad: float) -> None:
        """Take the guide and the angle of a turn."""
        self._guide = guide
        self._turn_rad = turn_rad
        self.restart()

    def restart(self) -> None:
        """A new walk begins."""
        self._shortest, self._waited = math.inf, 0

    def next_action(self, world_from_base: Pose, goals: NDArray[np.float64]) -> Action | None:
        """The next turn or step; None without a way, or when it leads no nearer."""
        path = self._guide.path(goals)
        if len(path) < 2:
            return None
        length = float(np.linalg.norm(np.diff(path, axis=0), axis=1).sum())
        self._waited += 1
        if length < self._shortest - PROGRESS_M:
            self._shortest, self._waited = length, 0
        if self._waited > PATIENCE:
            return None
        here = world_from_base.translation[:2]
        ahead = [corner for corner in path[1:] if math.dist(corner, here) > CORNER_M]
        x, y = (ahead[0] if ahead else path[-1]) - here
        bearing = math.remainder(math.atan2(y, x) - world_from_base.yaw, math.tau)
        if abs(bearing) <= 0.5 * self._turn_rad + 1e-9:
            return Action.MOVE_FORWARD
        return Action.TURN_LEFT if bearing > 0.0 else Action.TURN_RIGHT
