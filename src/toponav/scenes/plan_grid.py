"""A floor plan as a lattice of square cells, each owned by one room or by none.

Importers that start from overlapping boxes work here, where clipping, cleaning and connecting rooms
are set operations on cells, and leave as simple rectilinear polygons.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage
from shapely import Polygon, box, normalize, unary_union

CELL_M = 0.1
"""Side of a cell: about the thickness of an inner wall."""

FREE = -1
"""Owner of a cell that belongs to no room."""

MAX_PLAN_CELLS = 4_000_000
"""200 m x 200 m; a larger plan is a unit mistake."""

_SLIT_CELLS = 2
"""Width of the cut that opens a ring-shaped room, and becomes a wall."""

CellMask = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class PlanGrid:
    """Which room owns each cell.

    Attributes:
        owner: (nx, ny) int32 room keys or `FREE`; the border cells are free. Changed in place.
        origin: World x and y of the outer corner of cell (0, 0), metres.
    """

    owner: NDArray[np.int32]
    origin: tuple[float, float]

    def mask(self, key: int) -> CellMask:
        """(nx, ny) cells of one room."""
        cells: CellMask = self.owner == key
        return cells

    def point(self, i: float, j: float) -> tuple[float, float]:
        """World x, y of lattice corner (i, j), in whole millimetres."""
        return (round(self.origin[0] + i * CELL_M, 3), round(self.origin[1] + j * CELL_M, 3))

    def polygon(self, key: int) -> list[tuple[float, float]]:
        """The corners of one room, counter-clockwise; its cells form one simple polygon."""
        shape = normalize(_outline(self.mask(key)))
        corners = list(shape.exterior.coords)[:-1]
        ring = Polygon(corners).exterior
        if not ring.is_ccw:
            corners.reverse()
        return [self.point(i, j) for i, j in corners]


def _outline(mask: CellMask) -> Polygon:
    """The polygon of a 4-connected mask, in cells."""
    strips = []
    for i in np.flatnonzero(mask.any(axis=1)):
        steps = np.diff(np.concatenate(([0], mask[i].astype(np.int8), [0])))
        starts, ends = np.flatnonzero(steps == 1), np.flatnonzero(steps == -1)
        strips += [box(i, start, i + 1, end) for start, end in zip(starts, ends, strict=True)]
    shape = unary_union(strips).simplify(0.0)
    if not isinstance(shape, Polygon):
        raise ValueError("the cells of a room are not in one piece")
    return shape


def window_sums(mask: CellMask, length: int, width: int) -> NDArray[np.int64]:
    """(nx - length + 1, ny - width + 1) set cells in each window, from a summed-area table."""
    sums = np.pad(mask.astype(np.int64).cumsum(axis=0).cumsum(axis=1), ((1, 0), (1, 0)))
    counts: NDArray[np.int64] = (
        sums[length:, width:]
        - sums[:-length, width:]
        - sums[length:, :-width]
        + sums[:-length, :-width]
    )
    return counts


def square_positions(mask: CellMask, width: int) -> tuple[NDArray[np.int32], int]:
    """Where a square of that width fits into a mask, and which places a moving square can reach.

    Args:
        mask: (nx, ny) cells.
        width: Cells; odd, so that a square has a middle.

    Returns:
        (nx, ny) labels of the squares' middle cells, 0 where none fits; the highest label.
    """
    before = width // 2
    fits = np.pad(window_sums(~mask, width, width) == 0, (before, width - 1 - before))
    labels, count = ndimage.label(fits, np.ones((3, 3)))
    return labels, int(count)


def widest_piece(mask: CellMask, width: int) -> CellMask:
    """What a square of that width sweeps on its way through the mask, in the largest piece of it.

    Of pieces equally large, the first in scan order.
    """
    labels, count = square_positions(mask, width)
    square = np.ones((width, width), np.bool_)
    pieces = [ndimage.binary_dilation(labels == n, square) for n in range(1, count + 1)]
    if not pieces:
        return np.zeros_like(mask)
    return max(pieces, key=lambda piece: int(piece.sum()))


def simple_room(mask: CellMask, others: CellMask, width_cells: int) -> CellMask:
    """The part of a room that is one simple polygon nowhere narrower than `width_cells`.

    Narrow strips go, the largest remaining piece stays, enclosed free cells join the room, and a
    room that surrounds another is cut open towards the nearest side, so that it has no hole.

    Args:
        mask: (nx, ny) cells of the room.
        others: (nx, ny) cells of other rooms.
        width_cells: No part of the result is narrower.
    """
    piece = _without_pinches(widest_piece(mask, width_cells), width_cells)
    while True:
        holes = ndimage.binary_fill_holes(piece) & ~piece
        labels, count = ndimage.label(holes, np.ones((3, 3)))
        surrounded = [labels == n for n in range(1, count + 1)]
        occupied = [hole for hole in surrounded if (hole & others).any()]
        for hole in surrounded:
            if not (hole & others).any():
                piece |= hole
        if not occupied:
            return piece
        piece = widest_piece(_cut_open(piece, occupied[0]), width_cells)
        piece = _without_pinches(piece, width_cells)


def _without_pinches(piece: CellMask, width_cells: int) -> CellMask:
    """Clear cells that touch at a corner only, where an outline would meet itself."""
    while True:
        a, b = piece[:-1, :-1], piece[1:, 1:]
        c, d = piece[:-1, 1:], piece[1:, :-1]
        pinches = (a & b & ~c & ~d) | (c & d & ~a & ~b)
        if not pinches.any():
            return piece
        cleared = piece.copy()
        for di in (0, 1):
            for dj in (0, 1):
                target = cleared[di : di + pinches.shape[0], dj : dj + pinches.shape[1]]
                target &= ~pinches
        piece = widest_piece(cleared, width_cells)


def _cut_open(piece: CellMask, hole: CellMask) -> CellMask:
    """Cut a slit from a hole to the side that is nearest, counted in cells of the room."""
    rows, columns = np.flatnonzero(hole.any(axis=1)), np.flatnonzero(hole.any(axis=0))
    i, j = int(rows[len(rows) // 2]), int(columns[len(columns) // 2])
    half = _SLIT_CELLS // 2
    across_i, across_j = slice(i - half, i + half), slice(j - half, j + half)
    slits = (
        (slice(0, rows[0]), across_j),
        (slice(rows[-1] + 1, None), across_j),
        (across_i, slice(0, columns[0])),
        (across_i, slice(columns[-1] + 1, None)),
    )
    best = min(slits, key=lambda slit: int(piece[slit].sum()))
    cut = piece.copy()
    cut[best] = False
    return cut
