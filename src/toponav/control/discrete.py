"""Following a cost field with the protocol's discrete motion: 0.25 m steps, 30 degree turns."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from toponav.config_model import ConfigModel
from toponav.control.planner import CostField
from toponav.geometry import Pose
from toponav.types import Action


class FollowerConfig(ConfigModel):
    """The motion model and how far it is looked ahead."""

    forward_m: float = 0.25
    """Length of a forward step (PROTOCOL)."""

    turn_deg: float = 30.0
    """Angle of a turn (PROTOCOL)."""

    lookahead_steps: int = 3
    """Forward steps rolled out along each heading."""

    turn_cost_m: float = 0.04
    """What a turn costs in metres: enough to settle ties for the heading that needs fewer."""

    sample_m: float = 0.05
    """Spacing of the points at which a rolled-out step is checked against the map."""


HeadingBarred = Callable[[float], bool]
"""Whether a forward step at a world heading (radians) was tried here and blocked."""


class DiscreteFollower:
    """Chooses the turn or step that leads down a cost field soonest; deterministic, stateless.

    Each of the headings that turning can reach is rolled out a few forward steps over the known
    map; the value of a heading is the cost of getting to the best of its ends, plus the cost-to-go
    from there. Turning towards the best heading only makes it better, so the agent never dithers.
    """

    def __init__(self, config: FollowerConfig) -> None:
        """Precompute the turns, the smallest and then the left one first."""
        self._config = config
        half = round(180.0 / config.turn_deg)
        self._turns = sorted(range(-half + 1, half + 1), key=lambda k: (abs(k), -k))

    def next_action(
        self, world_from_base: Pose, field: CostField, barred: HeadingBarred
    ) -> Action | None:
        """The next turn or forward step; None when no heading leads anywhere."""
        position, yaw = world_from_base.translation[:2], world_from_base.yaw
        best_turn, best_value = None, math.inf
        for turn in self._turns:
            heading = yaw + turn * math.radians(self._config.turn_deg)
            if barred(heading):
                continue
            value = self._value(position, heading, field) + self._config.turn_cost_m * abs(turn)
            if value < best_value - 1e-9:
                best_turn, best_value = turn, value
        if best_turn is None:
            return None
        if best_turn == 0:
            return Action.MOVE_FORWARD
        return Action.TURN_LEFT if best_turn > 0 else Action.TURN_RIGHT

    def face(self, world_from_base: Pose, point_xy: NDArray[np.floating]) -> Action | None:
        """The turn towards a point; None when it is already as nearly ahead as turns allow."""
        offset = np.asarray(point_xy[:2], dtype=np.float64) - world_from_base.translation[:2]
        bearing = math.atan2(offset[1], offset[0]) - world_from_base.yaw
        bearing = math.remainder(bearing, math.tau)
        if abs(bearing) <= 0.5 * math.radians(self._config.turn_deg) + 1e-9:
            return None
        return Action.TURN_LEFT if bearing > 0.0 else Action.TURN_RIGHT

    def _value(self, position: NDArray[np.float64], heading: float, field: CostField) -> float:
        """Cost of the best number of forward steps along a heading, plus the cost-to-go."""
        config = self._config
        per_step = round(config.forward_m / config.sample_m)
        distance = config.sample_m * np.arange(1, per_step * config.lookahead_steps + 1)
        direction = np.array([math.cos(heading), math.sin(heading)])
        samples = position + distance[:, None] * direction
        grid = field.clearance.grid
        index = grid.index_of(samples)
        inside = grid.contains(index)
        cell = np.where(inside[:, None], index, 0)
        passable = inside & field.clearance.traversable[cell[:, 0], cell[:, 1]]
        free = int(np.argmin(passable)) if not passable.all() else len(passable)
        step_cost = field.clearance.step_cost[cell[:, 0], cell[:, 1]]
        travelled = np.cumsum(step_cost) * config.sample_m
        ends = np.arange(per_step - 1, free, per_step)
        if not len(ends):
            return math.inf
        return float((travelled[ends] + field.cost[cell[ends, 0], cell[ends, 1]]).min())
