"""Frontiers in the order of the shortest tour past all of them; no semantics.

The global plan of FUEL (Zhou, Zhang, Chen and Shen 2021, "FUEL: Fast UAV Exploration Using
Incremental Frontier Structure and Hierarchical Planning"), which ApexNav (Zhang and others 2025)
uses for object search where semantics do not tell.

Kept: one visit a frontier cluster; an open tour over path lengths from where the agent stands; its
first frontier is the goal; a new tour when that frontier is reached or has vanished. Changed: the
cell of a cluster that is nearest on foot stands for the cluster instead of sampled viewpoints, and
ways count by length alone, without the drone's yaw and velocity; small tours are solved exactly.
The full turn is only taken at the start: on arrival the agent turns towards what is left of the
frontier about it, if anything.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from toponav.baselines.frontier_search import FrontierSearch
from toponav.baselines.open_tour import open_tour
from toponav.control.frontier_clusters import FrontierCluster
from toponav.control.planner import CostField, Planner
from toponav.mapping.view import MapView
from toponav.types import Action, Observation

VANISHED_M = 0.5
"""A frontier has vanished when no frontier cell is left this near to its waypoint, metres."""

LOOK_M = 1.0
"""On arrival, frontier cells this near to the agent are turned to, metres."""


class TourAgent(FrontierSearch):
    """Visits the frontiers on the shortest open tour past all of them."""

    def reset(self, goal: str) -> None:
        """Forget the last episode."""
        super().reset(goal)
        self._looks_left = 0

    def _replans(self, observation: Observation, view: MapView) -> bool:
        """Whether the frontier has vanished: it was seen from afar."""
        del observation
        return self._waypoint is not None and not _any_near(view, self._waypoint, VANISHED_M)

    def _explore(self, observation: Observation, view: MapView) -> Action:
        """On arrival look at what is left of the frontier, then set out for the next one."""
        if self._waypoint is None and self._looks_left > 0:
            self._looks_left -= 1
            look = self._look_at_rest(observation, view)
            if look is not None:
                return look
        action = super()._explore(observation, view)
        self._looks_left = round(360.0 / self._config.locomotion.follower.turn_deg)
        return action

    def _look_at_rest(self, observation: Observation, view: MapView) -> Action | None:
        """A turn towards the nearest frontier cell about the agent; None if it is ahead."""
        here = observation.world_from_base.translation
        if not _any_near(view, here, LOOK_M):
            return None
        nearest = int(np.argmin(_distances_to(view, here)))
        return self._locomotion.face(observation, view.frontiers[nearest, :2])

    def _choose(
        self,
        clusters: Sequence[FrontierCluster],
        reach: CostField,
        observation: Observation,
        view: MapView,
    ) -> NDArray[np.float64]:
        """The first frontier of the tour."""
        del observation, view
        places = np.stack([cluster.nearest for cluster in clusters])
        planner = Planner(self._config.locomotion.planner)
        between = planner.costs_between(reach, places)
        first = open_tour(reach.at(places), between)[0]
        return clusters[first].nearest


def _distances_to(view: MapView, point: NDArray[np.float64]) -> NDArray[np.float64]:
    offset = view.frontiers[:, :2] - point[:2]
    return np.asarray(np.hypot(offset[:, 0], offset[:, 1]))


def _any_near(view: MapView, point: NDArray[np.float64], distance_m: float) -> bool:
    return bool((_distances_to(view, point) <= distance_m).any())
