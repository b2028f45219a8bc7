"""What the map-based baselines share: TopoNav's own map, perception, planner and stop rule.

A method is what it overrides here: `_explore` always, and where it differs from the plain search
its vocabulary, what it makes of a frame, when it believes in the target, when it plans anew and
how near to the target it stops.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import replace
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from toponav.categories import canonical
from toponav.config import NavigatorConfig
from toponav.control.guide import Guide
from toponav.control.locomotion import Locomotion, Progress
from toponav.control.planner import CostField, Planner
from toponav.control.recovery import BarrenWaypoints
from toponav.control.vantage import vantage_point
from toponav.mapping.semantic_map import SemanticMap
from toponav.mapping.view import MapView
from toponav.perception.base import Detector
from toponav.perception.object_masks import object_masks
from toponav.policy.affordances import Phase
from toponav.policy.decision import Decision, DecisionListener
from toponav.policy.goal import GoalConfig, GoalTracker
from toponav.types import Action, Detections, Observation


class MappedSearch(ABC):
    """Explores by the subclass's rule until the target is mapped, then walks to it and stops."""

    exploring_arrival_m: ClassVar[float] = 0.0
    """An exploring walk ends this near to its waypoint, metres; as near as any walk by default."""

    def __init__(
        self, detector: Detector, config: NavigatorConfig, listener: DecisionListener
    ) -> None:
        """Take the parts that all methods share."""
        self._detector = detector
        self._config = config
        self._listener = listener
        self._guide: Guide | None = None
        self.reset("")

    def follow(self, guide: Guide) -> None:
        """Walk as a guide says, from the next episode on: only to compare."""
        self._guide = guide

    def reset(self, goal: str) -> None:
        """Forget the last episode and look for an object of category `goal`."""
        self._target = canonical(goal)
        self._vocabulary = self._wanted_categories()
        self._map = SemanticMap(self._config.map)
        plain = self._config.goal.model_copy(update={"evidence": None})
        self._goal = GoalTracker(self._goal_config(plain))
        self._locomotion = Locomotion(self._config.locomotion, self._guide)
        self._barren = BarrenWaypoints(self._config.locomotion.recovery)
        self._phase = Phase.EXPLORATION
        self._waypoint: NDArray[np.float64] | None = None
        self._turns_left = 0
        self._decisions = 0
        self._view: MapView | None = None

    def act(self, observation: Observation) -> Action:
        """The next action."""
        seen = self._detector.detect(observation.rgb, self._vocabulary)
        detections = self._accepted(object_masks(observation, seen))
        self._map.integrate(observation, detections)
        self._locomotion.observe(observation)
        self._view = view = self._map.view()
        self._perceive(observation, detections, view)
        eye, believed = observation.world_from_camera, self._believes_in_target(view)
        if believed and self._goal.reached(eye, view, self._target):
            return Action.STOP
        if self._phase is Phase.EXPLORATION and believed:
            self._approach(observation, view)
        walking = self._locomotion.progress is Progress.WALKING
        if self._is_exploring() and walking and self._replans(observation, view):
            return self._explore(observation, view)
        if self._waypoint is not None and not self._is_near_waypoint(observation):
            action = self._locomotion.next_action(observation, view.grid)
            if action is not None:
                return action
        acquiring = believed and self._phase is Phase.TARGET_ACQUISITION
        if acquiring and self._goal.reached(eye, view, self._target, walk_ended=True):
            return Action.STOP
        self._end_walk()
        if self._turns_left > 0:
            self._turns_left -= 1
            return Action.TURN_LEFT
        return self._explore(observation, view)

    def close(self) -> None:
        """Tell the listener that the episode is over."""
        self._listener.on_close(self._view, None)

    @abstractmethod
    def _explore(self, observation: Observation, view: MapView) -> Action:
        """The next action while there is nothing to walk to; may set out for a waypoint."""

    def _wanted_categories(self) -> tuple[str, ...]:
        """What the detector looks for: the target alone, unless the method knows context."""
        return (self._target,)

    def _goal_config(self, shared: GoalConfig) -> GoalConfig:
        """When the target counts as mapped and how near to it to stop; by default as shared."""
        return shared

    def _accepted(self, detections: Detections) -> Detections:
        """The detections that enter the map; by default all of them."""
        return detections

    def _perceive(self, observation: Observation, detections: Detections, view: MapView) -> None:
        """Take a frame that the map has integrated; called once a step, first of all."""
        del observation, detections, view

    def _believes_in_target(self, view: MapView) -> bool:
        """Whether to walk to the target: by default as soon as it is mapped."""
        return self._goal.is_mapped(view, self._target)

    def _replans(self, observation: Observation, view: MapView) -> bool:
        """Whether to leave the present walk to a waypoint and explore anew; by default never.

        Asked once a step of an exploring walk, not during a turn on the spot.
        """
        del observation, view
        return False

    def _full_vocabulary(self) -> tuple[str, ...]:
        """The target and every category of the configuration, for methods that know context."""
        return tuple(dict.fromkeys((self._target, *self._config.vocabulary)))

    def _turn_round(self, degrees: float = 360.0) -> None:
        """Turn left on the spot, once the present walk is over, before `_explore` is asked again.

        Frames of the turn come through `_perceive`; a target in sight ends it.
        """
        self._turns_left = round(degrees / self._config.locomotion.follower.turn_deg)

    def _set_out(
        self, waypoint: NDArray[np.float64], phase: Phase, observation: Observation, view: MapView
    ) -> None:
        """Walk to a (3,) waypoint from now on, and tell the listener."""
        if self._is_exploring() and self._locomotion.progress is Progress.WALKING:
            self._locomotion.redirect(waypoint)
        else:
            self._locomotion.go_to(waypoint)
        self._phase, self._waypoint = phase, waypoint
        self._listener.on_decision(
            Decision(
                index=self._decisions,
                step=observation.step,
                phase=phase,
                waypoint=waypoint,
                path=self._locomotion.path(observation, view.grid),
                map_view=view,
            )
        )
        self._decisions += 1

    def _is_exploring(self) -> bool:
        """Whether the agent is on an exploring walk."""
        return self._waypoint is not None and self._phase is Phase.EXPLORATION

    def _is_near_waypoint(self, observation: Observation) -> bool:
        """Whether an exploring walk has come as near to its waypoint as the method wants."""
        if self._waypoint is None or not self._is_exploring():
            return False
        offset = self._waypoint[:2] - observation.world_from_base.translation[:2]
        return float(np.hypot(*offset)) <= self.exploring_arrival_m

    def _distances(self, reach: CostField) -> CostField:
        """Lengths of the shortest ways to where `reach` leads, metres, however narrow they are."""
        clearance = replace(reach.clearance, step_cost=np.ones_like(reach.clearance.step_cost))
        return Planner(self._config.locomotion.planner).cost_field(clearance, reach.goals)

    def _approach(self, observation: Observation, view: MapView) -> None:
        """Set out for a spot from which the target is seen, once one is known."""
        spot = vantage_point(
            self._goal.points(view, self._target),
            self._goal,
            view,
            self._locomotion.reach(observation, view.grid),
            observation.world_from_camera.translation[2] - view.floor_z,
        )
        if spot is not None and self._barren.admissible(spot[None], self._decisions)[0]:
            self._set_out(spot, Phase.TARGET_ACQUISITION, observation, view)

    def _end_walk(self) -> None:
        """A walk was completed or given up: its waypoint is not chosen again for a while."""
        if self._waypoint is not None:
            self._barren.add(self._waypoint, self._decisions)
            self._waypoint = None
        self._phase = Phase.EXPLORATION
