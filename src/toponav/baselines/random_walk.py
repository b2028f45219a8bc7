"""A random walk, stopping at a detected target: the floor under every comparison.

Walks straight for a random number of steps, turns by a random angle, and turns when it bumps. Map,
planner and stop rule are TopoNav's, so only the exploration is random.
"""

from __future__ import annotations

import numpy as np

from toponav.baselines.base import MappedSearch
from toponav.config import NavigatorConfig
from toponav.mapping.view import MapView
from toponav.perception.base import Detector
from toponav.policy.decision import DecisionListener
from toponav.types import Action, Observation

MAX_STRAIGHT_STEPS = 12
"""Longest straight leg, steps: three metres."""


class RandomAgent(MappedSearch):
    """Wanders; the same seed wanders the same way."""

    def __init__(
        self, detector: Detector, config: NavigatorConfig, seed: int, listener: DecisionListener
    ) -> None:
        """Take the shared parts and the seed of the walk."""
        self._seed = seed
        super().__init__(detector, config, listener)

    def reset(self, goal: str) -> None:
        """Forget the last episode and start the same walk again."""
        super().reset(goal)
        self._rng = np.random.default_rng(self._seed)
        self._queue: list[Action] = []

    def _explore(self, observation: Observation, view: MapView) -> Action:
        """The next action of the walk; a bump ends a straight leg."""
        del view
        if observation.collided or not self._queue:
            half_turn = round(180.0 / self._config.locomotion.follower.turn_deg)
            turn = (Action.TURN_LEFT, Action.TURN_RIGHT)[int(self._rng.integers(2))]
            turns = int(self._rng.integers(1, half_turn + 1))
            steps = int(self._rng.integers(1, MAX_STRAIGHT_STEPS + 1))
            self._queue = [turn] * turns + [Action.MOVE_FORWARD] * steps
        return self._queue.pop(0)
