"""InstructNav: a chain of landmarks to go to, and four value maps that say how.

Long, Cai, Wang, Zhan and Dong 2024, "InstructNav: Zero-shot System for Generic Instruction
Navigation in Unexplored Environment".

Kept: a 12-view panorama, then a plan, at the start and after 3 m at the latest. A plan names an
action, a landmark, a flag and one of six views. Every navigable point has a mean of four values:
semantic (near to the landmark, within 1.5 m), action (at a frontier, within 0.2 m), intuition (on
the floor of the chosen view, within 0.1 m) and trajectory (far from where the agent has been),
clipped to [0.1, 1], and 0 within 0.25 m of obstacles. The way to the best point is the cheapest
over one minus the value; its first waypoint is 0.8 m along (node 4 of cells of 0.2 m) and reached
within 0.5 m. With the flag the agent goes to the target; stop at 0.5 m.

Changed: at a waypoint the next one follows, 0.8 m on, and a plan is only made at the way's end,
since a look round at each costs more steps than the walk between them. The landmark is the unused
category of the largest obj(g, o) among those seen, used up by a plan that is walked to its end and
not by one cut at 3 m; the view is that of the best image relevance. The language model's action is
Explore until the target is mapped, which raises the flag at the next plan (the turns of a route,
Forward, Left, Right and Around, do not come up in a search for an object). Ways run on the shared
grid of 0.1 m, and the shared follower walks them. Where no frontier is left the search ends; it
would go on there.
"""

from __future__ import annotations

from collections import deque
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from toponav.baselines.base import MappedSearch
from toponav.baselines.multi_value_maps import combined, nearness, remoteness
from toponav.baselines.object_scores import ObjectScores
from toponav.baselines.relevance import Relevance
from toponav.baselines.seen_floor import seen_floor
from toponav.config import NavigatorConfig
from toponav.control.locomotion import Progress
from toponav.control.planner import CostField, Planner
from toponav.mapping.view import MapView
from toponav.perception.base import Detector
from toponav.policy.affordances import Phase
from toponav.policy.decision import DecisionListener
from toponav.policy.goal import GoalConfig
from toponav.reasoning.base import Reasoner
from toponav.types import Action, Detections, Observation

VIEWS = 6
"""Views of a panorama among which one is chosen."""

LANDMARK_M = 1.5
"""Points farther than this from the landmark gain nothing from it, metres."""

VIEW_M = 0.1
"""Points farther than this from the floor seen in the chosen view gain nothing, metres."""

FRONTIER_M = 0.2
"""Points farther than this from frontiers gain nothing from exploring, metres."""

WAYPOINT_M = 0.8
"""Waypoints are this far apart on the way, metres: node 4 of cells of 0.2 m."""

PLAN_M = 3.0
"""A plan is walked for this long at most, metres."""

STOP_M = 0.5
"""The agent stops within this distance of the target, metres."""

LEAST_COST = 0.05
"""Cost of a metre at the best value, where one minus the value is 0: ways stay short there."""


class InstructNavAgent(MappedSearch):
    """Looks round, then walks to the point that the four value maps like best."""

    exploring_arrival_m = 0.5

    def __init__(
        self,
        detector: Detector,
        reasoner: Reasoner,
        config: NavigatorConfig,
        listener: DecisionListener,
    ) -> None:
        """Take the shared parts; the reasoner gives the affinities."""
        self._reasoner = reasoner
        super().__init__(detector, config, listener)

    def reset(self, goal: str) -> None:
        """Forget the last episode."""
        super().reset(goal)
        self._relevance = Relevance(self._reasoner, self._target)
        self._objects = ObjectScores(self._config.map)
        turns = round(360.0 / self._config.locomotion.follower.turn_deg)
        self._frames: deque[tuple[Observation, Detections]] = deque(maxlen=turns)
        self._trajectory: dict[int, list[NDArray[np.float64]]] = {}
        self._used: set[str] = set()
        self._way: list[NDArray[np.float64]] = []
        self._looked_round = False
        self._flag = False

    def _wanted_categories(self) -> tuple[str, ...]:
        return self._full_vocabulary()

    def _goal_config(self, shared: GoalConfig) -> GoalConfig:
        return shared.model_copy(update={"stop_distance_m": STOP_M})

    def _perceive(self, observation: Observation, detections: Detections, view: MapView) -> None:
        self._objects.add(observation, detections, view.floor)
        self._frames.append((observation, detections))
        here = observation.world_from_base.translation[:2]
        self._trajectory.setdefault(view.floor, []).append(here)

    def _believes_in_target(self, view: MapView) -> bool:
        """A mapped target counts from the plan that raised the flag."""
        return self._flag and super()._believes_in_target(view)

    def _explore(self, observation: Observation, view: MapView) -> Action:
        """Walk on along the way, or look round, or plan."""
        if self._locomotion.progress is Progress.GAVE_UP:
            self._way = []
        if self._way:
            return self._walk_on(observation, view)
        if not self._looked_round:
            self._looked_round = True
            self._turn_round(360.0 - self._config.locomotion.follower.turn_deg)
            return Action.TURN_LEFT
        self._looked_round = False
        return self._plan(observation, view)

    def _plan(self, observation: Observation, view: MapView) -> Action:
        """Raise the flag, or choose the best point and set out along the way to it."""
        self._flag = self._goal.is_mapped(view, self._target)
        if self._flag:
            self._approach(observation, view)
            if self._waypoint is not None:
                return self._locomotion.next_action(observation, view.grid) or Action.TURN_LEFT
        reach = self._locomotion.reach(observation, view.grid)
        can_reach = np.isfinite(reach.at(view.frontiers[:, :2]))
        admissible = self._barren.admissible(view.frontiers, self._decisions)
        frontiers = view.frontiers[can_reach & admissible, :2]
        if not len(frontiers):
            return Action.STOP
        index = np.argwhere(np.isfinite(reach.cost))
        points = view.grid.center_of(index)
        landmark = self._landmark(view)
        value = combined(
            self._value_maps(points, landmark, frontiers, view),
            reach.clearance.distance_m[tuple(index.T)],
        )
        best = self._best_point(points, value, observation)
        cost = np.ones_like(reach.cost)
        cost[tuple(index.T)] = np.maximum(1.0 - value, LEAST_COST)
        path = self._cheapest_way(best, reach, cost, observation)
        self._way = waypoints_along(path)
        if landmark is not None and np.array_equal(self._way[-1], path[-1]):
            self._used.add(landmark)
        return self._walk_on(observation, view)

    def _walk_on(self, observation: Observation, view: MapView) -> Action:
        """Set out for the next waypoint of the way."""
        waypoint = np.append(self._way.pop(0), view.floor_z)
        self._set_out(waypoint, Phase.EXPLORATION, observation, view)
        return self._locomotion.next_action(observation, view.grid) or Action.TURN_LEFT

    def _value_maps(
        self,
        points: NDArray[np.float64],
        landmark: str | None,
        frontiers: NDArray[np.float64],
        view: MapView,
    ) -> NDArray[np.float64]:
        """(4, N) semantic, action, intuition and trajectory value of (N, 2) points."""
        place = np.zeros((0, 2)) if landmark is None else self._objects.cells(landmark, view.floor)
        return np.stack(
            [
                nearness(points, place, LANDMARK_M),
                nearness(points, frontiers, FRONTIER_M),
                nearness(points, self._promising_floor(view), VIEW_M),
                remoteness(points, np.stack(self._trajectory[view.floor])),
            ]
        )

    def _landmark(self, view: MapView) -> str | None:
        """The unused category on this floor that speaks most for the target; None without any."""
        names = [name for name in self._objects.names(view.floor) if name not in self._used]
        return names[int(np.argmax(self._relevance.of_objects(names)))] if names else None

    def _promising_floor(self, view: MapView) -> NDArray[np.float64]:
        """(M, 2) floor seen in the view that speaks most for the target; none if no view does."""
        frames = list(self._frames)
        stride = max(1, len(frames) // VIEWS)
        views = frames[stride - 1 :: stride]
        relevance = [self._relevance.of_image(detections) for _, detections in views]
        best = int(np.argmax(relevance))
        return seen_floor(views[best][0], view) if relevance[best] else np.zeros((0, 2))

    def _best_point(
        self, points: NDArray[np.float64], value: NDArray[np.float64], observation: Observation
    ) -> NDArray[np.float64]:
        """(2,) the point of the largest value that is not here and was not just tried in vain."""
        away = np.hypot(*(points - observation.world_from_base.translation[:2]).T)
        allowed = self._barren.admissible(points, self._decisions)
        allowed &= away > self.exploring_arrival_m
        best: NDArray[np.float64] = points[np.argmax(np.where(allowed, value, -1.0))]
        return best

    def _cheapest_way(
        self,
        goal: NDArray[np.float64],
        reach: CostField,
        cost: NDArray[np.float64],
        observation: Observation,
    ) -> NDArray[np.float64]:
        """(K, 2) way from the agent to a point by an (N_x, N_y) cost of a metre."""
        clearance = replace(reach.clearance, step_cost=cost)
        field = Planner(self._config.locomotion.planner).cost_field(clearance, goal)
        return field.path_from(observation.world_from_base.translation)


def waypoints_along(path: NDArray[np.float64]) -> list[NDArray[np.float64]]:
    """(2,) nodes of a (K, 2) way, K >= 1, every `WAYPOINT_M`, to its end or `PLAN_M` along it."""
    length = np.append(0.0, np.cumsum(np.hypot(*np.diff(path, axis=0).T)))
    end = min(length[-1], PLAN_M)
    marks = np.append(np.arange(WAYPOINT_M, end, WAYPOINT_M), end)
    return list(path[np.searchsorted(length, marks)])
