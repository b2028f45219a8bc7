"""Ways over known free space: one cost-to-go field a goal, no simulator's navmesh."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numba import njit
from numpy.typing import ArrayLike, NDArray
from pydantic import Field
from scipy.ndimage import binary_dilation
from shapely import Polygon, contains_xy

from toponav.config_model import ConfigModel
from toponav.control.landings import landings
from toponav.control.obstacle_distance import obstacle_distance
from toponav.control.shortest_paths import (
    EVERYWHERE,
    NO_PARENT,
    Ground,
    costs_between,
    ground_of,
    shortest_paths,
)
from toponav.mapping.view import DROP, FREE, OCCUPIED, OccupancyGrid


class PlannerConfig(ConfigModel):
    """How close to obstacles a path may come."""

    radius_m: float = Field(default=0.18, gt=0.0)
    """Radius of the agent, metres (PROTOCOL)."""

    preferred_clearance_m: float = Field(default=0.5, gt=0.0)
    """Nearer to obstacles than this, every metre costs more, so that paths keep to the middle."""

    clearance_weight: float = Field(default=3.0, ge=0.0)
    """Extra cost of a metre at zero clearance, in metres."""

    tight_weight: float = Field(default=0.0, ge=0.0)
    """The same for what is nearer to obstacles than the agent's radius, where it may touch them."""

    escape_radius_m: float = Field(default=0.45, ge=0.0)
    """Around the agent, free cells may be crossed however near an obstacle is: it stands there."""

    squeeze_radius_m: float = Field(default=0.1, gt=0.0)
    """Where nothing else leads on, gaps that would let through an agent of this radius, metres, are
    tried: on the map a gap may be narrower by a cell than it is."""

    max_step_m: float = Field(default=0.3, gt=0.0)
    """Where a stair is higher or lower than this against the floor beside it, metres, one cannot
    step on it: more than a riser (0.2 m at most) and the map's noise."""

    landing_m: float = Field(default=0.0, ge=0.0)
    """Before the last treads of a flight, floor that no image showed is taken for its landing, as
    long as this, metres: who comes down a flight sees the floor there only from there."""

    goal_tolerance_m: float = Field(default=0.3, ge=0.0)
    """A goal where the agent does not fit is replaced by the nearest cell within this where it
    does."""

    keep_out: tuple[tuple[tuple[float, float], ...], ...] = ()
    """Areas that are obstacles whatever is seen there, each by its corners, metres."""


TREAD_CELLS = 3
"""This near to a tread, a drop may be one that was not seen: one keeps off it, but not clear."""


@dataclass(frozen=True, eq=False)
class Clearance:
    """Where the agent fits, on one grid.

    Attributes:
        grid: The grid.
        distance_m: (N_x, N_y) distance from a cell's centre to the nearest obstacle cell's edge.
        traversable: (N_x, N_y) bool, cells in which the agent fits.
        step_cost: (N_x, N_y) cost of a metre, at least 1.
    """

    grid: OccupancyGrid
    distance_m: NDArray[np.float64]
    traversable: NDArray[np.bool_]
    step_cost: NDArray[np.float64]

    @cached_property
    def ground(self) -> Ground:
        """The same for searches, all of which share it."""
        return ground_of(self.traversable, self.step_cost * self.grid.resolution)


@dataclass(frozen=True, eq=False)
class CostField:
    """Cost-to-go to the nearest of some goals: metres, weighted where it is narrow.

    Attributes:
        clearance: Where the agent fits.
        goals: (G, 2) what the field leads to: the goals as given where the agent fits there, else
            the cells that replace them; world frame, metres.
        cost: (N_x, N_y), infinite where no goal can be reached from.
        parent: (N_x, N_y) flat index of the next cell on the way; `NO_PARENT` at goals and where
            there is no way.
    """

    clearance: Clearance
    goals: NDArray[np.float64]
    cost: NDArray[np.float64]
    parent: NDArray[np.int64]

    def at(self, xy: ArrayLike) -> NDArray[np.float64]:
        """(...,) cost from (..., 2 or 3) positions; infinite outside the grid and without a way.

        It is that of the straight line to the centre of the next cell on the way, and on from
        there, which tells positions within one cell apart.
        """
        grid = self.clearance.grid
        index = grid.index_of(xy)
        inside = grid.contains(index)
        cell = np.where(inside[..., None], index, 0)
        i, j = cell[..., 0], cell[..., 1]
        flat = i * self.cost.shape[1] + j
        parent = self.parent[i, j]
        onward = np.stack(
            np.unravel_index(np.where(parent == NO_PARENT, flat, parent), self.cost.shape), axis=-1
        )
        a, b = onward[..., 0], onward[..., 1]
        step_cost = 0.5 * (self.clearance.step_cost[i, j] + self.clearance.step_cost[a, b])
        offset = grid.center_of(onward) - np.asarray(xy, dtype=np.float64)[..., :2]
        cost = self.cost[a, b] + step_cost * np.hypot(offset[..., 0], offset[..., 1])
        return np.where(inside, cost, np.inf)

    def path_from(self, xy: ArrayLike) -> NDArray[np.float64]:
        """(K, 2) cell centres on the cheapest way to a goal; empty when there is none."""
        grid = self.clearance.grid
        start = grid.index_of(xy)
        if not np.isfinite(self.at(xy)):
            return np.zeros((0, 2))
        flat = int(np.ravel_multi_index((start[0], start[1]), self.cost.shape))
        cells = [flat]
        while (flat := int(self.parent.flat[flat])) != NO_PARENT:
            cells.append(flat)
        return grid.center_of(np.stack(np.unravel_index(cells, self.cost.shape), axis=-1))

    def length_from(self, xy: ArrayLike) -> float:
        """Length of `path_from`, metres; infinite when there is no way."""
        path = self.path_from(xy)
        if not len(path):
            return math.inf
        return float(np.hypot(*np.diff(path, axis=0).T).sum())

    def geodesic(self, a: ArrayLike, b: ArrayLike) -> float:
        """Length of the way between the field's goal and the farther of two positions, metres.

        One of them is where the field leads; infinite when there is no way.
        """
        return max(self.length_from(a), self.length_from(b))


class Planner:
    """Plans on an occupancy grid; deterministic, without state."""

    def __init__(self, config: PlannerConfig) -> None:
        """Take the clearances."""
        self._config = config

    def clearance(
        self,
        grid: OccupancyGrid,
        agent_xy: ArrayLike,
        blocked_xy: ArrayLike | None = None,
        *,
        squeeze: bool = False,
    ) -> Clearance:
        """Inflate the obstacles by the agent's radius.

        Args:
            grid: Known space; beyond the agent's own body only FREE cells are ever crossed.
            agent_xy: (2 or 3,) where the agent stands, world frame, metres.
            blocked_xy: (N, 2) positions of obstacles that the agent felt and no image shows.
            squeeze: By `squeeze_radius_m` instead.
        """
        config = self._config
        radius_m = config.squeeze_radius_m if squeeze else config.radius_m
        occupied = (grid.cells == OCCUPIED) | (grid.cells == DROP)
        free = grid.cells == FREE
        if grid.stairs is not None:
            on_flight = binary_dilation(np.isfinite(grid.stairs), iterations=TREAD_CELLS)
            occupied &= ~(on_flight & (grid.cells == DROP))  # treads not seen yet, more likely
            occupied |= _flight_sides(free, grid.stairs, config.max_step_m)
            free |= landings(grid, config.landing_m)
            free &= ~occupied
        if config.keep_out:
            occupied |= _inside(config.keep_out, grid)
            free &= ~occupied
        if blocked_xy is not None:
            felt = grid.index_of(np.asarray(blocked_xy, dtype=np.float64).reshape(-1, 2))
            felt = felt[grid.contains(felt)]
            occupied[felt[:, 0], felt[:, 1]] = True
            free &= ~occupied
        half_cell = 0.5 * grid.resolution
        distance = obstacle_distance(occupied) * grid.resolution - half_cell
        # An obstacle's surface lies anywhere in its cell, on average half a cell inside; a whole
        # cell of margin would close doors of 0.7 m on a 0.1 m grid.
        fits = free & (distance + half_cell > radius_m)
        about, here = _distance_to(grid, agent_xy, max(config.escape_radius_m, config.radius_m))
        fits[about] |= free[about] & (here <= config.escape_radius_m)
        # Where its body is there is no obstacle, whatever the map says.
        fits[about] |= here <= config.radius_m
        preferred = (config.preferred_clearance_m, config.clearance_weight)
        cost = _step_costs(distance, preferred, (config.radius_m, config.tight_weight))
        return Clearance(grid, distance, fits, cost)

    def cost_field(
        self,
        clearance: Clearance,
        goals_xy: ArrayLike,
        wanted_xy: ArrayLike | None = None,
        margin_m: float = 0.0,
    ) -> CostField:
        """Cost-to-go to the nearest of (N, 2 or 3) goal positions.

        Args:
            clearance: Where the agent fits.
            goals_xy: What the field leads to.
            wanted_xy: (W, 2 or 3) where the field will be asked for; by default everywhere. Other
                places may be left without a cost, which saves most of the work in a large map.
            margin_m: Places that cost up to this more than any wanted one keep theirs.
        """
        grid = clearance.grid
        goals = np.atleast_2d(np.asarray(goals_xy, dtype=np.float64))[:, :2]
        kept = [goal for goal in (self._fit(clearance, goal) for goal in goals) if goal is not None]
        fitted = np.asarray(kept, dtype=np.float64).reshape(-1, 2)
        until = EVERYWHERE
        if wanted_xy is not None:
            wanted = np.atleast_2d(grid.index_of(wanted_xy))
            until = (wanted, margin_m) if grid.contains(wanted).all() else EVERYWHERE
        cost, parent = shortest_paths(clearance.ground, grid.index_of(fitted), until)
        return CostField(clearance, fitted, cost, parent)

    def costs_between(
        self, reach: CostField, places: NDArray[np.float64], within: ArrayLike = math.inf
    ) -> NDArray[np.float64]:
        """(N, N) costs of the ways between (N, 2 or 3) places; infinite without one.

        Args:
            reach: Costs to every cell from anywhere, which tell what cannot be near.
            places: World frame, metres.
            within: Ways that cost more than this may be left out, which saves most of the work in
                a large map: one cost, or a symmetric (N, N) of them.
        """
        clearance, grid = reach.clearance, reach.clearance.grid
        fitted = [self._fit(clearance, place[:2]) for place in places]
        known = [k for k, place in enumerate(fitted) if place is not None]
        cells = grid.index_of(np.array([fitted[k] for k in known]).reshape(-1, 2))
        between = np.full((len(places), len(places)), np.inf)
        limits = np.broadcast_to(np.asarray(within, np.float64), between.shape)
        pairs = np.ix_(known, known)
        between[pairs] = costs_between(clearance.ground, cells, limits[pairs], reach.cost)
        return between

    def _fit(
        self, clearance: Clearance, goal_xy: NDArray[np.float64]
    ) -> NDArray[np.float64] | None:
        """The goal, or the centre of the nearest cell in which the agent fits; None if too far."""
        grid = clearance.grid
        cell = grid.index_of(goal_xy)
        if grid.contains(cell) and clearance.traversable[cell[0], cell[1]]:
            return goal_xy
        reach = math.ceil(self._config.goal_tolerance_m / grid.resolution)
        low = np.maximum(cell - reach, 0)
        high = np.maximum(cell + reach + 1, 0)
        nearby = np.argwhere(clearance.traversable[low[0] : high[0], low[1] : high[1]]) + low
        if not len(nearby):
            return None
        centers = grid.center_of(nearby)
        distance = np.hypot(*(centers - goal_xy).T)
        nearest = int(np.argmin(distance))
        return centers[nearest] if distance[nearest] <= self._config.goal_tolerance_m else None


@njit(cache=True)
def _step_costs(
    distance: NDArray[np.float64], preferred: tuple[float, float], tight: tuple[float, float]
) -> NDArray[np.float64]:
    """(N_x, N_y) costs of a metre, by two distances under which they grow, and how much at zero."""
    (preferred_m, preferred_weight), (tight_m, tight_weight) = preferred, tight
    costs = np.empty(distance.shape)
    for i in range(distance.shape[0]):
        for j in range(distance.shape[1]):
            shortfall = min(max(1.0 - distance[i, j] / preferred_m, 0.0), 1.0)
            touching = min(max(1.0 - distance[i, j] / tight_m, 0.0), 1.0)
            costs[i, j] = 1.0 + preferred_weight * shortfall**2 + tight_weight * touching**2
    return costs


def _flight_sides(
    free: NDArray[np.bool_], stairs: NDArray[np.float32], max_step_m: float
) -> NDArray[np.bool_]:
    """(N_x, N_y) stair cells beside floor or a tread that is too far below or above to step to.

    Of two such cells it is the one farther from the floor's height.
    """
    on_stairs = np.isfinite(stairs)
    height = np.where(on_stairs, stairs, 0.0)
    height[~(free | on_stairs)] = np.nan
    padded = np.pad(height, 1, constant_values=np.nan)
    sides = np.zeros(free.shape, np.bool_)
    rows, columns = free.shape
    for i in range(3):
        for j in range(3):
            beside = padded[i : i + rows, j : j + columns]
            nearer = np.abs(beside) < np.abs(height)
            sides |= nearer & (np.abs(height - beside) > max_step_m)  # NaN is neither
    return sides & on_stairs


def _inside(
    areas: tuple[tuple[tuple[float, float], ...], ...], grid: OccupancyGrid
) -> NDArray[np.bool_]:
    """(N_x, N_y) cells whose centres lie in one of the areas."""
    centers = grid.center_of(np.moveaxis(np.indices(grid.cells.shape), 0, -1))
    inside: NDArray[np.bool_] = np.zeros(grid.cells.shape, np.bool_)
    for area in areas:
        inside |= contains_xy(Polygon(area), centers)
    return inside


def _distance_to(
    grid: OccupancyGrid, xy: ArrayLike, reach_m: float
) -> tuple[tuple[slice, slice], NDArray[np.float64]]:
    """The cells about a position, and the distance of their centres to it, metres."""
    x, y = (np.asarray(xy, dtype=np.float64)[:2] - grid.origin) / grid.resolution
    reach = reach_m / grid.resolution + 1.0
    rows, columns = grid.cells.shape
    i, i_end = np.clip([math.floor(x - reach), math.ceil(x + reach)], 0, rows)
    j, j_end = np.clip([math.floor(y - reach), math.ceil(y + reach)], 0, columns)
    about = np.ogrid[i:i_end, j:j_end]
    distance = np.hypot(about[0] + 0.5 - x, about[1] + 0.5 - y) * grid.resolution
    return (slice(i, i_end), slice(j, j_end)), distance
