"""Shortest paths over navigable cells in any direction, not only along the grid.

Dijkstra's search in which every node remembers the last turn (or goal) of its path, and a node that
this turn sees is measured from it in a straight line: Theta* (Nash, Daniel, Koenig and Felner,
2007) without a heuristic. Beside the centres of the cells, the corners of obstacles are nodes,
since a shortest path turns nowhere else. Distances are those of the visibility graph to within a
centimetre, nearly always exactly; a grid's eight directions would overestimate by up to 8 %.
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

CORNER_INSET = 1e-6
"""A path passes a corner of the free cells at this distance, in columns."""


class ShortestPaths(NamedTuple):
    """The tree of shortest paths from everywhere to the nearest goal.

    Nodes 0..G-1 are the goals, then come the S cells' centres, then the C corners of obstacles.

    Attributes:
        goals: G.
        corners: (S, 4) node at each cell's own corner towards (+x, +y), (+x, -y), (-x, +y) and
            (-x, -y); -1 where no obstacle has a corner there.
        at: (G + S + C, 2) place of each node, in columns.
        cell: (G + S + C,) cell of each node.
        distance: (G + S + C,) metres to the nearest goal; inf where no path leads.
        parent: (G + S + C,) the next node towards the goal, in sight of this one; a goal's is
            itself.
    """

    goals: int
    corners: NDArray[np.int64]
    at: NDArray[np.float64]
    cell: NDArray[np.int64]
    distance: NDArray[np.float64]
    parent: NDArray[np.int64]


def shortest_paths(
    graph: SpanGraph,
    goal_at: NDArray[np.float64],
    goal_cell: NDArray[np.int64],
    stop_cell: int = -1,
) -> ShortestPaths:
    """Search from goals to all cells, or until `stop_cell` and its neighbours are settled.

    Args:
        graph: The navigable cells.
        goal_at: (G, 2) places of the goals, in columns.
        goal_cell: (G,) the cells that they lie in.
        stop_cell: Where the search may end; -1 for never.
    """
    goals, cells = len(goal_cell), len(graph.z)
    centres = np.column_stack([graph.x, graph.y]) + 0.5
    corners, corner_at, corner_cell = _find_corners(graph, goals + cells)
    nodes = goals + cells + len(corner_cell)
    distance = np.full(nodes, np.inf)
    distance[:goals] = 0.0
    tree = ShortestPaths(
        goals=goals,
        corners=corners,
        at=np.concatenate([goal_at, centres, corner_at]),
        cell=np.concatenate([goal_cell, np.arange(cells), corner_cell]),
        distance=distance,
        parent=np.arange(nodes),
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
    """Neighbour k of eight, or -1: diagonal ones towards (+-x, +-y), then those along the axes."""
    if k < 4:
        return diagonal(graph, cell, 0 if k < 2 else 2, 1 if k % 2 == 0 else 3)
    return graph.links[cell, k - 4]


@njit(cache=True)
def _find_corners(graph, first_node):  # type: ignore[no-untyped-def]
    """Corners of obstacles: points where a cell has both neighbours but no diagonal one.

    Returns:
        (S, 4) nodes at the cells' corners, numbered from `first_node`; (C, 2) places and (C,)
        cells of these nodes. A corner belongs to the cell in the middle and is known to the
        neighbours on either side, between which a path turns there.
    """
    corners = np.full((len(graph.z), 4), -1, np.int64)
    at = np.empty((len(graph.z), 2), np.float64)
    cell = np.empty(len(graph.z), np.int64)
    count = 0
    for s in range(len(graph.z)):
        for k in range(4):
            side_x = graph.links[s, 0 if k < 2 else 2]
            side_y = graph.links[s, 1 if k % 2 == 0 else 3]
            if side_x < 0 or side_y < 0 or _neighbour(graph, s, k) >= 0:
                continue
            if count == len(cell):
                at = np.concatenate((at, np.empty_like(at)))
                cell = np.concatenate((cell, np.empty_like(cell)))
            at[count, 0] = graph.x[s] + (1.0 - CORNER_INSET if k < 2 else CORNER_INSET)
            at[count, 1] = graph.y[s] + (1.0 - CORNER_INSET if k % 2 == 0 else CORNER_INSET)
            cell[count] = s
            corners[s, k] = first_node + count
            corners[side_x, k ^ 2] = first_node + count
            corners[side_y, k ^ 1] = first_node + count
            count += 1
    return corners, at[:count], cell[:count]


@njit(cache=True)
def _adjacent(graph, tree, cell, k):  # type: ignore[no-untyped-def]
    """Node k of thirteen around a cell, or -1: eight cells, four corners, the cell itself."""
    if k < 8:
        neighbour = _neighbour(graph, cell, k)
        return tree.goals + neighbour if neighbour >= 0 else -1
    return tree.corners[cell, k - 8] if k < 12 else tree.goals + cell


@njit(cache=True)
def _sight(graph, tree, node, at, cell):  # type: ignore[no-untyped-def]
    """Length of the straight walk from a node to a place in a cell; inf when it is blocked."""
    start = (tree.at[node, 0], tree.at[node, 1])
    fraction, last, length = walk(graph, tree.cell[node], start, at)
    return length if fraction == 1.0 and last == cell else np.inf


@njit(cache=True)
def _gap(graph, tree, node, at):  # type: ignore[no-untyped-def]
    """Horizontal distance between a node and a place, metres."""
    return math.hypot(tree.at[node, 0] - at[0], tree.at[node, 1] - at[1]) * graph.cell_size


@njit(cache=True)
def _shortest_via(graph, tree, node, neighbour):  # type: ignore[no-untyped-def]
    """Distance of a node's neighbour by the node's last turn if that sees it, or by a new turn.

    New turns are the corners where sight is lost, those at the node, and the node itself.
    """
    place = (tree.at[neighbour, 0], tree.at[neighbour, 1])
    cell = tree.cell[neighbour]
    best_via = tree.parent[node]
    start = (tree.at[best_via, 0], tree.at[best_via, 1])
    fraction, last, length = walk(graph, tree.cell[best_via], start, place)
    if fraction == 1.0 and last == cell:
        return tree.distance[best_via] + length, best_via
    best = np.inf
    for k in range(9):
        via = node
        if k < 8:
            via = tree.corners[last if k < 4 else tree.cell[node], k % 4]
        if via >= 0 and tree.distance[via] + _gap(graph, tree, via, place) < best:
            length = tree.distance[via] + _sight(graph, tree, via, place, cell)
            if length < best:
                best, best_via = length, via
    return best, best_via


@njit(cache=True)
def _search(graph, tree, stop_cell):  # type: ignore[no-untyped-def]
    """Fill the distances and parents of a tree whose goals are set."""
    goals, distance, parent = tree.goals, tree.distance, tree.parent
    heap = [(0.0, np.int64(goal)) for goal in range(goals)]
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
        turn = parent[node]
        for k in range(13):
            neighbour = _adjacent(graph, tree, tree.cell[node], k)
            if neighbour < 0 or settled[neighbour]:
                continue
            place = (tree.at[neighbour, 0], tree.at[neighbour, 1])
            least = distance[turn] + _gap(graph, tree, turn, place)
            if least >= distance[neighbour] - GAIN_M:
                continue
            length, via = _shortest_via(graph, tree, node, neighbour)
            if length < distance[neighbour] - GAIN_M:
                distance[neighbour], parent[neighbour] = length, via
                heapq.heappush(heap, (length, neighbour))


@njit(cache=True)
def _distance_at(graph, tree, at, cell):  # type: ignore[no-untyped-def]
    """See `distance_at`: the best of the turns around, of those they look to, and of near goals."""
    best, node = np.inf, np.int64(-1)
    for k in range(13):
        around = _adjacent(graph, tree, cell, k)
        if around < 0 or tree.distance[around] == np.inf:
            continue
        for turn in (tree.parent[around], around):
            if tree.distance[turn] + _gap(graph, tree, turn, at) < best - GAIN_M:
                length = tree.distance[turn] + _sight(graph, tree, turn, at, cell)
                if length < best:
                    best, node = length, turn
    for goal in range(tree.goals):
        if _gap(graph, tree, goal, at) < min(NEAR_GOAL_M, best):
            length = _sight(graph, tree, goal, at, cell)
            if length < best:
                best, node = length, np.int64(goal)
    return best, node
