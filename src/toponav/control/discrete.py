"""Following a cost field with the protocol's discrete motion: 0.25 m steps, 30 degree turns."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import Field

from toponav.config_model import ConfigModel
from toponav.control.planner import CostField
from toponav.geometry import Pose
from toponav.types import Action


class FollowerConfig(ConfigModel):
    """The motion model and how far it is looked ahead."""

    forward_m: float = Field(default=0.25, gt=0.0)
    """Length of a forward step, metres (PROTOCOL)."""

    turn_deg: float = Field(default=30.0, gt=0.0, le=90.0)
    """Angle of a turn, degrees (PROTOCOL)."""

    lookahead_steps: int = Field(default=3, ge=1)
    """Forward steps rolled out along each heading."""

    turn_cost_m: float = Field(default=0.04, gt=0.0)
    """What a turn costs in metres: enough to settle ties for the heading that needs fewer."""

    sample_m: float = Field(default=0.05, gt=0.0)
    """Largest spacing of the points at which a rolled-out step is checked against the map."""


HeadingBarred = Callable[[float], bool]
"""Whether a forward step at a world heading (radians) was tried here and blocked."""

VALUE_DIGITS = 9
"""Values are compared to a nanometre, so that symmetric headings tie on every machine."""


class DiscreteFollower:
    """Chooses the turn or step that leads down a cost field soonest; deterministic, stateless.

    Each heading that turning can reach is rolled out a few forward steps over the known map; its
    value is the cost of the turns and of getting to the best of the steps' ends, plus the
    cost-to-go from there. A turn towards the best heading makes that heading cheaper by one turn
    and no other by more, so on one map the agent never turns back and forth.
    """

    def __init__(self, config: FollowerConfig) -> None:
        """Precompute the turns, the smallest and then the left one first."""
        half = round(180.0 / config.turn_deg)
        turns = sorted(range(-half + 1, half + 1), key=lambda turn: (abs(turn), -turn))
        self._turns = np.array(turns)
        self._turn_rad = math.radians(config.turn_deg)
        self._turn_cost_m = config.turn_cost_m
        self._samples_per_step = math.ceil(config.forward_m / config.sample_m - 1e-9)
        self._spacing_m = config.forward_m / self._samples_per_step
        self._samples = self._samples_per_step * config.lookahead_steps

    def next_action(
        self, world_from_base: Pose, field: CostField, barred: HeadingBarred
    ) -> Action | None:
        """The next turn or forward step; None when no heading leads to the field's goal."""
        headings = world_from_base.yaw + self._turns * self._turn_rad
        value = self._values(world_from_base.translation[:2], headings, field)
        value += self._turn_cost_m * np.abs(self._turns)
        value[[barred(float(heading)) for heading in headings]] = np.inf
        best = int(np.argmin(np.round(value, VALUE_DIGITS)))
        if not np.isfinite(value[best]):
            return None
        turn = int(self._turns[best])
        if turn == 0:
            return Action.MOVE_FORWARD
        return Action.TURN_LEFT if turn > 0 else Action.TURN_RIGHT

    def face(self, world_from_base: Pose, point_xy: ArrayLike) -> Action | None:
        """The turn towards a (2 or 3,) point; None when no turn brings it nearer to ahead."""
        offset = np.asarray(point_xy, dtype=np.float64)[:2] - world_from_base.translation[:2]
        bearing = math.atan2(offset[1], offset[0]) - world_from_base.yaw
        bearing = math.remainder(bearing, math.tau)
        if abs(bearing) <= 0.5 * self._turn_rad + 1e-9:
            return None
        return Action.TURN_LEFT if bearing > 0.0 else Action.TURN_RIGHT

    def _values(
        self, position: NDArray[np.float64], headings: NDArray[np.float64], field: CostField
    ) -> NDArray[np.float64]:
        """(H,) cost along each heading to its best end plus the cost-to-go; infinite if blocked."""
        distance = self._spacing_m * np.arange(1, self._samples + 1)
        direction = np.stack([np.cos(headings), np.sin(headings)], axis=-1)
        clearance = field.clearance
        samples = position + distance[:, None] * direction[:, None, :]
        cells = clearance.grid.index_of(samples)
        inside = clearance.grid.contains(cells)
        i, j = np.moveaxis(np.where(inside[..., None], cells, 0), -1, 0)
        fits = np.logical_and.accumulate(inside & clearance.traversable[i, j], axis=1)
        travelled = np.cumsum(clearance.step_cost[i, j], axis=1) * self._spacing_m
        ends = np.s_[:, self._samples_per_step - 1 :: self._samples_per_step]
        value = np.where(fits[ends], travelled[ends] + field.at(samples[ends]), np.inf)
        best: NDArray[np.float64] = value.min(axis=1)
        return best
