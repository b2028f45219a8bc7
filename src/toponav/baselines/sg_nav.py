"""SG-Nav: ESC's score and that of groups of objects; a target is believed when seen often.

Yin, Xu, Wu, Zhou and Lu 2024, "SG-Nav: Online 3D Scene Graph Prompting for LLM-based Zero-shot
Object Navigation".

Kept: all of ESC's rules; objects within 0.5 m of each other form a group, and the best group's
centre adds 1/distance to the frontiers within 1.6 m of it; the target is believed after so many
detections, by category; stop at 0.5 m.

Changed: a group's worth is the mean of the reasoner's obj(g, o) instead of a language model's
answer on its edges, and groups are not bounded by rooms, which nothing here detects; distances
count from 0.5 m, or a frontier upon the centre would settle everything; categories whose count is
not published take the least published one.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from toponav.baselines.esc import EscAgent
from toponav.baselines.object_groups import ObjectGroup, object_groups
from toponav.mapping.view import MapView
from toponav.types import Detections, Observation

GROUP_LINK_M = 0.5
"""Objects this near to each other belong to one group, metres."""

GROUP_RADIUS_M = 1.6
"""Frontiers this near to the best group gain from it, metres."""

LEAST_DISTANCE_M = 0.5
"""Nearer than this to the group's centre, a frontier gains no more, metres."""

SIGHTINGS = {"chair": 5, "bed": 7, "sofa": 9}
"""Frames with a detection of the target before it is believed in ..."""

OTHER_SIGHTINGS = 5
"""... and those of other categories."""


class SgNavAgent(EscAgent):
    """Goes to the frontier whose surroundings, or the best group of objects, promise the target."""

    def reset(self, goal: str) -> None:
        """Forget the last episode."""
        super().reset(goal)
        self._sightings = 0

    def _perceive(self, observation: Observation, detections: Detections, view: MapView) -> None:
        super()._perceive(observation, detections, view)
        self._sightings += self._target in detections.labels

    def _believes_in_target(self, view: MapView) -> bool:
        enough = self._sightings >= SIGHTINGS.get(self._target, OTHER_SIGHTINGS)
        return enough and super()._believes_in_target(view)

    def _scores(
        self, cells: NDArray[np.float64], distance: NDArray[np.float64], view: MapView
    ) -> NDArray[np.float64]:
        groups = object_groups(self._objects, view.floor, GROUP_LINK_M)
        score = super()._scores(cells, distance, view)
        if not groups:
            return score
        return score + group_gain(cells, max(groups, key=self._worth))

    def _worth(self, group: ObjectGroup) -> float:
        """How much a group speaks for the target, in [0, 1]."""
        return float(self._relevance.of_objects(group.names).mean())


def group_gain(cells: NDArray[np.float64], group: ObjectGroup) -> NDArray[np.float64]:
    """(N,) what (N, 2) frontier cells gain from a group: 1/distance within the radius."""
    distance = np.hypot(*(cells - group.centre).T)
    gain = 1.0 / np.maximum(distance, LEAST_DISTANCE_M)
    return np.where(distance <= GROUP_RADIUS_M, gain, 0.0)
