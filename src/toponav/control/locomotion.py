"""Walking to a goal over the map as it grows: planner, follower and recovery in one."""

from __future__ import annotations

import math
from collections import deque
from enum import Enum

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from toponav.config_model import ConfigModel
from toponav.control.discrete import DiscreteFollower, FollowerConfig
from toponav.control.guide import Guide, guided_action
from toponav.control.maneuver import maneuver, solid_points
from toponav.control.planner import Clearance, CostField, Planner, PlannerConfig
from toponav.control.recovery import BumpMemory, ProgressMonitor, RecoveryConfig
from toponav.mapping.view import MapView, OccupancyGrid
from toponav.types import Action, Observation

MOVED_M = 0.1
"""A walk that has come no farther than this has not begun."""

NEARBY_M = 5.0
"""A cost-to-go field is worked out as far as the agent, and for what costs up to this more: the
follower's steps ahead lie within it, however narrow it is."""


class LocomotionConfig(ConfigModel):
    """How the agent walks."""

    planner: PlannerConfig = Field(default_factory=PlannerConfig)
    """Clearances."""

    follower: FollowerConfig = Field(default_factory=FollowerConfig)
    """The motion model."""

    recovery: RecoveryConfig = Field(default_factory=RecoveryConfig)
    """Bumps and stalls."""

    arrival_m: float = 0.2
    """A goal is reached within this distance, metres: less than a step."""


class Progress(Enum):
    """Where a walk stands."""

    IDLE = "idle"
    WALKING = "walking"
    ARRIVED = "arrived"
    GAVE_UP = "gave up"


class Locomotion:
    """Walks to the nearest of a set of goals, replanning on every step's map."""

    def __init__(self, config: LocomotionConfig, guide: Guide | None = None) -> None:
        """Start idle; with a guide, walks follow its paths instead of the map's."""
        self._config = config
        self._guide = guide
        self._planner = Planner(config.planner)
        self._follower = DiscreteFollower(config.follower)
        self._bumps = BumpMemory(config.recovery)
        self._monitor = ProgressMonitor(config.recovery)
        self._goals = np.zeros((0, 2))
        self._walked: tuple[NDArray[np.float64], CostField] | None = None
        self._clearance: Clearance | None = None
        self._to_goals: CostField | None = None
        self._squeezing = False
        self._threading: deque[Action] = deque()
        self._in_gap = False
        self._set_out: NDArray[np.float64] | None = None
        self.progress = Progress.IDLE

    def observe(self, observation: Observation) -> None:
        """Learn from the last action; call once a step, before anything else."""
        self._walked = None
        self._clearance = self._to_goals = None
        self._bumps.stand(observation.world_from_base.translation)
        if observation.collided:
            self._bumps.add(observation.world_from_base)

    def clearance(self, observation: Observation, grid: OccupancyGrid) -> Clearance:
        """Where the agent fits on the map as it is now."""
        here = observation.world_from_base.translation
        if self._clearance is None or self._clearance.grid is not grid:
            self._clearance = self._planner.clearance(
                grid, here, self._bumps.obstacles(grid), squeeze=self._squeezing
            )
        return self._clearance

    def squeeze(self, squeezing: bool = True) -> None:
        """From now on, walk through gaps that may be just wide enough, too; or no longer."""
        if squeezing is not self._squeezing:
            self._squeezing, self._clearance = squeezing, None

    def reach(self, observation: Observation, grid: OccupancyGrid) -> CostField:
        """Cost of walking from the agent to every cell of the known free space."""
        here = observation.world_from_base.translation[None, :2]
        return self._planner.cost_field(self.clearance(observation, grid), here)

    def go_to(self, goals: NDArray[np.floating]) -> None:
        """Walk to the nearest of (2 or 3,) or (N, 2 or 3) positions from now on."""
        self._monitor.restart()
        self._threading.clear()
        self._in_gap = False
        self._set_out = None
        self.redirect(goals)

    def redirect(self, goals: NDArray[np.floating]) -> None:
        """Walk to other goals; steps without progress count on, so that it cannot go on forever."""
        self._goals = np.atleast_2d(np.asarray(goals, dtype=np.float64))[:, :2]
        self._to_goals = None
        self.progress = Progress.WALKING

    def path(self, observation: Observation, grid: OccupancyGrid) -> NDArray[np.float64]:
        """(K, 2) planned way to the goal; empty without one."""
        return self._field(observation, grid).path_from(observation.world_from_base.translation)

    def next_action(
        self, observation: Observation, grid: OccupancyGrid, view: MapView | None = None
    ) -> Action | None:
        """The next turn or step; None once `progress` says that the walk has ended.

        Args:
            observation: Where the agent is.
            grid: Known space.
            view: The whole map, with which gaps are threaded that the agent bumps into.
        """
        if self.progress is not Progress.WALKING:
            return None
        xy = observation.world_from_base.translation[:2]
        if self._guide is not None:
            return self._next_guided(self._guide, observation)
        if self._set_out is None:
            self._set_out = xy
        if view is not None and observation.collided:
            self._thread(observation, view)
        self._in_gap = bool(self._threading)
        if self._in_gap:
            return self._threading.popleft()
        field = self._field(observation, grid)
        if np.hypot(*(field.goals - xy).T).min(initial=np.inf) <= self._config.arrival_m:
            self.progress = Progress.ARRIVED
            return None
        action = None
        circles = self._monitor.circles(observation.world_from_base)
        if self._monitor.stalled(xy, field) or circles:
            self._bumps.give_up(xy)
        else:
            pose = observation.world_from_base
            action = self._follower.next_action(pose, field, self._bumps.barring(xy, grid))
            if action is None and math.dist(xy, self._set_out) < MOVED_M:
                # Caught before it began: the headings back to where it stood are free.
                back = self._bumps.barring(xy, grid, back=True)
                action = self._follower.next_action(pose, field, back)
        if action is None:
            self.progress = Progress.GAVE_UP
        else:
            self._walked = xy, field
        return action

    @property
    def way(self) -> NDArray[np.float64] | None:
        """(K, 2) what this step's action begins to walk; None where it is no part of a walk."""
        if self._walked is None:
            return None
        xy, field = self._walked
        return field.path_from(xy)

    def _thread(self, observation: Observation, view: MapView) -> None:
        """After a bump: seek turns and steps through the gap that the agent has bumped into."""
        config, here = self._config, observation.world_from_base
        foot = here.translation
        self._threading.clear()
        if self._in_gap:
            self._bumps.give_up(foot[:2])
        if not config.recovery.maneuver_m or not self._bumps.is_gap(foot[:2], view.grid):
            return
        clearance = self._planner.clearance(view.grid, foot, squeeze=True)
        field = self._planner.cost_field(clearance, self._goals, foot[None, :2], NEARBY_M)
        actions = maneuver(
            here,
            field,
            solid_points(view, clearance, float(foot[2])),
            config.follower,
            config.planner.radius_m,
            config.recovery.maneuver_m,
        )
        self._threading.extend(actions)
        self._monitor.restart()

    def _next_guided(self, guide: Guide, observation: Observation) -> Action | None:
        """As `next_action`, by the guide's knowledge."""
        xy = observation.world_from_base.translation[:2]
        if np.hypot(*(self._goals - xy).T).min(initial=np.inf) <= self._config.arrival_m:
            self.progress = Progress.ARRIVED
            return None
        action = guided_action(guide, self._goals)
        if action is None:
            self.progress = Progress.GAVE_UP
        return action

    def face(self, observation: Observation, point_xy: NDArray[np.floating]) -> Action | None:
        """The turn towards a point; None when it is ahead."""
        return self._follower.face(observation.world_from_base, point_xy)

    def _field(self, observation: Observation, grid: OccupancyGrid) -> CostField:
        """Cost-to-go to the goals; worked out once a step, however often it is asked for."""
        here = observation.world_from_base.translation[None, :2]
        clearance = self.clearance(observation, grid)
        if self._to_goals is None or self._to_goals.clearance is not clearance:
            self._to_goals = self._planner.cost_field(clearance, self._goals, here, NEARBY_M)
        return self._to_goals
