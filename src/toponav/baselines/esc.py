"""ESC: frontiers scored by soft rules of commonsense.

Zhou, Zheng, Pryor, Shen, Jin, Getoor and Wang 2023, "ESC: Exploration with Soft Commonsense
Constraints for Zero-shot Object Navigation".

Kept: a full turn first; every frontier cell at least 1.6 m away scored by soft logic over eight
rooms within 0.6 m and all objects within 1.6 m, plus twice its nearness up to 11.6 m; a new score
only on arrival, within 0.5 m; a detected target is gone to, stopping at 0.5 m.

Changed: room and object affinities come from the reasoner, min-max normalised over the names asked
instead of over a table of all goals. No detector here names rooms: a room's confidence is its
posterior given the objects within 1.6 m of the frontier by the tables of `reasoning.affinity`, and
0 without any (the ninth room, the lounge, is a living room there). Depth ends at 5 m, so there are
no tentative targets beyond. Where no cell is 1.6 m away, the nearest frontier is taken.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from toponav.baselines.context_search import ContextSearch
from toponav.baselines.object_scores import ObjectScores
from toponav.control.frontier_clusters import FrontierCluster
from toponav.control.planner import CostField
from toponav.mapping.view import MapView
from toponav.policy.goal import GoalConfig
from toponav.reasoning.affinity import ROOM_TYPES, room_belief
from toponav.types import Detections, Observation

ROOMS = (
    "bedroom",
    "living room",
    "bathroom",
    "kitchen",
    "dining room",
    "office",
    "gym",
    "laundry room",
)
"""The types of room that are told apart."""

NEAREST_M = 1.6
"""Frontiers nearer than this are no candidates, metres on foot."""

FARTHEST_M = 11.6
"""From here on, metres on foot, frontiers are equally far."""

DISTANCE_WEIGHT = 2.0
"""Weight of nearness against that of each rule; 1 in ESC's ablations with one kind of rule."""

OBJECT_RADIUS_M = 1.6
"""Objects this near to a frontier, metres, speak for or against it."""

STOP_M = 0.5
"""The agent stops within this distance of the target, metres."""


class EscAgent(ContextSearch):
    """Goes to the frontier whose surroundings promise the target."""

    exploring_arrival_m = 0.5

    def reset(self, goal: str) -> None:
        """Forget the last episode."""
        super().reset(goal)
        self._objects = ObjectScores(self._config.map)

    def _goal_config(self, shared: GoalConfig) -> GoalConfig:
        return shared.model_copy(update={"stop_distance_m": STOP_M})

    def _perceive(self, observation: Observation, detections: Detections, view: MapView) -> None:
        self._objects.add(observation, detections, view.floor)

    def _choose(
        self,
        clusters: Sequence[FrontierCluster],
        reach: CostField,
        observation: Observation,
        view: MapView,
    ) -> NDArray[np.float64]:
        """The frontier cell of the best score."""
        del observation
        cells = np.concatenate([cluster.cells[cluster.reachable] for cluster in clusters])
        distance = self._distances(reach).at(cells)
        if distance.max() < NEAREST_M:
            return min(clusters, key=lambda cluster: cluster.path_cost).nearest
        score = self._scores(cells, distance, view)
        score[distance < NEAREST_M] = -np.inf
        return np.append(cells[np.argmax(score)], view.floor_z)

    def _scores(
        self, cells: NDArray[np.float64], distance: NDArray[np.float64], view: MapView
    ) -> NDArray[np.float64]:
        """(N,) what speaks for each of (N, 2) cells at (N,) distances on foot, metres."""
        names = self._objects.names(view.floor)
        seen = self._objects.within_radius(cells, OBJECT_RADIUS_M, view.floor)
        affinity = min_max(self._relevance.of_objects(self._vocabulary))
        by_name = dict(zip(self._vocabulary, affinity, strict=True))
        by_object = soft_rule(np.array([by_name[name] for name in names]), seen)
        by_room = soft_rule(min_max(self._relevance.of_rooms(ROOMS)), room_confidence(names, seen))
        return soft_score(by_object, by_room, distance)


def soft_score(
    by_object: NDArray[np.float64], by_room: NDArray[np.float64], distance_m: NDArray[np.float64]
) -> NDArray[np.float64]:
    """(N,) sum of the rules' (N, L) and (N, R) truths and of the weighted nearness."""
    rules = by_object.sum(axis=1) + by_room.sum(axis=1)
    return np.asarray(rules + DISTANCE_WEIGHT * nearness(distance_m))


def soft_rule(
    affinity: NDArray[np.float64], confidence: NDArray[np.float64]
) -> NDArray[np.float64]:
    """T(p, n) = max(0, p + n - 1) - max(0, n - p), in [-1, 1].

    Lukasiewicz's soft logic: the first part is how true "the target goes with it, and it is here"
    is, the second how false "where it is, the target is".

    Args:
        affinity: p, (L,) in [0, 1].
        confidence: n, (N, L) in [0, 1].
    """
    both = np.maximum(0.0, affinity + confidence - 1.0)
    against = np.maximum(0.0, confidence - affinity)
    return np.asarray(both - against)


def nearness(distance_m: NDArray[np.float64]) -> NDArray[np.float64]:
    """(N,) in [0, 1]: 1 up to `NEAREST_M` on foot, 0 from `FARTHEST_M` on."""
    clipped = np.clip(distance_m, NEAREST_M, FARTHEST_M)
    return np.asarray(1.0 - (clipped - NEAREST_M) / (FARTHEST_M - NEAREST_M))


def min_max(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """(L,) values stretched over [0, 1]; equal ones say nothing for one more than another: 0.5."""
    low, span = values.min(), np.ptp(values)
    return np.full_like(values, 0.5) if span == 0.0 else (values - low) / span


def room_confidence(names: Sequence[str], seen: NDArray[np.float64]) -> NDArray[np.float64]:
    """n_r: (N, R) posterior of each of `ROOMS` given the objects around; 0 without any.

    Args:
        names: L categories.
        seen: (N, L) the best score of each around each of N places.
    """
    around, place = np.unique(seen, axis=0, return_inverse=True)
    columns = [ROOM_TYPES.index(room) for room in ROOMS]
    confidence = np.zeros((len(around), len(ROOMS)))
    for row, scores in enumerate(around):
        evidence = {name: float(score) for name, score in zip(names, scores, strict=True) if score}
        if evidence:
            belief = room_belief(evidence)[columns]
            confidence[row] = belief / belief.sum()
    return confidence[place.ravel()]
