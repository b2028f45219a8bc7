"""Where a flight of stairs fits between two storeys of a plan.

A flight needs a landing at either end, stays inside the lower room below and inside the upper room
above, where it leaves a hole in the floor, and must not shut any door of the two rooms.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from toponav.scenes.house import Point2
from toponav.scenes.plan_grid import CELL_M, FREE, CellMask, PlanGrid, simple_room
from toponav.scenes.plan_rooms import NARROWEST_CELLS
from toponav.scenes.plan_routes import SharedWall

_Scalar = TypeVar("_Scalar", bound=np.generic)

SLOPE_RAD = math.radians(36.0)
"""Slope of a flight: steep for a dwelling's, and within the agent's 45 degrees."""

WIDTH_CELLS = 10
"""Width of a flight."""

LANDING_CELLS = 10
"""Depth of the free floor at either end."""

HEADROOM_M = 2.4
"""The upper floor is open where the flight comes nearer to it than this, slab included."""

PASSAGE_CELLS = 5
"""What is left of a room beside a flight must be this wide to lead anywhere."""

DOOR_CLEARANCE_CELLS = 6
"""No flight or landing lies nearer to the middle of a door than this."""

OPEN_SIDE_COST = 0.2
"""Per cell along a flight's sides that is not a wall: flights run along walls."""

_MAX_CANDIDATES = 400
"""Places that are examined closely, the best first."""


@dataclass(frozen=True, eq=False)
class Flight:
    """A place for stairs.

    Attributes:
        start: x, y of the middle of its lower end.
        end: x, y of the middle of its upper end.
        cells: (nx, ny) the flight itself.
        hole: (nx, ny) the part of it above which the upper floor is open.
        foot: (nx, ny) the landing on the lower floor.
        head: (nx, ny) the landing on the upper floor.
    """

    start: Point2
    end: Point2
    cells: CellMask
    hole: CellMask
    foot: CellMask
    head: CellMask


@dataclass(frozen=True, eq=False)
class StairEnd:
    """The room at one end of a flight.

    Attributes:
        grid: Plan of its storey; both storeys share one lattice.
        key: The room.
        walls: Where its openings are.
        taken: (nx, ny) cells of other flights and their landings.
    """

    grid: PlanGrid
    key: int
    walls: Sequence[SharedWall]
    taken: CellMask

    @property
    def room(self) -> CellMask:
        """(nx, ny) floor of the room that is not taken."""
        return self.grid.mask(self.key) & ~self.taken

    @property
    def buildable(self) -> CellMask:
        """(nx, ny) floor of the room and free ground beside it."""
        free: CellMask = (self.grid.owner == FREE) & ~self.taken
        return self.room | free


def place_flight(lower: StairEnd, upper: StairEnd, rise: float) -> Flight | None:
    """The best place for stairs from one room up to another, or None.

    Args:
        lower: The room at the foot.
        upper: The room at the head.
        rise: From floor to floor, metres.
    """
    candidates = sorted(
        (candidate for turns in range(4) for candidate in _candidates(lower, upper, turns, rise)),
        key=lambda candidate: candidate[:4],
    )
    for _, turns, i, j in candidates[:_MAX_CANDIDATES]:
        flight = _flight(lower.grid, turns, (i, j), rise)
        if _leaves_passage(lower, flight.cells, flight.foot) and _leaves_passage(
            upper, flight.hole, flight.head
        ):
            return flight
    return None


def _run_cells(rise: float) -> int:
    return math.ceil(rise / math.tan(SLOPE_RAD) / CELL_M)


def _hole_cells(rise: float) -> int:
    """How much of the flight, from its upper end, needs an open floor above."""
    return min(_run_cells(rise), math.ceil(HEADROOM_M / math.tan(SLOPE_RAD) / CELL_M))


def _candidates(
    lower: StairEnd, upper: StairEnd, turns: int, rise: float
) -> Iterator[tuple[float, int, int, int]]:
    """(cost, quarter turns, i, j) of places that fit, climbing along +i of the turned lattice."""
    run, hole, landing = _run_cells(rise), _hole_cells(rise), LANDING_CELLS
    turned = [
        np.rot90(mask, turns) for mask in (lower.room, lower.buildable, upper.room, upper.buildable)
    ]
    if turned[0].shape[0] < run + 2 * landing or turned[0].shape[1] < WIDTH_CELLS:
        return
    total = turned[0].shape[0] - (run + 2 * landing) + 1

    def at(values: NDArray[_Scalar], offset: int) -> NDArray[_Scalar]:
        return values[offset : offset + total]

    fits = (
        at(_all_in_window(turned[0], landing), 0)
        & at(_all_in_window(turned[1], run), landing)
        & at(_all_in_window(turned[3], hole), landing + run - hole)
        & at(_all_in_window(turned[2], landing), landing + run)
    )
    built = at(_count_in_window(~turned[0], run, WIDTH_CELLS), landing) + at(
        _count_in_window(~turned[2], hole, WIDTH_CELLS), landing + run - hole
    )
    sides = at(_open_sides(turned[0], run), landing)
    cost = built + OPEN_SIDE_COST * sides
    for i, j in np.argwhere(fits).tolist():
        yield float(cost[i, j]), turns, i, j


def _all_in_window(mask: CellMask, length: int) -> CellMask:
    result: CellMask = _count_in_window(mask, length, WIDTH_CELLS) == length * WIDTH_CELLS
    return result


def _count_in_window(mask: CellMask, length: int, width: int) -> NDArray[np.int64]:
    """(nx - length + 1, ny - width + 1) set cells in each window, from a summed-area table."""
    sums = np.pad(mask.astype(np.int64).cumsum(axis=0).cumsum(axis=1), ((1, 0), (1, 0)))
    counts: NDArray[np.int64] = (
        sums[length:, width:]
        - sums[:-length, width:]
        - sums[length:, :-width]
        + sums[:-length, :-width]
    )
    return counts


def _open_sides(room: CellMask, length: int) -> NDArray[np.int64]:
    """Cells of the room along the two long sides of each window."""
    sides = np.pad(_count_in_window(room, length, 1), ((0, 0), (1, 1)))
    return sides[:, : -WIDTH_CELLS - 1] + sides[:, WIDTH_CELLS + 1 :]


def _flight(grid: PlanGrid, turns: int, corner: tuple[int, int], rise: float) -> Flight:
    run, hole = _run_cells(rise), _hole_cells(rise)
    shape = np.rot90(grid.owner, turns).shape
    i, j = corner
    across = slice(j, j + WIDTH_CELLS)
    foot, head = i + LANDING_CELLS, i + LANDING_CELLS + run

    def cells(begin: int, end: int) -> CellMask:
        mask = np.zeros(shape, np.bool_)
        mask[begin:end, across] = True
        return np.rot90(mask, -turns)

    return Flight(
        start=_center(grid, cells(foot - 1, foot + 1)),
        end=_center(grid, cells(head - 1, head + 1)),
        cells=cells(foot, head),
        hole=cells(head - hole, head),
        foot=cells(i, foot),
        head=cells(head, head + LANDING_CELLS),
    )


def _center(grid: PlanGrid, cells: CellMask) -> Point2:
    """The middle of some cells in the world."""
    i, j = np.argwhere(cells).mean(axis=0) + 0.5
    return grid.point(float(i), float(j))


def _leaves_passage(end: StairEnd, blocked: CellMask, landing: CellMask) -> bool:
    """Whether the room can take the flight, and its landing still leads to all its openings."""
    room = end.grid.mask(end.key)
    grown = room | blocked
    others = (end.grid.owner != FREE) & ~grown
    if not np.array_equal(simple_room(grown, others, NARROWEST_CELLS), grown):
        return False
    doors = [_around(wall, room.shape) & room for wall in end.walls]
    if any((door & (blocked | landing)).any() for door in doors):
        return False
    left = room & ~blocked & ~end.taken
    walked = ndimage.binary_opening(left, np.ones((PASSAGE_CELLS, PASSAGE_CELLS), np.bool_))
    pieces, _ = ndimage.label(walked)
    piece = int(pieces[landing].max())
    return piece > 0 and all((pieces[door] == piece).any() for door in doors)


def _around(wall: SharedWall, shape: tuple[int, ...]) -> CellMask:
    """The cells near the middle of a shared wall, where its opening is."""
    i, j = (round(value) for value in wall.middle)
    reach = DOOR_CLEARANCE_CELLS
    mask = np.zeros(shape, np.bool_)
    mask[max(i - reach, 0) : i + reach, max(j - reach, 0) : j + reach] = True
    return mask
