"""CoW: spin, explore the frontiers, exploit the first sighting.

Gadre, Wortsman, Ilharco, Schmidt and Song 2023, "CoWs on Pasture: Baselines and Benchmarks for
Language-Driven Zero-Shot Object Navigation".

Kept: a full turn first; frontier cells linked over 1.5 cells (which is 8-connected); a cluster's
goal is its cell nearest to the mean; the nearest goal by straight line first; a single detection,
at the centre of its box, is the target for good; stop within 1.0 m of it. No language model is
asked. Changed: the shared grid of 0.1 m and its least frontier of 4 cells instead of 0.125 m and 3;
only cells that can be walked to; the shared planner instead of its A*; once the sighting cannot be
approached the search goes on, where CoW is stuck.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from toponav.baselines.frontier_search import FrontierSearch
from toponav.control.frontier_clusters import FrontierCluster
from toponav.control.planner import CostField
from toponav.mapping.view import MapView
from toponav.policy.goal import GoalConfig
from toponav.types import Detections, Observation

STOP_M = 1.0
"""The agent stops within this distance of the sighting, metres."""


class CowAgent(FrontierSearch):
    """Goes to the frontier nearest as the crow flies, and to the first sighting."""

    def _goal_config(self, shared: GoalConfig) -> GoalConfig:
        """One point is a target."""
        return shared.model_copy(
            update={
                "min_points": 1,
                "dense_neighbors": 0,
                "stop_distance_m": STOP_M,
                "farthest_stop_m": max(STOP_M, shared.farthest_stop_m),
            }
        )

    def _accepted(self, detections: Detections) -> Detections:
        """The detections, each reduced to the pixel at the centre of its box."""
        boxes = detections.boxes
        centres = (0.5 * (boxes[:, :2] + boxes[:, 2:])).astype(np.int64)
        masks = np.zeros_like(detections.masks)
        masks[np.arange(len(detections)), centres[:, 1], centres[:, 0]] = True
        return replace(detections, masks=masks)

    def _choose(
        self,
        clusters: Sequence[FrontierCluster],
        reach: CostField,
        observation: Observation,
        view: MapView,
    ) -> NDArray[np.float64]:
        """The nearest of the clusters' middle cells, by straight line."""
        del reach
        here = observation.world_from_base.translation[:2]
        middles = np.stack([cluster.middle for cluster in clusters])
        nearest = middles[np.argmin(np.hypot(*(middles - here).T))]
        return np.append(nearest, view.floor_z)
