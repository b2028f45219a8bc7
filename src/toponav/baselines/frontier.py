"""Nearest frontier by travel distance (Yamauchi 1997), stopping at a detected target.

Kept: free cells beside unknown ones, clustered; the nearest reachable one by path; a full turn on
arrival; a seen target overrides. Changed: the nearest cell of a cluster stands for it instead of
its centroid, which may lie inside an obstacle; frontiers that could not be reached are ruled out
for a number of decisions instead of until the map changes; map, planner and stop rule are
TopoNav's.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from toponav.baselines.frontier_search import FrontierSearch
from toponav.control.frontier_clusters import FrontierCluster
from toponav.control.planner import CostField
from toponav.mapping.view import MapView
from toponav.types import Observation


class FrontierAgent(FrontierSearch):
    """Goes to the nearest frontier, turns once round, and goes on."""

    arrival_turn_deg: ClassVar[float] = 360.0

    def _choose(
        self,
        clusters: Sequence[FrontierCluster],
        reach: CostField,
        observation: Observation,
        view: MapView,
    ) -> NDArray[np.float64]:
        """The cell that is cheapest to walk to."""
        del reach, observation, view
        return min(clusters, key=lambda cluster: cluster.path_cost).nearest
