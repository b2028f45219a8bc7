"""The navigable cells of a heightfield: linked, kept clear of obstacles, numbered by island.

A cell is the part of a column's span on which the centre of the agent's foot may be. Cells of
neighbouring columns are linked when the step between them can be climbed and the opening between
them is high enough. What has no link in some direction borders an obstacle (or a drop), and cells
closer to one than the agent's radius are taken away: Recast's rcBuildCompactHeightfield and
rcErodeWalkableArea, with Euclidean distances.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from toponav.envs.simulator.agent_body import AgentBody
from toponav.envs.simulator.heightfield import HEIGHT_TOLERANCE_M, Heightfield

MIN_ISLAND_AREA_M2 = 1.0
"""Islands smaller than this (the inside of a wardrobe, a table's top) are no places to be: Recast's
region_min_size of 20 x 20 cells, Habitat's default too."""

DIRECTION_X = np.array([1, 0, -1, 0])
DIRECTION_Y = np.array([0, 1, 0, -1])


class SpanGraph(NamedTuple):
    """Navigable cells and their links; a plain tuple of arrays, as kernels want it.

    Attributes:
        origin: (2,) world x and y of the corner of column (0, 0), metres.
        cell_size: Side of a cell, metres.
        shape: Columns along x and along y.
        column_start: (nx * ny + 1,) int64; column x * ny + y holds cells
            `column_start[c]:column_start[c + 1]`, from low to high.
        x: (S,) int64 column of each cell along x.
        y: (S,) int64 column of each cell along y.
        z: (S,) height of the surface at the cell's centre, metres.
        ceiling: (S,) height of the next solid above, metres; inf under the open sky.
        links: (S, 4) int64 neighbours towards +x, +y, -x and -y; -1 where an obstacle is.
        island: (S,) int64 island of each cell; cells that a path connects share an island.
    """

    origin: NDArray[np.float64]
    cell_size: float
    shape: tuple[int, int]
    column_start: NDArray[np.int64]
    x: NDArray[np.int64]
    y: NDArray[np.int64]
    z: NDArray[np.float64]
    ceiling: NDArray[np.float64]
    links: NDArray[np.int64]
    island: NDArray[np.int64]


def build_span_graph(field: Heightfield, body: AgentBody) -> SpanGraph:
    """Link the spans of a heightfield and keep those where the whole body has room."""
    columns = np.repeat(np.arange(len(field.column_start) - 1), np.diff(field.column_start))
    graph = SpanGraph(
        origin=field.origin,
        cell_size=body.cell_size,
        shape=field.shape,
        column_start=field.column_start,
        x=columns // field.shape[1],
        y=columns % field.shape[1],
        z=field.z,
        ceiling=field.ceiling,
        links=np.zeros((0, 4), np.int64),
        island=np.zeros(len(columns), np.int64),
    )
    climb = body.max_climb + HEIGHT_TOLERANCE_M
    graph = graph._replace(links=_link(graph, climb, body.height - HEIGHT_TOLERANCE_M))
    graph = subset(graph, ~_too_steep(graph, climb))
    graph = subset(graph, _clearance(graph, body.radius) > body.radius)
    island = _components(graph.links)
    large = np.bincount(island) * body.cell_size**2 >= MIN_ISLAND_AREA_M2
    graph = subset(graph, large[island])
    return graph._replace(island=_components(graph.links))


@njit(cache=True)
def _link(graph, climb, headroom):  # type: ignore[no-untyped-def]
    """(S, 4) neighbours within a climb's height, with an opening of `headroom` between them."""
    nx, ny = graph.shape
    links = np.full((len(graph.z), 4), -1, np.int64)
    for s in range(len(graph.z)):
        for d in range(4):
            x, y = graph.x[s] + DIRECTION_X[d], graph.y[s] + DIRECTION_Y[d]
            if not (0 <= x < nx and 0 <= y < ny):
                continue
            column = x * ny + y
            for t in range(graph.column_start[column], graph.column_start[column + 1]):
                opening = min(graph.ceiling[s], graph.ceiling[t]) - max(graph.z[s], graph.z[t])
                if abs(graph.z[s] - graph.z[t]) <= climb and opening >= headroom:
                    links[s, d] = t
    return links


def _too_steep(graph: SpanGraph, climb: float) -> NDArray[np.bool_]:
    """(S,) spans between neighbours further apart in height than a climb (rcFilterLedgeSpans)."""
    linked = graph.links >= 0
    neighbour_z = np.where(linked, graph.z[graph.links], graph.z[:, None])
    steep: NDArray[np.bool_] = np.ptp(neighbour_z, axis=1) > climb
    return steep


@njit(cache=True)
def _clearance(graph, limit):  # type: ignore[no-untyped-def]
    """(S,) distance from each cell's centre to that of the nearest missing one, metres.

    Offsets to the nearest missing cell spread from neighbour to neighbour (a vector distance
    transform), so a wall of another storey does not count. Exact up to `limit`.
    """
    count = len(graph.z)
    offset = np.full((count, 2), np.iinfo(np.int32).max, np.int64)
    squared = np.full(count, np.inf, np.float64)
    for s in range(count):
        for d in range(4):
            if graph.links[s, d] < 0:
                offset[s, 0], offset[s, 1] = DIRECTION_X[d], DIRECTION_Y[d]
                squared[s] = 1.0
    # Each sweep carries an offset at least one cell further along each axis.
    for _ in range(2 * int(np.ceil(limit / graph.cell_size))):
        for s in range(count):
            for d in range(4):
                t = graph.links[s, d]
                if t >= 0 and squared[t] < np.inf:
                    dx, dy = offset[t, 0] + DIRECTION_X[d], offset[t, 1] + DIRECTION_Y[d]
                    if dx * dx + dy * dy < squared[s]:
                        offset[s, 0], offset[s, 1] = dx, dy
                        squared[s] = dx * dx + dy * dy
    return np.sqrt(squared) * graph.cell_size


def subset(graph: SpanGraph, keep: NDArray[np.bool_]) -> SpanGraph:
    """The same graph with fewer cells."""
    new_index = np.append(np.where(keep, np.cumsum(keep) - 1, -1), -1)
    kept_before = np.append(0, np.cumsum(keep))
    return graph._replace(
        column_start=kept_before[graph.column_start],
        x=graph.x[keep],
        y=graph.y[keep],
        z=graph.z[keep],
        ceiling=graph.ceiling[keep],
        links=new_index[graph.links[keep]],
        island=graph.island[keep],
    )


def _components(links: NDArray[np.int64]) -> NDArray[np.int64]:
    """(S,) number of the connected component of each cell."""
    sources, directions = np.nonzero(links >= 0)
    targets = links[sources, directions]
    ones = np.ones(len(sources), np.int8)
    matrix = coo_array((ones, (sources, targets)), shape=(len(links), len(links)))
    _, labels = connected_components(matrix, directed=False)
    component: NDArray[np.int64] = labels.astype(np.int64)
    return component
