"""VoroNav: decisions at the junctions of the free space's Voronoi graph.

Wu, Wang, Zhang, Wang, Wu, Ma, Zhang, Zhao, Chen and Li 2024, "VoroNav: Voronoi-based Zero-shot
Object Navigation with Large Language Model".

Kept: the graph's nodes are the junctions and ends of the middle lines of free space; the agent
decides only at a node, after a full turn; the neighbour of the largest W = 2 [it leads to an
exploratory node] + [not visited] + L is next, with L the model's probability of that neighbour;
nodes nearer than 0.5 m are one; stop within 1.0 m of the target.

Changed: the middle lines come from thinning the cells that the agent fits in. An exploratory node
is one with a frontier within 1.5 m. L is the mean obj(g, o) of what was detected within 2 m of the
neighbour, normalised over the neighbours, instead of a language model's answer to a description of
the way there. Ties go to the nearer neighbour. Where the lines reach no exploratory node, the
nearest frontier is gone to; where none is left the search ends.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from toponav.baselines.context_search import ContextSearch
from toponav.baselines.object_scores import ObjectScores
from toponav.baselines.voronoi_graph import VoronoiGraph, voronoi_graph
from toponav.control.frontier_clusters import FrontierCluster
from toponav.control.planner import CostField
from toponav.mapping.view import MapView
from toponav.policy.goal import GoalConfig
from toponav.types import Detections, Observation

MERGE_M = 0.5
"""Nodes nearer to each other than this are one, metres."""

EXPLORATORY_M = 1.5
"""A node with a frontier this near is exploratory, metres."""

SURROUNDINGS_M = 2.0
"""Objects this near to a neighbour speak for or against it, metres."""

VISITED_M = 0.5
"""A node this near to where the agent has decided before is visited, metres."""

LEADS_WEIGHT = 2.0
"""Weight of leading to an exploratory node, against 1 of the other two terms."""

STOP_M = 1.0
"""The agent stops within this distance of the target, metres."""


class VoroNavAgent(ContextSearch):
    """Goes from node to node of the Voronoi graph."""

    arrival_turn_deg: ClassVar[float] = 360.0

    def reset(self, goal: str) -> None:
        """Forget the last episode."""
        super().reset(goal)
        self._objects = ObjectScores(self._config.map)
        self._visited: dict[int, list[NDArray[np.float64]]] = {}

    def _goal_config(self, shared: GoalConfig) -> GoalConfig:
        return shared.model_copy(
            update={
                "stop_distance_m": STOP_M,
                "farthest_stop_m": max(STOP_M, shared.farthest_stop_m),
            }
        )

    def _perceive(self, observation: Observation, detections: Detections, view: MapView) -> None:
        self._objects.add(observation, detections, view.floor)

    def _choose(
        self,
        clusters: Sequence[FrontierCluster],
        reach: CostField,
        observation: Observation,
        view: MapView,
    ) -> NDArray[np.float64]:
        """The best neighbour of the agent's node."""
        here = observation.world_from_base.translation[:2]
        visited = self._visited.setdefault(view.floor, [])
        visited.append(here)
        graph = voronoi_graph(
            reach.clearance.traversable & np.isfinite(reach.cost), view.grid, MERGE_M
        )
        nearest_frontier = min(clusters, key=lambda cluster: cluster.path_cost).nearest
        if not len(graph.nodes):
            return nearest_frontier
        start = graph.nearest(here)
        leading = graph.leads_to(start, exploratory_nodes(graph, clusters))
        neighbours = sorted(graph.graph[start])
        places = graph.nodes[neighbours]
        allowed = self._barren.admissible(places, self._decisions)
        if not any(ok and node in leading for node, ok in zip(neighbours, allowed, strict=True)):
            return nearest_frontier
        worth = LEADS_WEIGHT * np.array([node in leading for node in neighbours])
        worth += cKDTree(np.stack(visited)).query(places)[0] > VISITED_M
        worth += self._likelihood(places, view.floor)
        ranked = np.lexsort((reach.at(places), -np.where(allowed, worth, -np.inf)))
        return np.append(places[ranked[0]], view.floor_z)

    def _likelihood(self, places: NDArray[np.float64], floor: int) -> NDArray[np.float64]:
        """(N,) L of each neighbour; all alike where nothing was detected about any."""
        names = self._objects.names(floor)
        seen = self._objects.within_radius(places, SURROUNDINGS_M, floor) > 0.0
        affinity = self._relevance.of_objects(names)
        mean = (seen @ affinity) / np.maximum(seen.sum(axis=1), 1)
        total = float(mean.sum())
        return mean / total if total > 0.0 else np.full(len(places), 1.0 / len(places))


def exploratory_nodes(graph: VoronoiGraph, clusters: Sequence[FrontierCluster]) -> frozenset[int]:
    """The nodes beside a frontier that can be walked to."""
    cells = np.concatenate([cluster.cells[cluster.reachable] for cluster in clusters])
    distance, _ = cKDTree(cells).query(graph.nodes)
    return frozenset(np.flatnonzero(distance <= EXPLORATORY_M).tolist())
