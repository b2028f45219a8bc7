"""Shortest paths over navigable cells in any direction, not only along the grid.

Dijkstra's search in which every cell remembers the last corner (or goal) of its path, and a cell
that this corner sees is measured from it in a straight line: Theta* (Nash, Daniel, Koenig and
Felner, 2007) without a heuristic. On open floor distances are exact; round corners they are as
exact as the cells. A grid's eight directions alone would overestimate by up to 8 %.
"""

from __future__ import annotations

import heapq
import math
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from toponav.envs.simulator.span_graph import SpanGraph
from toponav.envs.simulator.walking import diagonal, walk

GAIN_M = 1e-9
"""Gains smaller than this are rounding."""

NEAR_GOAL_M = 0.25
"""Within one forward step, where success is decided, the line to every goal is measured."""


class ShortestPaths(NamedTuple):
    """The tree of shortest paths from every cell to the nearest goal.

    Nodes 0..G-1 are the goals, node G + s is cell s.

    Attributes:
        goals: G, their number.
        at: (G + S, 2) place of each node, in columns.
        cell: (G + S,) cell of each node.
        distance: (G + S,) metres to the nearest goal; inf where no path leads.
        parent: (G + S,) the next node towards the goal, in sight of this one; a goal's is itself.
    """

    goals: int
    at: NDArray[np.float64]
    cell: NDArray[np.int64]
    distance: NDArray[np.float64]
    parent: NDArray[np.int64]


def shortest_paths(
    graph: SpanGraph, goal_at: NDArray[np.float64], goal_cell: NDArray[np.int64], stop_cell: int = -1
) -> ShortestPaths:
    """Search from goals to all cells, or until `stop_cell` and its neighbours are settled.

    Args:
        graph: The navigable cells.
        goal_at: (G, 2) places of the goals, in columns.
        goal_cell: (G,) the cells that they lie in.
        stop_cell: Where the search may end; -1 for never.
    """
    goals, cells = len(goal_cell), len(graph.z)
    centres = np.stack([graph.x, graph.y], axis=1) + 0.5
    distance = np.full(goals + cells, np.inf)
    distance[:goals] = 0.0
    tree = ShortestPaths(
        goals=goals,
        at=np.concatenate([goal_at, centres]),
        cell=np.concatenate([goal_cell, np.arange(cells)]),
        distance=distance,
        parent=np.arange(goals + cells),
    )
    _search(graph, tree, stop_cell)
    return tree


def distance_at(
    graph: SpanGraph, tree: ShortestPaths, at: tuple[float, float], cell: int
) -> tuple[float, int]:
    """Metres from a place in a cell to the nearest goal, and the first node on the way there.

    Args:
        graph: The navigable cells.
        tree: Of the same graph.
        at: (x, y) in columns.
        cell: The cell of that place.

    Returns:
        (inf, -1) where no path leads.
    """
    distance, node = _distance_at(graph, tree, at, cell)
    return float(distance), int(node)


@njit(cache=True)
def _neighbour(graph, cell, k):  # type: ignore[no-untyped-def]
    """Neighbour k of eight, or -1: four along the axes, then four diagonal ones."""
    if k < 4:
        return graph.links[cell, k]
    return diagonal(graph, cell, 0 if k < 6 else 2, 1 if k % 2 == 0 else 3)


@njit(cache=True)
def _sight(graph, tree, node, at, cell):  # type: ignore[no-untyped-def]
    """Length of the straight walk from a node to a place in a cell; inf when it is blocked."""
    fraction, last, length = walk(graph, tree.cell[node], tree.at[node], at)
    return length if fraction == 1.0 and last == cell else np.inf


@njit(cache=True)
def _gap(graph, tree, node, at):  # type: ignore[no-untyped-def]
    """Horizontal distance between a node and a place, metres."""
    return math.hypot(tree.at[node, 0] - at[0], tree.at[node, 1] - at[1]) * graph.cell_size


@njit(cache=True)
def _search(graph, tree, stop_cell):  # type: ignore[no-untyped-def]
    """Fill the distances and parents of a tree whose goals are set."""
    goals, at, distance, parent = tree.goals, tree.at, tree.distance, tree.parent
    heap = [(0.0, np.int64(0)) for _ in range(0)]
    for goal in range(goals):
        node = goals + tree.cell[goal]
        length = _gap(graph, tree, goal, at[node])
        if length < distance[node]:
            distance[node], parent[node] = length, goal
            heapq.heappush(heap, (length, node))
    settled = np.zeros(len(distance), np.bool_)
    # The neighbours of the last cell lie within two cells of it.
    slack = 2.0 * graph.cell_size
    while heap:
        reached, node = heapq.heappop(heap)
        if settled[node]:
            continue
        if stop_cell >= 0 and reached > distance[goals + stop_cell] + slack:
            break
        settled[node] = True
        corner = parent[node]
        for k in range(8):
            neighbour_cell = _neighbour(graph, node - goals, k)
            if neighbour_cell < 0:
                continue
            neighbour = goals + neighbour_cell
            least = distance[corner] + _gap(graph, tree, corner, at[neighbour])
            if settled[neighbour] or least >= distance[neighbour] - GAIN_M:
                continue
            place = (at[neighbour, 0], at[neighbour, 1])
            via = corner
            length = distance[corner] + _sight(graph, tree, corner, place, neighbour_cell)
            if length == np.inf:
                via = node
                length = distance[node] + _sight(graph, tree, node, place, neighbour_cell)
            if length < distance[neighbour] - GAIN_M:
                distance[neighbour], parent[neighbour] = length, via
                heapq.heappush(heap, (length, neighbour))


@njit(cache=True)
def _distance_at(graph, tree, at, cell):  # type: ignore[no-untyped-def]
    """See `distance_at`: the best of the corners that this cell and its neighbours look to."""
    best, node = np.inf, -1
    for k in range(-1, 8):
        around = cell if k < 0 else _neighbour(graph, cell, k)
        if around < 0 or tree.distance[tree.goals + around] == np.inf:
            continue
        corner = tree.parent[tree.goals + around]
        if tree.distance[corner] + _gap(graph, tree, corner, at) < best - GAIN_M:
            length = tree.distance[corner] + _sight(graph, tree, corner, at, cell)
            if length < best:
                best, node = length, corner
    for goal in range(tree.goals):
        if _gap(graph, tree, goal, at) < min(NEAR_GOAL_M, best):
            length = _sight(graph, tree, goal, at, cell)
            if length < best:
                best, node = length, goal
    if node < 0 and tree.distance[tree.goals + cell] < np.inf:
        node = tree.goals + cell
        best = tree.distance[node] + _gap(graph, tree, node, at)
    return best, node
