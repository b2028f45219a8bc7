"""Nearest frontier by travel distance (Yamauchi 1997), stopping at a detected target.

Kept: free cells beside unknown ones, clustered; the nearest reachable one by path; a full turn on
arrival; a seen target overrides. Changed: the nearest cell of a cluster stands for it instead of
its centroid, which may lie inside an obstacle; frontiers that could not be reached are ruled out
for a number of decisions instead of until the map changes; map, planner and stop rule are
TopoNav's.
"""

from __future__ import annotations

import numpy as np

from toponav.baselines.base import MappedSearch
from toponav.mapping.view import MapView
from toponav.policy.affordances import Phase
from toponav.types import Action, Observation


class FrontierAgent(MappedSearch):
    """Goes to the nearest frontier, turns once round, and goes on."""

    def reset(self, goal: str) -> None:
        """Forget the last episode; the search starts with a full turn."""
        super().reset(goal)
        self._turns_left = self._full_turn

    @property
    def _full_turn(self) -> int:
        return round(360.0 / self._config.locomotion.follower.turn_deg)

    def _explore(self, observation: Observation, view: MapView) -> Action:
        """Finish the turn on the spot, then set out for the nearest frontier; stop without one."""
        if self._turns_left > 0:
            self._turns_left -= 1
            return Action.TURN_LEFT
        reach = self._locomotion.reach(observation, view.grid)
        cost = reach.at(view.frontiers[:, :2])
        cost[~self._barren.admissible(view.frontiers, self._decisions)] = np.inf
        if not np.isfinite(cost).any():
            return Action.STOP
        self._set_out(view.frontiers[np.argmin(cost)], Phase.EXPLORATION, observation, view)
        self._turns_left = self._full_turn
        return self._locomotion.next_action(observation, view.grid) or Action.TURN_LEFT
