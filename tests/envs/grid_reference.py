"""Flat navigable cells drawn as a mask, and exact shortest paths among them for comparison."""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy.sparse.csgraph import dijkstra

from toponav.envs.simulator.span_graph import SpanGraph

CELL_M = 0.05
NEIGHBOURS = ((1, 0), (0, 1), (-1, 0), (0, -1))
HAIR = 1e-4
"""In cells: far below any length that matters, far above rounding."""


def flat_graph(free: NDArray[np.bool_]) -> SpanGraph:
    """One storey at z = 0 whose navigable cells are the true ones of an (nx, ny) mask."""
    x, y = np.nonzero(free)
    index = np.full((free.shape[0] + 2, free.shape[1] + 2), -1)
    index[x + 1, y + 1] = np.arange(len(x))
    links = np.column_stack([index[x + 1 + dx, y + 1 + dy] for dx, dy in NEIGHBOURS])
    return SpanGraph(
        origin=np.zeros(2),
        cell_size=CELL_M,
        shape=free.shape,
        column_start=np.concatenate([[0], np.cumsum(free.reshape(-1))]),
        x=x,
        y=y,
        z=np.zeros(len(x)),
        ceiling=np.full(len(x), np.inf),
        links=links,
        island=np.zeros(len(x), np.int64),
    )


def exact_distances(free: NDArray[np.bool_], goal: tuple[float, float]) -> NDArray[np.float64]:
    """(S,) metres from each free cell's centre to a goal given in cells, by a visibility graph.

    A shortest path among polygons turns at their corners only. Cells that share but a corner are
    kept apart: the free region is shrunk by a hair before its corners are taken.
    """
    x, y = np.nonzero(free)
    cells = shapely.union_all(shapely.box(x, y, x + 1, y + 1))
    shrunk = cells.buffer(-HAIR, join_style="mitre")
    region = shrunk.buffer(0.1 * HAIR, join_style="mitre")
    shapely.prepare(region)
    corners = shapely.get_coordinates(shrunk)
    centres = np.column_stack([x, y]) + 0.5
    nodes = np.concatenate([[goal], corners, centres])
    hubs = 1 + len(corners)
    weights = np.zeros((len(nodes), len(nodes)))
    for hub in range(hubs):
        ends = np.arange(hub + 1, len(nodes))
        lines = np.stack([np.broadcast_to(nodes[hub], (len(ends), 2)), nodes[ends]], axis=1)
        seen = ends[shapely.covers(region, shapely.linestrings(lines))]
        weights[hub, seen] = np.linalg.norm(nodes[seen] - nodes[hub], axis=1)
    distances: NDArray[np.float64] = dijkstra(weights, directed=False, indices=0) * CELL_M
    return distances[hubs:]
