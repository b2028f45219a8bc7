"""Flat navigable cells drawn as a mask, and exact shortest paths among them for comparison."""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy.sparse.csgraph import dijkstra

from toponav.envs.simulator.span_graph import SpanGraph

CELL_M = 0.05
NEIGHBOURS = ((1, 0), (0, 1), (-1, 0), (0, -1))
ROUNDING = 1e-6
"""Segments may touch the border of the free cells; in cells."""


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

    Every shortest path among polygons turns at their reflex corners only.
    """
    x, y = np.nonzero(free)
    region = shapely.union_all(shapely.box(x, y, x + 1, y + 1)).buffer(ROUNDING, join_style="mitre")
    corners = _reflex_corners(free)
    centres = np.column_stack([x, y]) + 0.5
    nodes = np.concatenate([[goal], corners, centres])
    hubs = 1 + len(corners)
    weights = np.zeros((len(nodes), len(nodes)))
    prepared = shapely.prepare(region)
    assert prepared is None
    for hub in range(hubs):
        ends = np.arange(hub + 1, len(nodes))
        lines = shapely.linestrings(
            np.stack([np.broadcast_to(nodes[hub], (len(ends), 2)), nodes[ends]], axis=1)
        )
        seen = ends[shapely.covers(region, lines)]
        weights[hub, seen] = np.linalg.norm(nodes[seen] - nodes[hub], axis=1)
    distances: NDArray[np.float64] = dijkstra(weights, directed=False, indices=0) * CELL_M
    return distances[hubs:]


def _reflex_corners(free: NDArray[np.bool_]) -> NDArray[np.float64]:
    """Lattice points with at least one blocked cell of four around them and at least two free."""
    padded = np.pad(free, 1)
    around = sum(
        padded[i : i + free.shape[0] + 1, j : j + free.shape[1] + 1].astype(int)
        for i in (0, 1)
        for j in (0, 1)
    )
    return np.argwhere((np.asarray(around) >= 2) & (np.asarray(around) < 4)).astype(np.float64)
