"""The guide of `--follower oracle`: the simulator's own navmesh, followed greedily."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from toponav.envs.simulator import HouseEnv
from toponav.envs.surface import Distances

NEAR_M = 0.5
"""A goal that lies off the navmesh is moved onto it over at most this distance, metres."""

TURN_COST_M = 0.04
"""What a turn costs: enough to settle ties for the heading that needs fewer."""

GAIN_M = 0.02
"""A step that brings the agent less is none."""


class OracleGuide:
    """Plans with the truth: where the agent is, and where it can walk."""

    def __init__(self, env: HouseEnv) -> None:
        """Take the environment of the running episode."""
        self._env = env
        half = round(180.0 / env.config.turn_deg)
        self._turns = sorted(range(-half + 1, half + 1), key=lambda turn: (abs(turn), -turn))
        self._goal: NDArray[np.float64] | None = None
        self._field: Distances | None = None

    def turns(self, goals: NDArray[np.float64]) -> int | None:
        """The turn after which a step leads nearest to the goals, turns being costly."""
        env = self._env
        field = self._towards(goals)
        if field is None:
            return None
        now = field.at(env.position)
        best, best_turn = math.inf, None
        for turn in self._turns:
            yaw = env.yaw + turn * math.radians(env.config.turn_deg)
            motion = env.surface.move(env.position, yaw, env.config.forward_m)
            left = field.at(motion.position)
            value = left + TURN_COST_M * abs(turn)
            if not motion.collided and left < now - GAIN_M and value < best:
                best, best_turn = value, turn
        return best_turn

    def _towards(self, goals: NDArray[np.float64]) -> Distances | None:
        """Distances to the nearest goal on the navmesh; None where there is none."""
        here, surface = self._env.position, self._env.surface
        gaps = np.linalg.norm(goals - here[:2], axis=1)
        for goal in goals[np.argsort(gaps, kind="stable")]:
            if self._goal is not None and np.array_equal(goal, self._goal):
                return self._field
            place = surface.snap(np.array([*goal, here[2]]), NEAR_M)
            if place is None:
                continue
            field = surface.distance_field(place[None])
            if math.isfinite(field.at(here)):
                self._goal, self._field = goal.copy(), field
                return field
        return None
