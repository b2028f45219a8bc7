"""The reduced Voronoi graph of free space: junctions and ends of its middle lines."""

from __future__ import annotations

import math
from dataclasses import dataclass

import networkx as nx
import numpy as np
from numba import njit
from numpy.typing import ArrayLike, NDArray
from scipy.ndimage import binary_dilation, convolve, label

from toponav.mapping.view import OccupancyGrid

EIGHT = np.ones((3, 3), np.bool_)
"""Cells that touch at a corner are neighbours."""


@dataclass(frozen=True, eq=False)
class VoronoiGraph:
    """Nodes on the middle lines of free space, joined where a line leads from one to the other.

    Attributes:
        nodes: (N, 2) positions, world frame, metres: junctions and ends.
        graph: Node indices; an edge's `length` is that of the line, metres.
    """

    nodes: NDArray[np.float64]
    graph: nx.Graph[int]

    def nearest(self, xy: ArrayLike) -> int:
        """The node nearest to a position by straight line; there must be one."""
        offset = self.nodes - np.asarray(xy, dtype=np.float64)[:2]
        return int(np.argmin(np.hypot(offset[:, 0], offset[:, 1])))

    def leads_to(self, start: int, goals: frozenset[int]) -> frozenset[int]:
        """The neighbours of a node that the shortest ways from it to any of the goals pass."""
        ways = nx.single_source_dijkstra_path(self.graph, start, weight="length")
        return frozenset(ways[goal][1] for goal in goals if goal != start and goal in ways)


def voronoi_graph(free: NDArray[np.bool_], grid: OccupancyGrid, merge_m: float) -> VoronoiGraph:
    """The graph of the middle lines of (N_x, N_y) free cells.

    Args:
        free: Cells to walk on.
        grid: Says where the cells lie.
        merge_m: Nodes joined by a line shorter than this are one.
    """
    line = thinned(free)
    neighbours = convolve(line.astype(np.int8), EIGHT.astype(np.int8), mode="constant") - 1
    is_node = line & (neighbours != 2)
    spots, count = label(is_node, structure=EIGHT)
    graph: nx.Graph[int] = nx.Graph()
    graph.add_nodes_from(range(1, count + 1))
    branches, branch_count = label(line & ~is_node, structure=EIGHT)
    sizes = np.bincount(branches.ravel(), minlength=branch_count + 1)
    touched = _touched_spots(branches, spots, branch_count)
    for branch in range(1, branch_count + 1):
        ends = sorted(touched[branch])
        length = (int(sizes[branch]) + 1) * grid.resolution
        for first in ends:
            for second in ends:
                if first < second and length < _length(graph, first, second):
                    graph.add_edge(first, second, length=length)
    cells = {spot: np.argwhere(spots == spot) for spot in graph}
    position = {spot: grid.center_of(_middle(cells[spot])) for spot in graph}
    _merge(graph, merge_m)
    order = {spot: index for index, spot in enumerate(sorted(graph))}
    nodes = np.array([position[spot] for spot in order], dtype=np.float64).reshape(-1, 2)
    return VoronoiGraph(nodes, nx.relabel_nodes(graph, order))


def _touched_spots(
    branches: NDArray[np.int32], spots: NDArray[np.int32], count: int
) -> list[set[int]]:
    """The spots beside each branch, by the branch's number."""
    touched: list[set[int]] = [set() for _ in range(count + 1)]
    rows, columns = branches.shape
    for i, j in np.argwhere(binary_dilation(spots > 0, structure=EIGHT) & (branches > 0)):
        around = spots[max(i - 1, 0) : min(i + 2, rows), max(j - 1, 0) : min(j + 2, columns)]
        touched[branches[i, j]].update(int(spot) for spot in around[around > 0])
    return touched


def _length(graph: nx.Graph[int], first: int, second: int) -> float:
    """Length of the edge between two nodes, infinite without one."""
    return float(graph[first][second]["length"]) if graph.has_edge(first, second) else math.inf


def _middle(cells: NDArray[np.int64]) -> NDArray[np.int64]:
    """The cell of a spot that is nearest to its mean."""
    offset = cells - cells.mean(axis=0)
    middle: NDArray[np.int64] = cells[np.argmin((offset**2).sum(axis=1))]
    return middle


def _merge(graph: nx.Graph[int], merge_m: float) -> None:
    """Contract the shortest edge while it is too short; the node with more edges stays."""
    while graph.number_of_edges():
        length, first, second = min(
            (data["length"], *sorted((a, b))) for a, b, data in graph.edges(data=True)
        )
        if length >= merge_m:
            return
        kept, gone = sorted((first, second), key=lambda node: (-graph.degree(node), node))
        for other, data in list(graph[gone].items()):
            if other != kept and data["length"] + length < _length(graph, kept, other):
                graph.add_edge(kept, other, length=data["length"] + length)
        graph.remove_node(gone)


def thinned(free: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """The middle lines, one cell wide, of (N_x, N_y) cells (Zhang and Suen 1984)."""
    image = np.pad(free, 1).astype(np.uint8)
    while _thin_once(image, 0) + _thin_once(image, 1) > 0:
        pass
    return image[1:-1, 1:-1].astype(np.bool_)


@njit(cache=True)
def _thin_once(image: NDArray[np.uint8], phase: int) -> int:
    """Take away one layer on two sides; returns how many cells that were."""
    rows, columns = image.shape
    gone = np.zeros(image.shape, np.bool_)
    count = 0
    around = np.zeros(8, np.uint8)
    for i in range(1, rows - 1):
        for j in range(1, columns - 1):
            if image[i, j] == 0:
                continue
            # Clockwise from the north.
            around[0], around[1], around[2] = image[i - 1, j], image[i - 1, j + 1], image[i, j + 1]
            around[3], around[4] = image[i + 1, j + 1], image[i + 1, j]
            around[5], around[6], around[7] = (
                image[i + 1, j - 1], image[i, j - 1], image[i - 1, j - 1],
            )  # fmt: skip
            neighbours = 0
            crossings = 0
            for k in range(8):
                neighbours += around[k]
                crossings += around[k] == 0 and around[(k + 1) % 8] == 1
            if neighbours < 2 or neighbours > 6 or crossings != 1:
                continue
            north, east, south, west = around[0], around[2], around[4], around[6]
            if phase == 0:
                removable = north * east * south == 0 and east * south * west == 0
            else:
                removable = north * east * west == 0 and north * south * west == 0
            if removable:
                gone[i, j] = True
                count += 1
    for i in range(rows):
        for j in range(columns):
            if gone[i, j]:
                image[i, j] = 0
    return count
