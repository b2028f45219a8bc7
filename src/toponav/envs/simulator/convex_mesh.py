"""The navigable cells as few convex polygons that cover the same floor: what a navmesh holds.

Cells of one height form patches. The outline of a patch, with the places where another begins, is
triangulated (constrained Delaunay), and triangles are joined as long as they stay convex.
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from shapely.geometry import Polygon

from toponav.envs.simulator.span_graph import SpanGraph

PATCH_STEP_M = 0.02
"""Neighbouring cells that differ by more in height belong to different patches."""

MAX_CORNERS = 6
"""Of a polygon: what Detour holds."""

WALL = -1

Corner = tuple[int, int]
"""A corner of the grid, in columns."""

Edge = tuple[Corner, Corner]

# The side of a cell towards +x, +y, -x, -y, with the cell on its left.
_SIDES = (((1, 0), (1, 1)), ((1, 1), (0, 1)), ((0, 1), (0, 0)), ((0, 0), (1, 0)))


@dataclass(frozen=True, eq=False)
class ConvexMesh:
    """Convex polygons that meet along whole edges.

    Attributes:
        vertices: (V, 3) metres, z up.
        polygons: Vertices of each polygon, counter-clockwise seen from above.
        neighbours: Polygon across each edge, from a vertex to the next; WALL where there is none.
    """

    vertices: NDArray[np.float64]
    polygons: tuple[tuple[int, ...], ...]
    neighbours: tuple[tuple[int, ...], ...]


def convex_mesh(graph: SpanGraph) -> ConvexMesh:
    """Cover the cells of a graph."""
    patch = _patches(graph)
    outlines, across = _outlines(graph, patch)
    heights = _heights(graph, patch)
    vertices: list[tuple[float, float, float]] = []
    polygons: list[tuple[int, ...]] = []
    edges: dict[tuple[int, Edge], int] = {}
    corners: list[tuple[int, tuple[Corner, ...]]] = []
    for number in sorted(outlines):
        index: dict[Corner, int] = {}
        for shape in _joined(_triangles(outlines[number], across, number)):
            for corner in shape:
                if corner not in index:
                    index[corner] = len(vertices)
                    x, y = graph.origin + np.array(corner) * graph.cell_size
                    vertices.append((float(x), float(y), heights[number, corner]))
            for edge in _edges(shape):
                edges[number, edge] = len(polygons)
            polygons.append(tuple(index[corner] for corner in shape))
            corners.append((number, shape))
    neighbours = tuple(
        tuple(_beyond(edges, across, number, edge) for edge in _edges(shape))
        for number, shape in corners
    )
    return ConvexMesh(np.array(vertices).reshape(-1, 3), tuple(polygons), neighbours)


def _patches(graph: SpanGraph) -> NDArray[np.int64]:
    """(S,) patch of each cell: linked cells of about one height."""
    cell, direction = np.nonzero(graph.links >= 0)
    other = graph.links[cell, direction]
    level = np.abs(graph.z[cell] - graph.z[other]) <= PATCH_STEP_M
    ones = np.ones(int(level.sum()), np.int8)
    shape = (len(graph.z), len(graph.z))
    matrix = coo_array((ones, (cell[level], other[level])), shape=shape)
    patch: NDArray[np.int64] = connected_components(matrix, directed=False)[1].astype(np.int64)
    return patch


def _outlines(
    graph: SpanGraph, patch: NDArray[np.int64]
) -> tuple[dict[int, set[Edge]], dict[tuple[int, Edge], int]]:
    """The unit edges around each patch, the patch on their left, and the patch across each."""
    outlines: dict[int, set[Edge]] = defaultdict(set)
    across: dict[tuple[int, Edge], int] = {}
    beyond = np.where(graph.links >= 0, patch[graph.links], WALL)
    for cell, direction in np.argwhere(beyond != patch[:, None]):
        (ax, ay), (bx, by) = _SIDES[direction]
        x, y = int(graph.x[cell]), int(graph.y[cell])
        edge = ((x + ax, y + ay), (x + bx, y + by))
        number = int(patch[cell])
        back = (edge[1], edge[0])
        if back in outlines[number]:  # two cells of the patch without a link lie side by side
            outlines[number].discard(back)
            del across[number, back]
            continue
        outlines[number].add(edge)
        across[number, edge] = int(beyond[cell, direction])
    return outlines, across


def _heights(graph: SpanGraph, patch: NDArray[np.int64]) -> dict[tuple[int, Corner], float]:
    """The mean height of a patch's cells around each corner that one of them has."""
    around: dict[tuple[int, Corner], list[float]] = defaultdict(list)
    rim = np.flatnonzero((np.where(graph.links >= 0, patch[graph.links], WALL)
                          != patch[:, None]).any(axis=1))  # fmt: skip
    # A corner of an outline may belong to a cell that only touches it diagonally.
    near = np.unique(np.concatenate([rim, graph.links[rim].reshape(-1)]))
    for cell in near[near >= 0]:
        x, y = int(graph.x[cell]), int(graph.y[cell])
        for dx, dy in ((0, 0), (1, 0), (0, 1), (1, 1)):
            around[int(patch[cell]), (x + dx, y + dy)].append(float(graph.z[cell]))
    return {key: sum(values) / len(values) for key, values in around.items()}


def _triangles(
    outline: set[Edge], across: dict[tuple[int, Edge], int], number: int
) -> list[tuple[Corner, ...]]:
    """Counter-clockwise triangles over one patch, whose vertices are those of its rings."""
    outer: list[list[Corner]] = []
    holes: list[list[Corner]] = []
    for ring in _rings(outline):
        kept = _kept(ring, across, number)
        (outer if _signed_area(kept) > 0 else holes).append(kept)
    shells = [Polygon(ring) for ring in outer]
    inside: list[list[list[Corner]]] = [[] for _ in shells]
    for hole in holes:
        place = shapely.Polygon(hole).representative_point()
        owner = min(
            (k for k, shell in enumerate(shells) if shell.contains(place)),
            key=lambda k: shells[k].area,
        )
        inside[owner].append(hole)
    found = []
    for ring, within in zip(outer, inside, strict=True):
        parts = shapely.get_parts(shapely.constrained_delaunay_triangles(Polygon(ring, within)))
        for part in parts:
            corners = [(round(x), round(y)) for x, y in shapely.get_coordinates(part)[:3]]
            area = _signed_area(corners)
            if area:
                found.append(tuple(corners if area > 0 else corners[::-1]))
    return found


def _rings(outline: set[Edge]) -> list[list[Corner]]:
    """Closed chains of unit edges; where two meet in a corner, each keeps to its own obstacle."""
    leaving: dict[Corner, list[Corner]] = defaultdict(list)
    for start, end in sorted(outline):
        leaving[start].append(end)
    rings = []
    for first in sorted(leaving):
        while leaving[first]:
            ring, here, ahead = [first], first, leaving[first].pop()
            while ahead != first or (leaving[ahead] and _turns_right(here, ahead, leaving[ahead])):
                ring.append(ahead)
                here, ahead = ahead, _next(leaving[ahead], here, ahead)
            rings.append(ring)
    return rings


def _turns_right(here: Corner, ahead: Corner, choices: list[Corner]) -> bool:
    """Whether one of the ways on from a ring's first corner is the right turn: not closed yet."""
    return any(_turn(here, ahead, choice) < 0 for choice in choices)


def _next(choices: list[Corner], here: Corner, ahead: Corner) -> Corner:
    """Take the way on that turns right most."""
    choice = min(choices, key=lambda corner: _turn(here, ahead, corner))
    choices.remove(choice)
    return choice


def _turn(a: Corner, b: Corner, c: Corner) -> int:
    """Twice the signed area of a, b, c: positive for a left turn."""
    return (b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0])


def _kept(ring: list[Corner], across: dict[tuple[int, Edge], int], number: int) -> list[Corner]:
    """The ring's vertices: where it turns, and where another patch begins on the other side."""
    kept = []
    for k, corner in enumerate(ring):
        before, after = ring[k - 1], ring[(k + 1) % len(ring)]
        changes = across[number, (before, corner)] != across[number, (corner, after)]
        if changes or _turn(before, corner, after):
            kept.append(corner)
    return kept


def _signed_area(corners: list[Corner]) -> int:
    """Twice the area; positive when counter-clockwise."""
    return sum(
        a[0] * b[1] - a[1] * b[0] for a, b in zip(corners, corners[1:] + corners[:1], strict=True)
    )


def _edges(shape: tuple[Corner, ...]) -> list[Edge]:
    return list(zip(shape, shape[1:] + shape[:1], strict=True))


def _joined(triangles: list[tuple[Corner, ...]]) -> list[tuple[Corner, ...]]:
    """Join polygons across their longest edges while they stay convex and small enough."""
    shapes = dict(enumerate(triangles))
    owner = {edge: k for k, shape in shapes.items() for edge in _edges(shape)}
    inner = [edge for edge in owner if edge < (edge[1], edge[0]) and (edge[1], edge[0]) in owner]
    inner.sort(key=lambda e: (-((e[0][0] - e[1][0]) ** 2 + (e[0][1] - e[1][1]) ** 2), e))
    for edge in inner:
        here, there = owner[edge], owner[edge[1], edge[0]]
        if here == there:
            continue
        merged = _union(shapes[here], shapes[there], edge)
        if merged is None:
            continue
        del owner[edge], owner[edge[1], edge[0]], shapes[there]
        shapes[here] = merged
        for side in _edges(merged):
            owner[side] = here
    return list(shapes.values())


def _union(a: tuple[Corner, ...], b: tuple[Corner, ...], edge: Edge) -> tuple[Corner, ...] | None:
    """Two polygons joined across an edge of `a`; None when that is too large or not convex."""
    if len(a) + len(b) - 2 > MAX_CORNERS:
        return None
    i, j = a.index(edge[1]), b.index(edge[0])
    merged = a[i:] + a[:i] + (b[j:] + b[:j])[1:-1]
    turns = zip(merged[-1:] + merged[:-1], merged, merged[1:] + merged[:1], strict=True)
    return merged if all(_turn(*corners) >= 0 for corners in turns) else None


def _beyond(
    edges: dict[tuple[int, Edge], int], across: dict[tuple[int, Edge], int], number: int, edge: Edge
) -> int:
    """The polygon on the other side of an edge."""
    back = (edge[1], edge[0])
    inner = edges.get((number, back))
    if inner is not None:
        return inner
    (ax, ay), (bx, by) = edge
    step = (int(np.sign(bx - ax)), int(np.sign(by - ay)))
    other = across.get((number, (edge[0], (ax + step[0], ay + step[1]))), WALL)
    return edges.get((other, back), WALL)
