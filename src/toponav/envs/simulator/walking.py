"""Straight walks over navigable cells: what motion, lines of sight and path lengths share."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

STRIDE_M = 0.25
"""Heights along a path are compared at this spacing, a forward step of the protocol: a flight of
stairs then measures what an agent measures that climbs it."""

CORNER_TIE = 1e-9
"""A walk through a point this close to a corner of four cells (in cells) passes the corner."""


@njit(cache=True)
def cell_at(graph, x, y, z, tolerance):  # type: ignore[no-untyped-def]
    """The cell under (x, y), both in columns, whose height is nearest z; -1 if none is close."""
    nx, ny = graph.shape
    best = -1
    if not (0.0 <= x < nx and 0.0 <= y < ny):
        return best
    column = int(x) * ny + int(y)
    for s in range(graph.column_start[column], graph.column_start[column + 1]):
        if abs(graph.z[s] - z) <= tolerance:
            best, tolerance = s, abs(graph.z[s] - z)
    return best


@njit(cache=True)
def diagonal(graph, cell, along_x, along_y):  # type: ignore[no-untyped-def]
    """The diagonal neighbour in directions `along_x` and `along_y` by either way round, or -1."""
    side = graph.links[cell, along_x]
    if side >= 0 and graph.links[side, along_y] >= 0:
        return graph.links[side, along_y]
    side = graph.links[cell, along_y]
    if side >= 0:
        return graph.links[side, along_x]
    return -1


@njit(cache=True)
def walk(graph, cell, start, end):  # type: ignore[no-untyped-def]
    """Walk straight from `start` in a cell to `end` as far as cells are linked.

    Args:
        graph: A `SpanGraph`.
        cell: The cell of `start`.
        start: (x, y) in columns.
        end: (x, y) in columns.

    Returns:
        The fraction of the way that was walked (1 when nothing blocked it), the last cell, and the
        length of the walk over the surface in metres.
    """
    x0, y0 = start
    dx, dy = end[0] - x0, end[1] - y0
    metres = math.hypot(dx, dy) * graph.cell_size
    along_x = 0 if dx > 0.0 else 2
    along_y = 1 if dy > 0.0 else 3
    # Borders still to cross: counted, so that rounding cannot miss one at the very end.
    left_x = abs(math.floor(end[0]) - graph.x[cell])
    left_y = abs(math.floor(end[1]) - graph.y[cell])
    # Fractions of the way at which the walk leaves its cell through a border along x and along y.
    every_x = 1.0 / abs(dx) if left_x else np.inf
    every_y = 1.0 / abs(dy) if left_y else np.inf
    next_x = (graph.x[cell] + (dx > 0.0) - x0) / dx if left_x else np.inf
    next_y = (graph.y[cell] + (dy > 0.0) - y0) / dy if left_y else np.inf
    tie = CORNER_TIE * min(every_x, every_y)
    stride = STRIDE_M / metres if metres > 0.0 else np.inf
    walked, stride_z, length = 0.0, graph.z[cell], 0.0
    reached = 1.0
    while True:
        border = min(next_x, next_y, 1.0)
        while walked + stride < border:
            length += math.hypot(STRIDE_M, graph.z[cell] - stride_z)
            stride_z = graph.z[cell]
            walked += stride
        if not (left_x or left_y):
            break
        if left_x and left_y and abs(next_x - next_y) <= tie:
            target = diagonal(graph, cell, along_x, along_y)
            cross_x, cross_y = 1, 1
        elif next_x < next_y:
            target = graph.links[cell, along_x]
            cross_x, cross_y = 1, 0
        else:
            target = graph.links[cell, along_y]
            cross_x, cross_y = 0, 1
        if target < 0:
            reached = min(max(border, 0.0), 1.0 - CORNER_TIE)
            break
        cell = target
        left_x -= cross_x
        left_y -= cross_y
        next_x = next_x + cross_x * every_x if left_x else np.inf
        next_y = next_y + cross_y * every_y if left_y else np.inf
    length += math.hypot((reached - walked) * metres, graph.z[cell] - stride_z)
    return reached, cell, length
