"""Exploring by a plan over frontiers: where to, until when, and what is looked at on arrival."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from toponav.control.drops import ON_FLIGHT_M, DropEdge, DropEdges
from toponav.control.frontier_clusters import FrontierCluster, frontier_clusters
from toponav.control.locomotion import Locomotion, LocomotionConfig
from toponav.control.looks import Looks
from toponav.control.planner import CostField, Planner
from toponav.control.search_plan import (
    Belief,
    SearchPlanConfig,
    frontier_towards,
    is_on_stairs,
    landing,
    ranked_frontiers,
)
from toponav.geometry import Pose
from toponav.mapping.view import MapView
from toponav.policy.decision import WeighedFrontier
from toponav.policy.glimpses import Glimpse
from toponav.reasoning.base import Reasoner
from toponav.types import Action, Observation

SAME_FLIGHT_M = 5.0
"""What leads on from the flight on which the agent is lies no farther than this."""


@dataclass(frozen=True, eq=False)
class Hints:
    """What speaks for some of the frontiers.

    Attributes:
        guided: (M, 2) frontier cells about the place that the reasoner names.
        glimpses: Where the target was seen, too far off to be mapped.
        elsewhere: Whether the target was seen on another storey.
    """

    guided: NDArray[np.float64]
    glimpses: tuple[Glimpse, ...] = ()
    elsewhere: bool = False


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
        self._drops = DropEdges()
        self._looks = Looks()
        self._left_floor: int | None = None
        self._landing = False
        self._turns = 0

    @property
    def weighed(self) -> tuple[WeighedFrontier, ...]:
        """What the present choice was made from, in the order of visits."""
        return self._weighed

    @property
    def looking_down(self) -> bool:
        """Whether the camera is tilted, so that nothing else may be done now."""
        return self._drops.looking_down

    def step_off(
        self, foot_z: float, view: MapView, reach: CostField
    ) -> NDArray[np.float64] | None:
        """The (3,) landing that one walks to first from a flight, once its floor is known; or None.

        Args:
            foot_z: Height of the agent's foot point, metres.
            view: The map.
            reach: Cost of walking from the agent to every cell.
        """
        self.leave()
        if view.floor == self._left_floor or self._left_floor is None:
            return None
        if not self._on_flight(foot_z, view):
            self._left_floor = None
            return None
        self._landing = True
        self._waypoint = landing(view, reach)
        return self._waypoint

    def set_out(
        self,
        hints: Hints,
        foot_z: float,
        view: MapView,
        reach: CostField,
        admissible: NDArray[np.bool_],
    ) -> NDArray[np.float64] | None:
        """The (3,) waypoint of the next frontier; None when none is left that can be reached.

        Args:
            hints: What speaks for some of the frontiers.
            foot_z: Height of the agent's foot point, metres.
            view: The map.
            reach: Cost of walking from the agent to every cell.
            admissible: (F,) which of `view.frontiers` were not just tried in vain.
        """
        self.leave()
        frontiers, stairs = self._choices(view, reach, admissible)
        if self._on_flight(foot_z, view) and self._left_floor == view.floor:
            # nobody turns round half-way
            own = tuple(end for end in stairs if end.path_cost <= SAME_FLIGHT_M)
            frontiers, stairs = ((), own) if own else (frontiers, stairs)
        if not frontiers and not stairs:
            return None
        seen = {name: a for name, a in self._affinities().items() if name in view.objects}
        belief = Belief(seen, hints.guided, hints.glimpses, hints.elsewhere, self._looks)
        choices = (frontiers, stairs)
        self._weighed = ranked_frontiers(choices, belief, view, reach, self._planner, self._config)
        self._waypoint = self._weighed[0].waypoint
        chosen = next(c for c in (*frontiers, *stairs) if c.nearest is self._waypoint)
        self._drops.approach(chosen if isinstance(chosen, DropEdge) else None)
        if chosen in stairs:
            self._left_floor = view.floor
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
        self._landing = False
        self._drops.approach(None)

    def is_gone(self, view: MapView) -> bool:
        """Whether the frontier that is gone to has been seen from afar."""
        if self._waypoint is None or self._drops.approached or self._landing:
            return False
        return not bool((_distance(view, self._waypoint) <= self._config.vanished_m).any())

    def observe(self, world_from_base: Pose) -> None:
        """Note where the camera looks; call once a step."""
        self._looks.add(world_from_base)

    def look(self, observation: Observation, view: MapView, walker: Locomotion) -> Action | None:
        """On arrival, the turn towards what is left of the frontier; None when that is seen."""
        action = self._drops.look(observation, view, walker)
        if action is not None:
            return action
        foot_z = float(observation.world_from_base.translation[2])
        at_flight = self._landing or self._on_flight(foot_z, view)
        if at_flight and self._turns < self._full_turn:
            self._turns += 1  # the next floor may go on to any side
            return Action.TURN_LEFT
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

    @staticmethod
    def _on_flight(foot_z: float, view: MapView) -> bool:
        return abs(foot_z - view.floor_z) > ON_FLIGHT_M

    def _choices(
        self, view: MapView, reach: CostField, admissible: NDArray[np.bool_]
    ) -> tuple[tuple[FrontierCluster, ...], tuple[FrontierCluster, ...]]:
        """What there is on this floor, and what leads to others: stairs and edges."""
        clusters = frontier_clusters(view, reach, admissible)
        on_stairs = [is_on_stairs(cluster, view) for cluster in clusters]
        frontiers = tuple(c for c, stairs in zip(clusters, on_stairs, strict=True) if not stairs)
        flights = tuple(c for c, stairs in zip(clusters, on_stairs, strict=True) if stairs)
        return frontiers, (*flights, *self._drops.clusters(view, reach))

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
