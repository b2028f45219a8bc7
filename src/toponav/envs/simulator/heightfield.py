"""The walkable floor of a triangle soup: columns of spans, as Recast voxelises a level.

The plane is cut into square columns. Every triangle is clipped to each column that it touches, so
walls and table legs thinner than a column still count. What remains of it there is a solid interval
of heights; overlapping intervals merge into solids, and the top of a solid is a span when it is
flat enough and has enough room above it. A column may hold a span on each storey.

After M. Mononen, Recast (rcRasterizeTriangle, rcFilterLowHangingWalkableObstacles), which Habitat
uses too. Heights are not quantised here.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from toponav.envs.simulator.agent_body import AgentBody
from toponav.errors import SceneError
from toponav.scenes.mesh import SceneMesh

MAX_COLUMNS = 100_000_000
"""More columns than this mean wrong units: 500 m by 500 m at 0.05 m."""

GRID_OFFSET = 0.25
"""Columns are shifted by this fraction of their size: walls often lie on multiples of it, and a
wall on the border of two columns would block both."""

CONTACT_GAP_M = 1e-3
"""Solids closer than this touch."""

HEIGHT_TOLERANCE_M = 1e-4
"""Rounding allowed for in comparisons of heights: a step of exactly `max_climb` can be climbed."""

MIN_FACE_AREA_M2 = 1e-12
"""Smaller triangles have no normal and no extent."""


class Heightfield(NamedTuple):
    """Spans where an agent's foot can stand, ordered by column, then by height.

    Attributes:
        origin: (2,) world x and y of the corner of column (0, 0), metres.
        shape: Columns along x and along y.
        column_start: (nx * ny + 1,) int64; column x * ny + y holds spans
            `column_start[c]:column_start[c + 1]`.
        z: (S,) height of the surface at the column's centre, metres.
        ceiling: (S,) height of the next solid above, metres; inf under the open sky.
    """

    origin: NDArray[np.float64]
    shape: tuple[int, int]
    column_start: NDArray[np.int64]
    z: NDArray[np.float64]
    ceiling: NDArray[np.float64]


class _Pieces(NamedTuple):
    """Triangles clipped to columns, P pieces.

    Attributes:
        column: (P,) int64.
        extent: (P, 3) lowest and highest z of the piece, and that of a foot at the column's centre.
        flat: (P,) bool, whether the triangle is flat enough to stand on.
    """

    column: NDArray[np.int64]
    extent: NDArray[np.float64]
    flat: NDArray[np.bool_]


def build_heightfield(mesh: SceneMesh, body: AgentBody) -> Heightfield:
    """Find every span of a mesh on which a body has a flat enough floor and enough headroom.

    The orientation of triangles is ignored: scanned and exported meshes are often wrong about it.

    Raises:
        SceneError: The mesh has no triangles, or is too large for the cell size.
    """
    if not len(mesh.faces):
        raise SceneError("the scene has no triangles: there is no floor to move on")
    corners = np.asarray(mesh.vertices, dtype=np.float64)[mesh.faces]
    if not np.isfinite(corners).all():
        raise SceneError("the scene has vertices that are NaN or infinite: export the mesh again")
    lower, upper = corners[..., :2].min(axis=(0, 1)), corners[..., :2].max(axis=(0, 1))
    origin = lower - (1.0 + GRID_OFFSET) * body.cell_size
    columns = np.ceil((upper - origin) / body.cell_size) + 1.0
    if columns.prod() > MAX_COLUMNS:
        raise SceneError(
            f"the scene measures {upper[0] - lower[0]:.0f} by {upper[1] - lower[1]:.0f} m, too "
            f"much for columns of {body.cell_size} m: check its units, or use a larger cell_size"
        )
    nx, ny = int(columns[0]), int(columns[1])
    corners[..., :2] = (corners[..., :2] - origin) / body.cell_size
    max_gradient = math.tan(math.radians(body.max_slope_deg)) * body.cell_size
    min_area = MIN_FACE_AREA_M2 / body.cell_size**2
    pieces = _Pieces(*_clip_to_columns(corners, ny, max_gradient, min_area))
    start, order = _sort_by_column(pieces.column, pieces.extent, nx * ny)
    z, ceiling, per_column = _merge(pieces, start, order, body.height, body.max_climb)
    column_start = np.concatenate([np.zeros(1, np.int64), np.cumsum(per_column)])
    return Heightfield(origin, (nx, ny), column_start, z, ceiling)


@njit(cache=True)
def _overlap(start, end, slab):  # type: ignore[no-untyped-def]
    """The part of an edge inside slab..slab + 1, as fractions of it; empty when first > last."""
    if start == end:
        return (0.0, 1.0) if slab <= start <= slab + 1.0 else (1.0, 0.0)
    a = (slab - start) / (end - start)
    b = (slab + 1.0 - start) / (end - start)
    return max(min(a, b), 0.0), min(max(a, b), 1.0)


@njit(cache=True)
def _cut_row(triangle, y, row):  # type: ignore[no-untyped-def]
    """Write the corners of a triangle's part in row y..y + 1, in order; returns their number."""
    count = 0
    for i in range(3):
        start, end = triangle[i], triangle[(i + 1) % 3]
        first, last = _overlap(start[1], end[1], y)
        if first <= last:
            for k in range(3):
                row[count, k] = start[k] + first * (end[k] - start[k])
                row[count + 1, k] = start[k] + last * (end[k] - start[k])
            count += 2
    return count


@njit(cache=True)
def _heights(row, count, x):  # type: ignore[no-untyped-def]
    """Lowest and highest z of a convex polygon's part in column x..x + 1: both are on its edges."""
    lowest, highest = np.inf, -np.inf
    for i in range(count):
        start, end = row[i], row[(i + 1) % count]
        first, last = _overlap(start[0], end[0], x)
        if first <= last:
            a = start[2] + first * (end[2] - start[2])
            b = start[2] + last * (end[2] - start[2])
            lowest = min(lowest, a, b)
            highest = max(highest, a, b)
    return lowest, highest


@njit(cache=True)
def _cells(low, high):  # type: ignore[no-untyped-def]
    """First and last cell that an interval overlaps; a border that it only touches is left out."""
    first = math.floor(low)
    return first, max(first, math.ceil(high) - 1)


@njit(cache=True)
def _clip_to_columns(corners, ny, max_gradient, min_area):  # type: ignore[no-untyped-def]
    """Clip triangles to columns.

    Args:
        corners: (F, 3, 3); x and y in columns, z in metres.
        ny: Columns along y.
        max_gradient: Steepest rise of a flat triangle, metres a column.
        min_area: Triangles smaller than this (columns times metres) are left out.

    Returns:
        The fields of `_Pieces`.
    """
    capacity = 4 * corners.shape[0] + 1024
    column = np.empty(capacity, np.int64)
    extent = np.empty((capacity, 3), np.float64)
    flat = np.empty(capacity, np.bool_)
    count = 0
    row = np.empty((6, 3), np.float64)
    for f in range(corners.shape[0]):
        a = corners[f, 0]
        normal = np.cross(corners[f, 1] - a, corners[f, 2] - a)
        tilt = math.hypot(normal[0], normal[1])
        if max(tilt, abs(normal[2])) < min_area:
            continue
        is_flat = tilt <= max_gradient * abs(normal[2])
        y_first, y_last = _cells(corners[f, :, 1].min(), corners[f, :, 1].max())
        for y in range(y_first, y_last + 1):
            n = _cut_row(corners[f], y, row)
            if n == 0:
                continue
            x_first, x_last = _cells(row[:n, 0].min(), row[:n, 0].max())
            for x in range(x_first, x_last + 1):
                lowest, highest = _heights(row, n, x)
                if lowest > highest:
                    continue
                if count == len(column):
                    column = np.concatenate((column, np.empty_like(column)))
                    extent = np.concatenate((extent, np.empty_like(extent)))
                    flat = np.concatenate((flat, np.empty_like(flat)))
                column[count] = x * ny + y
                extent[count, 0] = lowest
                extent[count, 1] = highest
                extent[count, 2] = highest
                if is_flat:
                    rise = normal[0] * (x + 0.5 - a[0]) + normal[1] * (y + 0.5 - a[1])
                    extent[count, 2] = a[2] - rise / normal[2]
                flat[count] = is_flat
                count += 1
    return column[:count], extent[:count], flat[:count]


@njit(cache=True)
def _sort_by_column(column, extent, columns):  # type: ignore[no-untyped-def]
    """Order pieces by column, then from low to high.

    Returns:
        (columns + 1,) where each column starts in the order, and (P,) the order.
    """
    start = np.zeros(columns + 1, np.int64)
    for c in column:
        start[c + 1] += 1
    for c in range(columns):
        start[c + 1] += start[c]
    filled = np.zeros(columns, np.int64)
    order = np.empty(len(column), np.int64)
    for p in range(len(column)):
        c = column[p]
        slot = start[c] + filled[c]
        while slot > start[c] and extent[order[slot - 1], 0] > extent[p, 0]:
            order[slot] = order[slot - 1]
            slot -= 1
        order[slot] = p
        filled[c] += 1
    return start, order


@njit(cache=True)
def _merge(pieces, start, order, headroom, max_climb):  # type: ignore[no-untyped-def]
    """Merge pieces into solids and keep the tops on which a body of that height can stand.

    The top of a solid can be stood on when a flat piece lies in reach below it: a kerb, or a ball
    on the floor, is climbed; a table leg is not.

    Returns:
        (S,) heights, (S,) ceilings, and the number of spans in each column.
    """
    columns = len(start) - 1
    z = np.empty(len(order), np.float64)
    ceiling = np.empty(len(order), np.float64)
    per_column = np.zeros(columns, np.int64)
    count = 0
    climb = max_climb + HEIGHT_TOLERANCE_M
    headroom -= HEIGHT_TOLERANCE_M
    for c in range(columns):
        top, foot, flat_top = -np.inf, -np.inf, -np.inf
        for k in range(start[c], start[c + 1] + 1):
            is_end = k == start[c + 1]
            lowest = np.inf if is_end else pieces.extent[order[k], 0]
            is_open = lowest > top + CONTACT_GAP_M and lowest - foot >= headroom
            if is_open and top - flat_top <= climb:
                z[count], ceiling[count] = foot, lowest
                per_column[c] += 1
                count += 1
            if is_end:
                continue
            piece_top, piece_foot = pieces.extent[order[k], 1], pieces.extent[order[k], 2]
            is_flat = pieces.flat[order[k]]
            if piece_top > top or (piece_top == top and is_flat):
                top, foot = piece_top, piece_foot
            if is_flat:
                flat_top = max(flat_top, piece_top)
    return z[:count], ceiling[:count], per_column
