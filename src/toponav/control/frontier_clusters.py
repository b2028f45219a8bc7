"""The frontiers that an agent can walk to, one a cluster: the candidates of most methods."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from toponav.control.planner import CostField
from toponav.mapping.view import MapView


@dataclass(frozen=True, eq=False)
class FrontierCluster:
    """Frontier cells that are 8-connected, at least one of which can be walked to.

    Attributes:
        cells: (N, 2) float64 centres of all its cells in raster order, world frame, metres.
        reachable: (N,) bool, cells that can be walked to and are admissible; never none.
        nearest: (3,) the cell that is cheapest to walk to, at floor height: its waypoint.
        path_cost: Cost of walking there: metres, weighted where it is narrow.
    """

    cells: NDArray[np.float64]
    reachable: NDArray[np.bool_]
    nearest: NDArray[np.float64]
    path_cost: float

    @property
    def size(self) -> int:
        """N."""
        return len(self.cells)

    @property
    def centroid(self) -> NDArray[np.float64]:
        """(2,) mean of the cells; it may lie off the frontier."""
        mean: NDArray[np.float64] = self.cells.mean(axis=0)
        return mean

    @property
    def middle(self) -> NDArray[np.float64]:
        """(2,) the cell nearest to the centroid of those that can be walked to."""
        away = np.hypot(*(self.cells - self.centroid).T)
        away[~self.reachable] = np.inf
        middle: NDArray[np.float64] = self.cells[np.argmin(away)]
        return middle


def frontier_clusters(
    view: MapView, reach: CostField, admissible: NDArray[np.bool_] | None = None
) -> tuple[FrontierCluster, ...]:
    """The clusters with a cell that can be walked to, in the map's order.

    Args:
        view: The map.
        reach: Cost of walking from the agent to every cell.
        admissible: (F,) which of `view.frontiers` may be walked to; by default all.
    """
    cost = reach.at(view.frontiers[:, :2])
    if admissible is not None:
        cost = np.where(admissible, cost, np.inf)
    order = np.argsort(view.frontier_labels, kind="stable")
    frontiers, labels, cost = view.frontiers[order], view.frontier_labels[order], cost[order]
    reachable = np.isfinite(cost)
    bounds = [*np.flatnonzero(np.diff(labels, prepend=-1)), len(labels)]
    clusters = []
    for start, end in pairwise(bounds):
        if not reachable[start:end].any():
            continue
        best = start + np.argmin(cost[start:end])
        clusters.append(
            FrontierCluster(
                cells=frontiers[start:end, :2],
                reachable=reachable[start:end],
                nearest=frontiers[best],
                path_cost=float(cost[best]),
            )
        )
    return tuple(clusters)
