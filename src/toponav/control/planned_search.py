"""Exploring by a plan over frontiers: where to, until when, and what is looked at on arrival."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from toponav.control.frontier_clusters import FrontierCluster, frontier_clusters
from toponav.control.locomotion import Locomotion, LocomotionConfig
from toponav.control.planner import CostField, Planner
from toponav.control.search_plan import (
    Belief,
    SearchPlanConfig,
    frontier_towards,
    ranked_frontiers,
)
from toponav.mapping.view import MapView
from toponav.policy.decision import WeighedFrontier
from toponav.reasoning.base import Reasoner
from toponav.types import Action, Observation


class PlannedSearch:
    """Goes from frontier to frontier; its state is the frontier that is gone to."""

    def __init__(
        self,
        target: str,
        vocabulary: Sequence[str],
        config: SearchPlanConfig,
        locomotion: LocomotionConfig,
        reasoner: Reasoner,
    ) -> None:
        """Begin a search.

        Args:
            target: What is looked for.
            vocabulary: Everything that may be seen; the reasoner is asked of all of it at once.
            config: How frontiers are weighed.
            locomotion: How the agent walks and turns.
            reasoner: Says what goes with the target.
        """
        self._target = target
        self._names = [name for name in vocabulary if name != target]
        self._affinity: dict[str, float] | None = None
        self._config = config
        self._planner = Planner(locomotion.planner)
        self._full_turn = round(360.0 / locomotion.follower.turn_deg)
        self._reasoner = reasoner
        self._waypoint: NDArray[np.float64] | None = None
        self._weighed: tuple[WeighedFrontier, ...] = ()
        self._turns = 0

    @property
    def weighed(self) -> tuple[WeighedFrontier, ...]:
        """What the present choice was made from, in the order of visits."""
        return self._weighed

    def set_out(
        self,
        guided: NDArray[np.float64],
        view: MapView,
        reach: CostField,
        admissible: NDArray[np.bool_],
    ) -> NDArray[np.float64] | None:
        """The (3,) waypoint of the next frontier; None when none is left that can be reached.

        Args:
            guided: (M, 2) frontier cells about the place that the reasoner names.
            view: The map.
            reach: Cost of walking from the agent to every cell.
            admissible: (F,) which of `view.frontiers` were not just tried in vain.
        """
        clusters = self._clusters(view, reach, admissible)
        if clusters:
            seen = {name: a for name, a in self._affinities().items() if name in view.objects}
            belief = Belief(seen, guided)
            self._weighed = ranked_frontiers(
                clusters, belief, view, reach, self._planner, self._config
            )
            self._waypoint = self._weighed[0].waypoint
        return self._waypoint

    def set_out_towards(
        self,
        target_points: NDArray[np.floating],
        view: MapView,
        reach: CostField,
        admissible: NDArray[np.bool_],
    ) -> NDArray[np.float64] | None:
        """The (3,) waypoint of the frontier by which a target in sight may be reached, or None."""
        clusters = self._clusters(view, reach, admissible)
        if clusters:
            self._waypoint = frontier_towards(clusters, target_points)
        return self._waypoint

    def leave(self) -> None:
        """Something else than a frontier is gone to."""
        self._waypoint, self._weighed = None, ()

    def is_gone(self, view: MapView) -> bool:
        """Whether the frontier that is gone to has been seen from afar."""
        if self._waypoint is None:
            return False
        return not bool((_distance(view, self._waypoint) <= self._config.vanished_m).any())

    def look(self, observation: Observation, view: MapView, walker: Locomotion) -> Action | None:
        """On arrival, the turn towards what is left of the frontier; None when that is seen."""
        distance = _distance(view, observation.world_from_base.translation)
        if not (distance <= self._config.rest_m).any() or self._turns >= self._full_turn:
            self._turns = 0
            return None
        self._turns += 1
        action = walker.face(observation, view.frontiers[int(np.argmin(distance)), :2])
        if action is None:
            self._turns = 0
        return action

    def _affinities(self) -> dict[str, float]:
        """What goes with the target, asked when it is first needed."""
        if self._affinity is None:
            values = self._reasoner.object_affinity(self._target, self._names).tolist()
            self._affinity = dict(zip(self._names, values, strict=True))
        return self._affinity

    def _clusters(
        self, view: MapView, reach: CostField, admissible: NDArray[np.bool_]
    ) -> tuple[FrontierCluster, ...]:
        """The frontiers to choose from; the last choice is forgotten."""
        self.leave()
        return frontier_clusters(view, reach, admissible)


def _distance(view: MapView, position: NDArray[np.float64]) -> NDArray[np.float64]:
    """(F,) from a position to each frontier cell, metres."""
    offset = view.frontiers[:, :2] - position[:2]
    away: NDArray[np.float64] = np.hypot(offset[:, 0], offset[:, 1])
    return away
