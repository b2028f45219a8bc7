"""WMNav: where the views of a turn promise most, by a map of how curious each made one.

Nie, Guo, Duan, Zhang and Wang 2025, "WMNav: Integrating Vision-Language Models into World Models
for Object Goal Navigation".

Kept: macro-steps of a full turn with six views, each scored from 0 to 10; the curiosity map starts
at 10, and every view lowers the floor that it shows within 3 m to its score; the view whose floor
is worth most on average gives the direction; the next waypoint is one of polar candidates 0.75 to
1.7 m away in that view; a detected target is gone to, stopping within 0.8 m.

Changed: a view's score is ten times the image's relevance instead of a model's prediction of what
lies behind it, and the candidate is the one on the most curious cell, the farthest of equals,
instead of a model's choice. The full turn costs steps here. A direction without a candidate that
can be walked to gives way to the next best one; where none has any, the nearest frontier is gone
to, and where none is left the search ends.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from toponav.baselines.context_search import ContextSearch
from toponav.baselines.curiosity_map import UNSEEN, CuriosityMap
from toponav.baselines.seen_floor import seen_floor
from toponav.control.frontier_clusters import FrontierCluster
from toponav.control.planner import CostField
from toponav.mapping.view import MapView
from toponav.policy.goal import GoalConfig
from toponav.types import Detections, Observation

VIEWS = 6
"""Views of a macro-step."""

RANGES_M = (0.75, 1.225, 1.7)
"""Distances of the polar candidates, metres."""

ANGLES_DEG = (-30.0, -15.0, 0.0, 15.0, 30.0)
"""Their bearings off the view's axis: the view's own share of the circle."""

DETOUR = 2.0
"""A candidate whose way costs more than this many times its distance lies behind something."""

STOP_M = 0.8
"""The agent stops within this distance of the target, metres."""


@dataclass(frozen=True, eq=False)
class View:
    """What one view of a macro-step showed: bearing (world yaw, radians) and (N, 2) floor."""

    bearing: float
    floor_points: NDArray[np.float64]


class WmNavAgent(ContextSearch):
    """Turns round, goes a little way towards the best view, and again."""

    arrival_turn_deg: ClassVar[float] = 360.0

    def reset(self, goal: str) -> None:
        """Forget the last episode."""
        super().reset(goal)
        self._maps: dict[int, CuriosityMap] = {}
        self._views: list[View] = []

    def _goal_config(self, shared: GoalConfig) -> GoalConfig:
        return shared.model_copy(update={"stop_distance_m": STOP_M})

    def _perceive(self, observation: Observation, detections: Detections, view: MapView) -> None:
        """Paint what the frame shows, and keep every sixth of a turn as a view."""
        floor = seen_floor(observation, view)
        curiosity = self._maps.setdefault(view.floor, CuriosityMap())
        eye = observation.world_from_camera.translation[:2]
        curiosity.paint(floor, eye, UNSEEN * self._relevance.of_image(detections))
        self._views.append(View(observation.world_from_base.yaw, floor))

    def _choose(
        self,
        clusters: Sequence[FrontierCluster],
        reach: CostField,
        observation: Observation,
        view: MapView,
    ) -> NDArray[np.float64]:
        """The best candidate of the best view that has any."""
        here = observation.world_from_base.translation[:2]
        curiosity = self._maps[view.floor]
        turns = round(360.0 / self._config.locomotion.follower.turn_deg)
        stride = max(1, turns // VIEWS)
        views = self._views[-turns:][::-1][::stride][::-1]
        self._views.clear()
        for best in sorted(views, key=lambda shown: -curiosity.mean(shown.floor_points)):
            candidates = polar_candidates(here, best.bearing)
            cost = reach.at(candidates)
            straight = np.hypot(*(candidates - here).T)
            allowed = cost <= DETOUR * straight
            allowed &= self._barren.admissible(candidates, self._decisions)
            if allowed.any():
                worth = np.where(allowed, curiosity.at(candidates), -np.inf)
                chosen = candidates[np.lexsort((-straight, -worth))[0]]
                return np.append(chosen, view.floor_z)
        return min(clusters, key=lambda cluster: cluster.path_cost).nearest


def polar_candidates(here: NDArray[np.float64], bearing: float) -> NDArray[np.float64]:
    """(N, 2) positions about (2,) `here` in the share of the circle round a bearing."""
    angles = bearing + np.radians(ANGLES_DEG)
    directions = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    return np.concatenate([here + radius * directions for radius in RANGES_M])
