"""Shortest paths over known free space: one cost-to-go field a goal, no simulator's navmesh."""

from __future__ import annotations

import heapq
from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import ArrayLike, NDArray
from scipy.ndimage import distance_transform_edt

from toponav.config_model import ConfigModel
from toponav.mapping.view import FREE, OCCUPIED, OccupancyGrid


class PlannerConfig(ConfigModel):
    """How close to obstacles a path may come."""

    radius_m: float = 0.18
    """Radius of the agent (PROTOCOL: 0.18 m)."""

    preferred_clearance_m: float = 0.5
    """Nearer to obstacles than this, every metre costs more, so that paths keep to the middle."""

    clearance_weight: float = 3.0
    """Extra cost of a metre at zero clearance."""

    escape_radius_m: float = 0.45
    """Around the agent, free cells may be crossed however near an obstacle is: it stands there."""


@dataclass(frozen=True, eq=False)
class Clearance:
    """Where the agent fits, on one grid.

    Attributes:
        grid: The grid.
        distance_m: (N_x, N_y) distance from a cell's centre to the nearest obstacle's cell edge.
        traversable: (N_x, N_y) bool, free cells in which the agent fits.
        step_cost: (N_x, N_y) cost of a metre, at least 1.
    """

    grid: OccupancyGrid
    distance_m: NDArray[np.float64]
    traversable: NDArray[np.bool_]
    step_cost: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class CostField:
    """Cost-to-go to a set of cells: metres, weighted where it is narrow.

    Attributes:
        clearance: Where the agent fits.
        cost: (N_x, N_y), infinite where the goal cannot be reached from.
    """

    clearance: Clearance
    cost: NDArray[np.float64]

    def at(self, xy: ArrayLike) -> NDArray[np.float64]:
        """(...,) cost at (..., 2) positions; infinite outside the grid."""
        grid = self.clearance.grid
        index = grid.index_of(xy)
        inside = grid.contains(index)
        cell = np.where(inside[..., None], index, 0)
        return np.where(inside, self.cost[cell[..., 0], cell[..., 1]], np.inf)

    def geodesic(self, a: ArrayLike, b: ArrayLike) -> float:
        """Length of the way between the field's goal and the farther of two positions, metres.

        One of them is where the field starts from; infinite when there is no way.
        """
        return max(self.length_from(a), self.length_from(b))

    def length_from(self, xy: ArrayLike) -> float:
        """Length of `path_from`, metres; infinite when there is no way."""
        path = self.path_from(xy)
        if not len(path):
            return np.inf
        return float(np.hypot(*np.diff(path, axis=0).T).sum())

    def path_from(self, xy: ArrayLike) -> NDArray[np.float64]:
        """(K, 2) cell centres down the field to its goal; empty when there is no way."""
        grid = self.clearance.grid
        i, j = (int(k) for k in grid.index_of(xy))
        if not grid.contains((i, j)) or not np.isfinite(self.cost[i, j]):
            return np.zeros((0, 2))
        return grid.center_of(_descend(self.cost, i, j))


class Planner:
    """Plans on an occupancy grid; deterministic, without state."""

    def __init__(self, config: PlannerConfig) -> None:
        """Take the clearances."""
        self._config = config

    def clearance(
        self, grid: OccupancyGrid, agent_xy: ArrayLike, blocked: ArrayLike | None = None
    ) -> Clearance:
        """Inflate the obstacles by the agent's radius.

        Args:
            grid: Known space; only FREE cells are ever crossed.
            agent_xy: (2,) where the agent stands.
            blocked: (N, 2) cells that the agent has bumped into.
        """
        occupied = grid.cells == OCCUPIED
        free = grid.cells == FREE
        if blocked is not None and len(cells := np.asarray(blocked, dtype=np.int64)):
            cells = cells[grid.contains(cells)]
            occupied[cells[:, 0], cells[:, 1]] = True
            free &= ~occupied
        half_cell = 0.5 * grid.resolution
        if occupied.any():
            distance = distance_transform_edt(~occupied) * grid.resolution - half_cell
        else:
            distance = np.full(grid.cells.shape, np.inf)
        config = self._config
        # An obstacle's surface lies anywhere in its cell, on average half a cell inside.
        fits = free & (distance + half_cell > config.radius_m)
        x, y = (np.asarray(agent_xy, dtype=np.float64)[:2] - grid.origin) / grid.resolution
        rows, columns = np.ogrid[: grid.cells.shape[0], : grid.cells.shape[1]]
        here = np.hypot(rows + 0.5 - x, columns + 0.5 - y) * grid.resolution
        fits |= free & (here < config.escape_radius_m)
        shortfall = np.clip(1.0 - distance / config.preferred_clearance_m, 0.0, 1.0)
        cost = 1.0 + config.clearance_weight * shortfall**2
        return Clearance(grid, distance, fits, cost)

    def cost_field(self, clearance: Clearance, goals_xy: ArrayLike) -> CostField:
        """Cost-to-go from every cell to the nearest of (N, 2) goal positions."""
        grid = clearance.grid
        index = grid.index_of(np.atleast_2d(np.asarray(goals_xy, dtype=np.float64)))
        index = index[grid.contains(index)]
        cost = _dijkstra(clearance.traversable, clearance.step_cost * grid.resolution, index)
        return CostField(clearance, cost)


_NEIGHBOURS = np.array(
    [
        (1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (1, -1), (-1, 1), (-1, -1),
        (2, 1), (2, -1), (-2, 1), (-2, -1), (1, 2), (1, -2), (-1, 2), (-1, -2),
    ],
    dtype=np.int64,
)  # fmt: skip
"""16 neighbours: straight, diagonal and knight's moves keep lengths within 3 % of Euclid's."""


@njit(cache=True)
def _clear_between(traversable: NDArray[np.bool_], i: int, j: int, di: int, dj: int) -> bool:
    """Whether no corner is cut between a cell and its neighbour."""
    if abs(di) == 2:
        return bool(traversable[i + di // 2, j] and traversable[i + di // 2, j + dj])
    if abs(dj) == 2:
        return bool(traversable[i, j + dj // 2] and traversable[i + di, j + dj // 2])
    return bool(traversable[i + di, j] and traversable[i, j + dj])


@njit(cache=True)
def _dijkstra(
    traversable: NDArray[np.bool_], cell_cost: NDArray[np.float64], goals: NDArray[np.int64]
) -> NDArray[np.float64]:
    """Cost-to-go by Dijkstra's algorithm with a binary heap; ties go to the lower cell index."""
    rows, columns = traversable.shape
    cost = np.full((rows, columns), np.inf)
    heap = [(0.0, 0)]
    heap.pop()
    for k in range(len(goals)):
        i, j = goals[k]
        if traversable[i, j] and cost[i, j] > 0.0:
            cost[i, j] = 0.0
            heapq.heappush(heap, (0.0, i * columns + j))
    while heap:
        distance, cell = heapq.heappop(heap)
        i, j = cell // columns, cell % columns
        if distance > cost[i, j]:
            continue
        for n in range(16):
            di, dj = _NEIGHBOURS[n]
            a, b = i + di, j + dj
            if a < 0 or b < 0 or a >= rows or b >= columns or not traversable[a, b]:
                continue
            if n >= 4 and not _clear_between(traversable, i, j, di, dj):
                continue
            length = np.sqrt(float(di * di + dj * dj))
            candidate = distance + length * 0.5 * (cell_cost[i, j] + cell_cost[a, b])
            if candidate < cost[a, b] - 1e-12:
                cost[a, b] = candidate
                heapq.heappush(heap, (candidate, a * columns + b))
    return cost


def _descend(cost: NDArray[np.float64], i: int, j: int) -> NDArray[np.int64]:
    """(K, 2) cells from (i, j) down to a local minimum, which is a goal."""
    cells = [(i, j)]
    while True:
        best = cells[-1]
        for di, dj in _NEIGHBOURS[:8]:
            a, b = cells[-1][0] + int(di), cells[-1][1] + int(dj)
            if 0 <= a < cost.shape[0] and 0 <= b < cost.shape[1] and cost[a, b] < cost[best]:
                best = (a, b)
        if best == cells[-1]:
            return np.array(cells, dtype=np.int64)
        cells.append(best)
