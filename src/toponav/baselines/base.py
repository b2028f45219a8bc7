"""What the map-based baselines share: TopoNav's own map, perception, planner and stop rule."""

from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np
from numpy.typing import NDArray

from toponav.categories import canonical
from toponav.config import NavigatorConfig
from toponav.control.locomotion import Locomotion
from toponav.control.recovery import BarrenWaypoints
from toponav.control.vantage import vantage_point
from toponav.mapping.semantic_map import SemanticMap
from toponav.mapping.view import MapView
from toponav.perception.base import Detector
from toponav.policy.affordances import Phase
from toponav.policy.decision import Decision, DecisionListener
from toponav.policy.goal import GoalTracker
from toponav.types import Action, Observation


class MappedSearch(ABC):
    """Explores by the subclass's rule until the target is mapped, then walks to it and stops."""

    def __init__(
        self, detector: Detector, config: NavigatorConfig, listener: DecisionListener
    ) -> None:
        """Take the parts that all methods share."""
        self._detector = detector
        self._config = config
        self._listener = listener
        self.reset("")

    def reset(self, goal: str) -> None:
        """Forget the last episode and look for an object of category `goal`."""
        self._target = canonical(goal)
        self._map = SemanticMap(self._config.map)
        self._goal = GoalTracker(self._config.goal)
        self._locomotion = Locomotion(self._config.locomotion)
        self._barren = BarrenWaypoints(self._config.locomotion.recovery)
        self._phase = Phase.EXPLORATION
        self._waypoint: NDArray[np.float64] | None = None
        self._decisions = 0
        self._view: MapView | None = None

    def act(self, observation: Observation) -> Action:
        """The next action."""
        detections = self._detector.detect(observation.rgb, (self._target,))
        self._map.integrate(observation, detections)
        self._locomotion.observe(observation)
        self._view = view = self._map.view()
        if self._goal.reached(observation.world_from_camera, view, self._target):
            return Action.STOP
        if self._phase is Phase.EXPLORATION and self._goal.is_mapped(view, self._target):
            self._approach(observation, view)
        action = self._locomotion.next_action(observation, view.grid)
        if action is not None:
            return action
        eye, acquiring = observation.world_from_camera, self._phase is Phase.TARGET_ACQUISITION
        if acquiring and self._goal.reached(eye, view, self._target, walk_ended=True):
            return Action.STOP
        if self._waypoint is not None:  # reached or given up: not the next goal again
            self._barren.add(self._waypoint, self._decisions)
            self._waypoint = None
        self._phase = Phase.EXPLORATION
        return self._explore(observation, view)

    def close(self) -> None:
        """Tell the listener that the episode is over."""
        self._listener.on_close(self._view, None)

    @abstractmethod
    def _explore(self, observation: Observation, view: MapView) -> Action:
        """The next action while there is nothing to walk to; may set out for a waypoint."""

    def _set_out(
        self, waypoint: NDArray[np.float64], phase: Phase, observation: Observation, view: MapView
    ) -> None:
        """Walk to a waypoint from now on, and tell the listener."""
        self._phase, self._waypoint = phase, waypoint
        self._locomotion.go_to(waypoint)
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
