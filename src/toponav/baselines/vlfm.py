"""VLFM: the frontier where images promised most, by a map of values fused over the search.

Yokoyama, Ha, Batra, Wang and Bucher 2024, "VLFM: Vision-Language Frontier Maps for Zero-Shot
Semantic Navigation".

Kept: a full turn first; the value of every image fused into the cells that it shows, weighted by
their angle off its axis; a frontier's value is the median within 0.5 m of its middle; the choice is
reviewed at every step, and kept while the frontier nearest to the last one, within 0.5 m, is worth
more than that was less 0.01; no frontier: stop. Stop within 0.9 m of the target.

Changed: an image's value is the reasoner's relevance of its detections instead of an image-text
score, so that values are often equal, and the nearest of equal frontiers is taken. While the choice
is kept, so is the waypoint, instead of moving with its frontier. The shared map holds the target,
without masks eroded or clustered, from any detection; depth ends at 5 m. What should have stopped
cycles is left out: as released it has no effect.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from toponav.baselines.context_search import ContextSearch
from toponav.baselines.value_map import ValueMap
from toponav.control.frontier_clusters import FrontierCluster
from toponav.control.planner import CostField
from toponav.mapping.view import MapView
from toponav.policy.goal import GoalConfig
from toponav.types import Detections, Observation

FRONTIER_RADIUS_M = 0.5
"""A frontier's value is the median of the map this near to its middle, metres."""

SAME_FRONTIER_M = 0.5
"""The frontier nearest to the last one is the same if it is this near, metres."""

LOSS_ALLOWED = 0.01
"""The last frontier is kept while it has lost less than this."""

STOP_M = 0.9
"""The agent stops within this distance of the target, metres."""


class VlfmAgent(ContextSearch):
    """Goes to the frontier of the highest value."""

    initial_turn_deg: ClassVar[float] = 360.0

    def reset(self, goal: str) -> None:
        """Forget the last episode."""
        super().reset(goal)
        self._values: dict[int, ValueMap] = {}
        self._last: NDArray[np.float64] | None = None
        self._last_value = 0.0

    def _goal_config(self, shared: GoalConfig) -> GoalConfig:
        return shared.model_copy(update={"stop_distance_m": STOP_M})

    def _perceive(self, observation: Observation, detections: Detections, view: MapView) -> None:
        self._value_map(view).add(observation, self._relevance.of_image(detections))

    def _replans(self, observation: Observation, view: MapView) -> bool:
        """At every step."""
        del observation, view
        return True

    def _choose(
        self,
        clusters: Sequence[FrontierCluster],
        reach: CostField,
        observation: Observation,
        view: MapView,
    ) -> NDArray[np.float64]:
        """The last frontier if it has not lost value, else that of the highest."""
        del reach, observation
        middles = np.stack([cluster.middle for cluster in clusters])
        value_map = self._value_map(view)
        value = np.array([value_map.median_within(m, FRONTIER_RADIUS_M) for m in middles])
        kept = self._same_frontier(middles)
        if kept is not None and value[kept] + LOSS_ALLOWED > self._last_value:
            self._last, self._last_value = middles[kept], float(value[kept])
            if self._waypoint is not None:
                return self._waypoint
            return np.append(middles[kept], view.floor_z)
        cost = np.array([cluster.path_cost for cluster in clusters])
        best = int(np.lexsort((cost, -value))[0])
        self._last, self._last_value = middles[best], float(value[best])
        return np.append(middles[best], view.floor_z)

    def _same_frontier(self, middles: NDArray[np.float64]) -> int | None:
        """The row of (N, 2) middles that is nearest to the last choice; None if it is gone."""
        if self._last is None:
            return None
        away = np.hypot(*(middles - self._last).T)
        nearest = int(np.argmin(away))
        return nearest if away[nearest] <= SAME_FRONTIER_M else None

    def _value_map(self, view: MapView) -> ValueMap:
        """The values of the current floor."""
        return self._values.setdefault(view.floor, ValueMap(self._config.map.max_depth_m))
