"""Exploring by a plan over frontiers: where to, until when, and what is looked at on arrival."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from toponav.control.drops import ON_FLIGHT_M, DropEdge, DropEdges
from toponav.control.frontier_clusters import FrontierCluster, frontier_clusters
from toponav.control.locomotion import Locomotion, LocomotionConfig
from toponav.control.looks import Looks
from toponav.control.planner import CostField, Planner
from toponav.control.search_plan import (
    GLIMPSED,
    Belief,
    SearchPlanConfig,
    frontier_towards,
    is_on_stairs,
    landing,
    off_this_floor,
    ranked_frontiers,
)
from toponav.control.storeys import LEAST_PROMISE, Storeys
from toponav.geometry import Pose
from toponav.mapping.unknown_area import unknown_area_m2
from toponav.mapping.view import MapView
from toponav.policy.decision import WeighedFrontier
from toponav.policy.glimpses import Glimpse
from toponav.reasoning.base import Reasoner
from toponav.types import Action, Observation

SAME_FLIGHT_M = 5.0
"""What leads on from the flight on which the agent is lies no farther than this."""

SAME_LANDING_M = 0.1
"""Who is to land once more where it has just landed gets no farther that way."""

SQUEEZE_M = 5.0
"""What a gap costs that may be too narrow, metres: trying it takes some steps."""

SQUEEZE_FOR_M2 = 3.0
"""Gaps that may be too narrow are tried only for so much unknown floor behind them."""


@dataclass(frozen=True, eq=False)
class Standing:
    """Where the agent is, and where it can walk.

    Attributes:
        foot_z: Height of its foot point, metres.
        reach: Cost of walking from there to every cell.
        squeezed: The same through gaps that may be too narrow; worked out when it is asked for.
        admissible: (F,) which of the map's frontiers were not just tried in vain.
    """

    foot_z: float
    reach: CostField
    squeezed: Callable[[], CostField]
    admissible: NDArray[np.bool_]


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
        self._landed: list[NDArray[np.float64]] = []
        self._revisiting = False
        self._storeys = Storeys()
        self.squeezes = False
        """Whether the way to what was chosen leads through a gap that may be too narrow."""
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
        onward = landing(view, reach)
        if onward is not None and any(
            np.hypot(*(onward - landed)[:2]) < SAME_LANDING_M for landed in self._landed
        ):
            self._left_floor = None  # it is there, whatever the map knows of its height
            return None
        self._landing, self._waypoint = True, onward
        return self._waypoint

    def set_out(
        self, hints: Hints, standing: Standing, view: MapView
    ) -> NDArray[np.float64] | None:
        """The (3,) waypoint of the next frontier; None when none is left that can be reached.

        Args:
            hints: What speaks for some of the frontiers.
            standing: Where the agent is.
            view: The map.
        """
        self.leave()
        reach, on_flight = standing.reach, self._on_flight(standing.foot_z, view)
        frontiers, stairs = self._choices(view, reach, standing.admissible)
        behind_gaps: tuple[FrontierCluster, ...] = ()
        if on_flight and self._left_floor == view.floor:
            # nobody turns round half-way
            own = tuple(end for end in stairs if end.path_cost <= SAME_FLIGHT_M)
            frontiers, stairs = ((), own) if own else (frontiers, stairs)
        elif not frontiers and not on_flight:
            reach = standing.squeezed()
            frontiers, beyond = self._behind_gaps(view, reach, standing.admissible)
            behind_gaps = (*frontiers, *(() if stairs else beyond))
            stairs = stairs or beyond
        if not frontiers and not stairs:
            return None
        seen = {name: a for name, a in self._affinities().items() if name in view.objects}
        belief = Belief(seen, hints.guided, hints.glimpses, hints.elsewhere, self._looks)
        off_floor = self._off_floor(stairs, belief, view, on_flight=on_flight)
        choices = (frontiers, off_floor)
        self._weighed = ranked_frontiers(choices, belief, view, reach, self._planner, self._config)
        if not on_flight:
            self._storeys.note(view, sum(w.promise for w in self._weighed if not w.on_stairs))
        self._waypoint = self._weighed[0].waypoint
        chosen = next(c for c in (*frontiers, *stairs) if c.nearest is self._waypoint)
        self._drops.approach(chosen if isinstance(chosen, DropEdge) else None)
        self.squeezes = chosen in behind_gaps
        if chosen in stairs:
            self._left_floor = view.floor
            self._landed.clear()
        return self._waypoint

    def revisit(
        self, places: NDArray[np.float64], view: MapView, reach: CostField
    ) -> NDArray[np.float64] | None:
        """The (3,) nearest known place that this search has not looked at from nearby, or None.

        Where nothing is left to explore, things may have moved since an earlier search.

        Args:
            places: (N, 2) where an agent has been on this floor, metres.
            view: The map.
            reach: Cost of walking from the agent to every cell.
        """
        self.leave()
        cost = reach.at(places)
        seen_m = self._looks.nearest_m(places, view, self._config.revisit_m)
        for k in np.argsort(cost, kind="stable"):
            if math.isinf(seen_m[k]) and math.isfinite(cost[k]):
                self._waypoint = np.array([*places[k], view.floor_z])
                self._revisiting = True
                return self._waypoint
        return None

    def set_out_towards(
        self,
        target_points: NDArray[np.floating],
        view: MapView,
        reach: CostField,
        admissible: NDArray[np.bool_],
    ) -> NDArray[np.float64] | None:
        """The (3,) waypoint of the frontier by which a target in sight may be reached, or None."""
        self.leave()
        frontiers, _ = self._choices(view, reach, admissible)
        if frontiers:
            self._waypoint = frontier_towards(frontiers, target_points)
        return self._waypoint

    def leave(self) -> None:
        """Something else than a frontier is gone to."""
        self._waypoint, self._weighed = None, ()
        self._landing = self._revisiting = self.squeezes = False
        self._drops.approach(None)

    def is_gone(self, view: MapView) -> bool:
        """Whether the frontier that is gone to has been seen from afar."""
        if self._waypoint is None or self._drops.approached or self._landing or self._revisiting:
            return False
        return not bool((_distance(view, self._waypoint) <= self._config.vanished_m).any())

    def observe(self, world_from_base: Pose) -> None:
        """Note where the camera looks; call once a step."""
        self._looks.add(world_from_base)

    def look(self, observation: Observation, view: MapView, walker: Locomotion) -> Action | None:
        """On arrival, the turn towards what is left of the frontier; None when that is seen."""
        if self._landing and self._waypoint is not None and not self._turns:
            self._landed.append(self._waypoint)
        action = self._drops.look(observation, view, walker, landing=self._landing)
        if action is not None:
            return action
        foot_z = float(observation.world_from_base.translation[2])
        all_round = self._landing or self._revisiting or self._on_flight(foot_z, view)
        if all_round and self._turns < self._full_turn:
            self._turns += 1  # the next floor may go on to any side, a thing may stand anywhere
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

    def _behind_gaps(
        self, view: MapView, squeezed: CostField, admissible: NDArray[np.bool_]
    ) -> tuple[tuple[FrontierCluster, ...], tuple[FrontierCluster, ...]]:
        """The choices behind gaps that may be too narrow; frontiers where they are worth it."""
        frontiers, stairs = self._choices(view, squeezed, admissible)
        reach_m = self._config.unknown_reach_m
        worthwhile = tuple(
            replace(cluster, path_cost=cluster.path_cost + SQUEEZE_M)
            for cluster in frontiers
            if unknown_area_m2(view.grid, view.grid.index_of(cluster.cells), reach_m)
            >= SQUEEZE_FOR_M2
        )
        return worthwhile, stairs

    def _off_floor(
        self, stairs: Sequence[FrontierCluster], belief: Belief, view: MapView, *, on_flight: bool
    ) -> list[WeighedFrontier]:
        """What the ways to other floors promise: of those up, and of those down, the nearest.

        On a flight all count alike: what leads on is the nearest.
        """
        config, speaks = self._config, GLIMPSED if belief.elsewhere else ""
        affinity = {**self._affinities(), self._target: 1.0}
        found, taken = [], set()
        for place in sorted(stairs, key=lambda place: place.path_cost):
            on_stairs, up = is_on_stairs(place, view), _rises(place, view)
            promise = self._storeys.promise(
                up=up, view=view, unseen=config.other_floor, affinity=affinity
            )
            promise *= 1.0 if on_stairs else config.edge_share
            if (up, on_stairs) in taken and not on_flight:
                promise = LEAST_PROMISE
            taken.add((up, on_stairs))
            promise = config.glimpse if belief.elsewhere else promise
            found.append(off_this_floor(place, promise, speaks, on_stairs=on_stairs))
        return found


def _rises(place: FrontierCluster, view: MapView) -> bool:
    """Whether a place on stairs leads up; the edge of a floor leads down."""
    if view.grid.stairs is None:
        return False
    i, j = view.grid.index_of(place.nearest)
    return bool(view.grid.stairs[i, j] > 0.0)  # NaN, no stair, is not


def _distance(view: MapView, position: NDArray[np.float64]) -> NDArray[np.float64]:
    """(F,) from a position to each frontier cell, metres."""
    offset = view.frontiers[:, :2] - position[:2]
    away: NDArray[np.float64] = np.hypot(offset[:, 0], offset[:, 1])
    return away
