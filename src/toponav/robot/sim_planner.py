"""Ways for the simulated robot to its goals, over the true map: what Nav2's planner does."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from toponav.control.planner import Clearance, Planner, PlannerConfig
from toponav.envs.surface import Surface
from toponav.mapping.view import FREE, OCCUPIED, OccupancyGrid

CELL_M = 0.05
"""Side of a cell, metres: as Nav2's costmaps have by default."""

SAME_FLOOR_M = 0.5
"""Ground no farther above or below the robot's foot is on its floor, metres."""

BEYOND_M = 30.0
"""The map reaches this far from where the robot first was, metres."""

CLEARANCE_M = 0.35
"""Ways keep to the middle as Nav2's do, metres."""


class SimPlanner:
    """Plans over what a surface says can be stood on."""

    def __init__(self, surface: Surface, end_m: float = 0.0) -> None:
        """Sample nothing yet.

        Args:
            surface: Has half the body's width taken off already.
            end_m: What the body is longer than wide, at either end; it is to turn everywhere.
        """
        self._surface = surface
        config = PlannerConfig(
            radius_m=CELL_M + end_m,
            preferred_clearance_m=CLEARANCE_M + end_m,
            escape_radius_m=0.1,
            goal_tolerance_m=0.5,
        )
        self._planner = Planner(config)
        self._floors: list[tuple[float, OccupancyGrid]] = []

    def way(self, start: NDArray[np.float64], goal: NDArray[np.float64]) -> NDArray[np.float64]:
        """(K, 2) the way between two (3,) points of a floor; empty without one."""
        clearance = self._clearance(start)
        field = self._planner.cost_field(clearance, goal)
        return field.path_from(start) if len(field.goals) else np.zeros((0, 2))

    def _clearance(self, start: NDArray[np.float64]) -> Clearance:
        z = float(start[2])
        known = [grid for floor_z, grid in self._floors if abs(floor_z - z) < SAME_FLOOR_M]
        if not known:
            known = [self._sampled(start)]
            self._floors.append((z, known[0]))
        return self._planner.clearance(known[0], start)

    def _sampled(self, start: NDArray[np.float64]) -> OccupancyGrid:
        """The floor on which a (3,) point lies."""
        side = round(2.0 * BEYOND_M / CELL_M)
        first = np.floor((start[:2] - BEYOND_M) / CELL_M) * CELL_M
        axis = (np.arange(side) + 0.5) * CELL_M
        xy = np.stack(np.meshgrid(first[0] + axis, first[1] + axis, indexing="ij"), axis=-1)
        points = self._surface.points_over(xy.reshape(-1, 2))
        points = points[np.abs(points[:, 2] - start[2]) < SAME_FLOOR_M]
        index = np.floor((points[:, :2] - first) / CELL_M).astype(np.int64)
        low, high = index.min(axis=0) - 1, index.max(axis=0) + 2
        cells = np.full(tuple(high - low), OCCUPIED, np.int8)
        cells[tuple((index - low).T)] = FREE
        origin = first + low * CELL_M
        return OccupancyGrid(cells, (float(origin[0]), float(origin[1])), CELL_M)
