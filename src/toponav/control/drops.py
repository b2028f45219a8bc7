"""Edges of the known floor: where a flight of stairs may lead down.

A level camera looks over the edge: from the landing the treads lie below the image. So the agent
goes to the edge, looks down at what is there, and does not come back to look again. At either end
of a flight it looks down once more: the next floor begins nearer to its feet than a level image.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation
from scipy.spatial import cKDTree

from toponav.control.frontier_clusters import FrontierCluster
from toponav.control.locomotion import Locomotion
from toponav.control.planner import CostField
from toponav.mapping.frontiers import label_clusters
from toponav.mapping.view import DROP, FREE, MapView
from toponav.memory.traversability import is_clear
from toponav.types import Action, Observation

MIN_CELLS = 4
"""Edges of fewer cells are noise, as with frontiers: narrower than an agent."""

STAND_M = 0.5
"""The agent looks down from within this distance of the edge."""

PEEKED_M = 0.6
"""Places this near to one from which the agent has looked down are no news."""

BELOW_M = 1.2
"""The drop, or the next treads, lie within this distance of where the agent looks down."""

ON_FLIGHT_M = 0.3
"""This far above or below its floor an agent is on a flight."""


class DropEdge(FrontierCluster):
    """An edge of the floor, or the last known treads of a flight: a place to look down from."""


class DropEdges:
    """The edges that have not been looked down yet, and the look at one of them."""

    def __init__(self) -> None:
        """Know of none."""
        self._peeked: list[tuple[NDArray[np.float64], int]] = []
        self._stand: NDArray[np.float64] | None = None
        self.looking_down = False

    @property
    def approached(self) -> bool:
        """Whether an edge is gone to or looked down."""
        return self._stand is not None

    def approach(self, edge: DropEdge | None) -> None:
        """Note which edge is gone to; None for something else."""
        self._stand = None if edge is None else edge.nearest[:2]

    def clusters(self, view: MapView, reach: CostField) -> tuple[DropEdge, ...]:
        """What can be walked to: edges and flights, each with the place from which to look down."""
        return (*self._edges(view, reach), *self._flights(view, reach))

    def _flights(self, view: MapView, reach: CostField) -> list[DropEdge]:
        """The flights up and down: of each, the place farthest along that can be walked to."""
        if view.grid.stairs is None:
            return []
        height = np.abs(view.grid.stairs)
        on_flight = np.isfinite(reach.cost) & (height > ON_FLIGHT_M)  # NaN, no stair, is not
        cells = np.argwhere(on_flight)
        labels = label_clusters(on_flight, cells, MIN_CELLS)
        found = []
        for label in range(labels.max(initial=-1) + 1):
            own = cells[labels == label]
            farthest = own[np.argmax(height[own[:, 0], own[:, 1]])]
            spot = view.grid.center_of(farthest)
            if not self._is_known(spot, view.floor):
                found.append(
                    DropEdge(
                        cells=view.grid.center_of(own),
                        reachable=np.ones(len(own), np.bool_),
                        nearest=np.array([*spot, view.floor_z]),
                        path_cost=float(reach.cost[farthest[0], farthest[1]]),
                    )
                )
        return found

    def _edges(self, view: MapView, reach: CostField) -> list[DropEdge]:
        """The edges of the floor."""
        drop = view.grid.cells == DROP
        if not drop.any():
            return []
        standing = np.argwhere(np.isfinite(reach.cost))
        if not len(standing):
            return []
        spots, cost = view.grid.center_of(standing), reach.cost[standing[:, 0], standing[:, 1]]
        news = np.array([not self._is_known(spot, view.floor) for spot in spots], np.bool_)
        edge = binary_dilation(drop) & (view.grid.cells == FREE)
        cells = np.argwhere(edge)
        labels = label_clusters(edge, cells, MIN_CELLS)
        found = []
        for label in range(labels.max(initial=-1) + 1):
            centers = view.grid.center_of(cells[labels == label])
            away, nearest = cKDTree(spots).query(centers, distance_upper_bound=STAND_M)
            near = np.isfinite(away)
            near[near] = news[nearest[near]]
            order = np.flatnonzero(near)[np.argsort(cost[nearest[near]], kind="stable")]
            for k in order:
                spot = spots[nearest[k]]
                if is_clear(view.grid, tuple(spot), tuple(centers[k])):  # not over a rail
                    stand = np.array([*spot, view.floor_z])
                    found.append(DropEdge(centers, near, stand, float(cost[nearest[k]])))
                    break
        return found

    def look(
        self, observation: Observation, view: MapView, walker: Locomotion, *, landing: bool
    ) -> Action | None:
        """The next action of the look down an edge or flight, on arrival; None if none is due.

        Args:
            observation: Where the agent is.
            view: The map.
            walker: Turns the agent.
            landing: Whether a flight is left for the floor that the map shows, not for another.
        """
        here = observation.world_from_base.translation
        if self.looking_down:
            self._peeked.append((here[:2].copy(), view.floor))
            if self._stand is not None and not self._is_known(self._stand, view.floor):
                self._peeked.append((self._stand, view.floor))  # it got no nearer, nor ever will
            self.looking_down, self._stand = False, None
            return Action.LOOK_UP
        on_flight = abs(here[2] - view.floor_z) > ON_FLIGHT_M
        if not self.approached and (not on_flight or self._is_known(here[:2], view.floor)):
            return None
        below = _last_treads(here, view, landing) if on_flight else _drop_near(here, view)
        turn = None if below is None else walker.face(observation, below)
        if turn is None:
            self.looking_down = True
            return Action.LOOK_DOWN
        return turn

    def _is_known(self, xy: NDArray[np.float64], floor: int) -> bool:
        """Whether the agent has looked down from nearby."""
        return any(
            floor == there and float(np.hypot(*(xy - peeked))) <= PEEKED_M
            for peeked, there in self._peeked
        )


def _drop_near(here: NDArray[np.float64], view: MapView) -> NDArray[np.float64] | None:
    """(2,) the middle of the drop that is near; None if there is none."""
    below = view.grid.center_of(np.argwhere(view.grid.cells == DROP))
    below = below[np.hypot(*(below - here[:2]).T) <= BELOW_M]
    return below.mean(axis=0) if len(below) else None


def _last_treads(
    here: NDArray[np.float64], view: MapView, landing: bool
) -> NDArray[np.float64] | None:
    """(2,) the middle of the near treads where the flight goes on; None without any.

    They are those farthest from the floor, or nearest to it where the agent comes to land on it.
    """
    if view.grid.stairs is None:
        return None
    cells = np.argwhere(np.isfinite(view.grid.stairs))
    centers = view.grid.center_of(cells)
    near = np.hypot(*(centers - here[:2]).T) <= BELOW_M
    if not near.any():
        return None
    onward = np.abs(view.grid.stairs[cells[near, 0], cells[near, 1]]) * (-1.0 if landing else 1.0)
    last: NDArray[np.float64] = centers[near][onward >= onward.max() - 0.1].mean(axis=0)
    return last
