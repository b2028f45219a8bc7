"""What the frontier-based methods share: turn round, choose a frontier, walk there, and again."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from toponav.baselines.base import MappedSearch
from toponav.control.frontier_clusters import FrontierCluster, frontier_clusters
from toponav.control.planner import CostField
from toponav.mapping.view import MapView
from toponav.policy.affordances import Phase
from toponav.types import Action, Observation


class FrontierSearch(MappedSearch):
    """Goes to one frontier after the other, until none is left that can be reached."""

    initial_turn_deg: ClassVar[float] = 360.0
    """Turn on the spot with which an episode starts, degrees; 0 for none."""

    arrival_turn_deg: ClassVar[float] = 0.0
    """Turn on the spot where a walk to a frontier has ended, degrees; 0 for none."""

    def reset(self, goal: str) -> None:
        """Forget the last episode; the search starts with the method's turn."""
        super().reset(goal)
        self._turn_round(self.initial_turn_deg)

    @abstractmethod
    def _choose(
        self,
        clusters: Sequence[FrontierCluster],
        reach: CostField,
        observation: Observation,
        view: MapView,
    ) -> NDArray[np.float64]:
        """The (3,) waypoint among one or more clusters.

        Args:
            clusters: The frontiers that can be walked to and were not just tried in vain.
            reach: Cost of walking from the agent to every cell.
            observation: The last frame.
            view: The map.
        """

    def _without_frontiers(self) -> Action:
        """The action where no frontier is left that can be reached: by default the end."""
        return Action.STOP

    def _explore(self, observation: Observation, view: MapView) -> Action:
        """Set out for the chosen frontier, or go on to the present one."""
        reach = self._locomotion.reach(observation, view.grid)
        admissible = self._barren.admissible(view.frontiers, self._decisions)
        clusters = frontier_clusters(view, reach, admissible)
        if not clusters:
            return self._without_frontiers()
        waypoint = self._choose(clusters, reach, observation, view)
        if self._waypoint is None or not np.array_equal(waypoint, self._waypoint):
            self._set_out(waypoint, Phase.EXPLORATION, observation, view)
            self._turn_round(self.arrival_turn_deg)
        # Where the walk ends at once, one more look from here lets the next step choose anew.
        return self._locomotion.next_action(observation, view.grid) or Action.TURN_LEFT
