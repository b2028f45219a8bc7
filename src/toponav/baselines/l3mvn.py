"""L3MVN: a language model chooses between a few frontiers by the objects about them.

Yu, Kasaei and Cao 2023, "L3MVN: Leveraging Large Language Models for Visual Target Navigation".

Kept: no turn at the start; a new plan every 10 steps; of the frontiers 0.5 to 5 m away the four
that are largest, those within 3 m first; the goal's probability given the objects in a square of
4 m about each; over 0.3 the best is taken, else the first of the four; any mapped cell of the
target is the goal, and the agent stops within 0.25 m of it after growing it by 0.5 m.

Changed: the probability is the reasoner's, a softmax over the goals of the mean of log obj(g, o);
without objects it says nothing. A frontier's area is counted in cells of 0.05 m as there: twice the
cells of the shared grid along a line. Where no frontier lies in that range the nearest is taken
instead of a random point; where none is left the agent turns round once and then stops.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from toponav.baselines.context_search import ContextSearch
from toponav.baselines.object_scores import ObjectScores
from toponav.baselines.relevance import Relevance
from toponav.categories import HM3D_TARGETS
from toponav.control.frontier_clusters import FrontierCluster
from toponav.control.planner import CostField
from toponav.mapping.view import MapView
from toponav.policy.goal import GoalConfig
from toponav.types import Action, Detections, Observation

REPLAN_STEPS = 10
"""Steps between plans."""

AREA_CELL_M = 0.05
"""Edge of the cells in which L3MVN counts a frontier's area, metres."""

MIN_AREA = 4
"""Frontiers of no more cells are no candidates."""

NEAREST_M, FARTHEST_M = 0.5, 5.0
"""Range of the candidates, metres on foot."""

CLOSE_M, CLOSE_BONUS = 3.0, 8.0
"""Frontiers nearer than this, metres on foot, count as so many cells larger."""

CANDIDATES = 4
"""So many frontiers are put to the language model."""

HALF_BOX_M = 2.0
"""Objects in the square of 4 m about a frontier are put to it as well."""

TRUSTED_PROBABILITY = 0.3
"""Up to this probability the model is not followed."""

LEAST_AFFINITY = 1e-3
"""Stands in for an affinity of 0, whose logarithm would settle everything."""

STOP_M = 0.75
"""The agent stops within this distance of the target, metres: 0.5 m grown, 0.25 m left."""


class L3mvnAgent(ContextSearch):
    """Goes to a large frontier near by, preferring one whose objects speak for the target."""

    initial_turn_deg = 0.0

    def reset(self, goal: str) -> None:
        """Forget the last episode."""
        super().reset(goal)
        goals = dict.fromkeys((self._target, *HM3D_TARGETS))
        self._relevances = [Relevance(self._reasoner, name) for name in goals]
        self._objects = ObjectScores(self._config.map)
        self._planned_at = 0
        self._looked_round = False

    def _goal_config(self, shared: GoalConfig) -> GoalConfig:
        """Any cell of the target is a goal."""
        return shared.model_copy(
            update={"min_points": 1, "dense_neighbors": 0, "stop_distance_m": STOP_M}
        )

    def _perceive(self, observation: Observation, detections: Detections, view: MapView) -> None:
        self._objects.add(observation, detections, view.floor)

    def _replans(self, observation: Observation, view: MapView) -> bool:
        del view
        return observation.step - self._planned_at >= REPLAN_STEPS

    def _without_frontiers(self) -> Action:
        """Turn round once, then stop."""
        if self._looked_round:
            return Action.STOP
        self._looked_round = True
        self._turn_round(360.0 - self._config.locomotion.follower.turn_deg)
        return Action.TURN_LEFT

    def _choose(
        self,
        clusters: Sequence[FrontierCluster],
        reach: CostField,
        observation: Observation,
        view: MapView,
    ) -> NDArray[np.float64]:
        """The best of the candidates by the objects about them, or the first of them."""
        self._planned_at = observation.step
        self._looked_round = False
        distance = self._distances(reach).at(np.stack([c.nearest for c in clusters]))
        best = candidates(clusters, distance, view.grid.resolution)
        if not best:
            return min(clusters, key=lambda cluster: cluster.path_cost).nearest
        probability = self._probabilities(best, view)
        trusted = probability.max() > TRUSTED_PROBABILITY
        return best[int(probability.argmax()) if trusted else 0].nearest

    def _probabilities(
        self, clusters: Sequence[FrontierCluster], view: MapView
    ) -> NDArray[np.float64]:
        """(N,) the goal's probability given the objects about each frontier, 0 without any."""
        middles = np.stack([cluster.centroid for cluster in clusters])
        names = np.array(self._objects.names(view.floor), dtype=np.str_)
        seen = self._objects.within_box(middles, HALF_BOX_M, view.floor) > 0.0
        return np.array([self._probability(names[row].tolist()) for row in seen])

    def _probability(self, names: Sequence[str]) -> float:
        affinity = [relevance.of_objects(names) for relevance in self._relevances]
        return goal_probability(np.stack(affinity)) if names else 0.0


def candidates(
    clusters: Sequence[FrontierCluster], distance_m: NDArray[np.float64], resolution_m: float
) -> list[FrontierCluster]:
    """Up to `CANDIDATES` frontiers in range, the largest first, a bonus for close ones counted in.

    Args:
        clusters: N frontiers.
        distance_m: (N,) lengths of the ways to them.
        resolution_m: Edge of the cells that they are made of.
    """
    ranked = []
    for cluster, away in zip(clusters, distance_m, strict=True):
        area = cluster.size * resolution_m / AREA_CELL_M
        if area > MIN_AREA and NEAREST_M <= away <= FARTHEST_M:
            ranked.append((area + CLOSE_BONUS * (away < CLOSE_M), cluster))
    ranked.sort(key=lambda pair: -pair[0])
    return [cluster for _, cluster in ranked[:CANDIDATES]]


def goal_probability(affinity: NDArray[np.float64]) -> float:
    """The first goal's share in the softmax over G goals of their mean log affinity.

    Args:
        affinity: (G, L) of each goal with each of L >= 1 objects.
    """
    logit = np.log(np.maximum(affinity, LEAST_AFFINITY)).mean(axis=1)
    weight = np.exp(logit - logit.max())
    return float(weight[0] / weight.sum())
