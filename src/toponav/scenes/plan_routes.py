"""How to get from one room of a plan to another: through a shared wall, or along a corridor."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.csgraph import dijkstra

from toponav.scenes.plan_grid import CellMask, PlanGrid, window_sums

CORRIDOR_WIDTHS = (12, 9, 7)
"""Cells; the widest that fits is built."""

MIN_SHARED_WALL_CELLS = 7
"""An opening needs this much wall between two rooms, in cells."""

ROAD_COST = 0.05
"""Cost of moving one cell inside the rooms, against 1 through free ground."""

TURN_COST = 3.0
"""Cost of a turn, in cells: corridors are straight where they can be."""


@dataclass(frozen=True)
class SharedWall:
    """A straight piece of boundary between two rooms, in lattice coordinates.

    Attributes:
        start: Lattice corner where it begins.
        axis: 0 when it runs along x, 1 when along y.
        length: In cells.
    """

    start: tuple[int, int]
    axis: int
    length: int

    @property
    def middle(self) -> tuple[float, float]:
        """Lattice coordinates of its middle."""
        half = self.length / 2.0
        i, j = self.start
        return (i + half, float(j)) if self.axis == 0 else (float(i), j + half)


def longest_shared_wall(grid: PlanGrid, a: int, b: int) -> SharedWall | None:
    """The longest straight boundary between two rooms, or None if it is too short for a door."""
    best: SharedWall | None = None
    for axis in (0, 1):
        # Across the boundary: neighbours along the other axis belong to a and b.
        owner = grid.owner if axis == 0 else grid.owner.T
        first, second = owner[:, :-1], owner[:, 1:]
        boundary = ((first == a) & (second == b)) | ((first == b) & (second == a))
        for line in np.flatnonzero(boundary.any(axis=0)):
            steps = np.diff(np.concatenate(([0], boundary[:, line].astype(np.int8), [0])))
            starts, ends = np.flatnonzero(steps == 1), np.flatnonzero(steps == -1)
            for begin, end in zip(starts.tolist(), ends.tolist(), strict=True):
                if best is None or end - begin > best.length:
                    corner = (begin, int(line) + 1)
                    best = SharedWall(corner if axis == 0 else corner[::-1], axis, end - begin)
    return best if best is not None and best.length >= MIN_SHARED_WALL_CELLS else None


def corridor(grid: PlanGrid, a: int, b: int, passable: CellMask) -> CellMask | None:
    """The cells of the best corridor from room a to room b, or None if none fits.

    Args:
        grid: The plan.
        a: Key of a room.
        b: Key of another room.
        passable: (nx, ny) cells that the corridor may cross besides the two rooms.

    Returns:
        (nx, ny) cells outside the two rooms; empty when the rooms touch widely enough.
    """
    inside = grid.mask(a) | grid.mask(b)
    for width in CORRIDOR_WIDTHS:
        fits = window_sums(~(passable | inside), width, width) == 0
        sources = window_sums(~grid.mask(a), width, width) == 0
        targets = window_sums(~grid.mask(b), width, width) == 0
        outside = window_sums(~inside, width, width) / width**2
        route = _cheapest_route(fits, ROAD_COST + outside, sources, targets)
        if route is not None:
            swept = np.zeros(grid.owner.shape, np.bool_)
            for i, j in route:
                swept[i : i + width, j : j + width] = True
            return swept & ~inside
    return None


def _cheapest_route(
    allowed: CellMask, cost: NDArray[np.float64], sources: CellMask, targets: CellMask
) -> list[tuple[int, int]] | None:
    """The cheapest 4-connected route over allowed positions from a source to a target.

    Each position exists twice, for travel along either axis, so that turns have a price.
    """
    if not sources.any() or not targets.any():
        return None
    size = allowed.size
    index = np.arange(size).reshape(allowed.shape)
    rows: list[NDArray[np.int64]] = []
    columns: list[NDArray[np.int64]] = []
    weights: list[NDArray[np.float64]] = []
    for layer, (near, far) in enumerate(
        (
            ((slice(None, -1), slice(None)), (slice(1, None), slice(None))),
            ((slice(None), slice(None, -1)), (slice(None), slice(1, None))),
        )
    ):
        both = allowed[near] & allowed[far]
        rows.append(index[near][both] + layer * size)
        columns.append(index[far][both] + layer * size)
        weights.append((cost[near][both] + cost[far][both]) / 2.0)
    rows.append(index[allowed])
    columns.append(index[allowed] + size)
    weights.append(np.full(len(rows[-1]), TURN_COST))
    graph = sparse.csr_array(
        (np.concatenate(weights), (np.concatenate(rows), np.concatenate(columns))),
        shape=(2 * size, 2 * size),
    )
    starts = np.flatnonzero(sources.ravel())
    distances, before, _ = dijkstra(
        graph,
        directed=False,
        indices=np.concatenate((starts, starts + size)),
        min_only=True,
        return_predecessors=True,
    )
    goals = np.flatnonzero(targets.ravel())
    goals = np.concatenate((goals, goals + size))
    node = int(goals[np.argmin(distances[goals])])
    if not np.isfinite(distances[node]):
        return None
    route = []
    while node >= 0:
        position = node % size
        route.append((position // allowed.shape[1], position % allowed.shape[1]))
        node = int(before[node])
    return route
