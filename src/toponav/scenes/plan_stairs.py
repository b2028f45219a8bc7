"""Where a flight of stairs fits between two storeys of a plan.

A flight needs a landing at either end, stays inside the lower room below and inside the upper room
above, where it leaves a hole in the floor, and must not shut any door of the two rooms.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from toponav.scenes.house import Point2
from toponav.scenes.plan_grid import (
    CELL_M,
    FREE,
    CellMask,
    PlanGrid,
    simple_room,
    square_positions,
    window_sums,
)
from toponav.scenes.plan_rooms import NARROWEST_CELLS
from toponav.scenes.plan_routes import SharedWall

PASSAGE_CELLS = 5
"""What is left of a room beside a flight must be this wide to lead anywhere."""

DOOR_CLEARANCE_CELLS = 6
"""No flight or landing lies nearer to the middle of a door than this."""

OPEN_SIDE_COST = 0.2
"""Per cell along a flight's sides that is not a wall: flights run along walls."""

_MAX_CANDIDATES = 200
"""Places that are examined closely, the best first."""


@dataclass(frozen=True)
class FlightShape:
    """Proportions of a flight.

    Attributes:
        slope: Radians; the agent climbs 45 degrees.
        width: Cells across.
        landing: Cells of free floor at either end.
    """

    slope: float
    width: int
    landing: int

    def run_cells(self, rise: float) -> int:
        """Length in plan of a flight of that rise in metres."""
        return math.ceil(rise / math.tan(self.slope) / CELL_M)


FLIGHT_SHAPES = (
    FlightShape(slope=math.radians(36.0), width=10, landing=10),
    FlightShape(slope=math.radians(40.0), width=8, landing=8),
)
"""A comfortable flight, and a tight one where that does not fit."""


@dataclass(frozen=True, eq=False)
class Flight:
    """A place for stairs.

    Attributes:
        start: x, y of the middle of its lower end.
        end: x, y of the middle of its upper end.
        width: Metres across.
        cells: (nx, ny) the flight itself; the upper floor is open above it.
        foot: (nx, ny) the landing on the lower floor.
        head: (nx, ny) the landing on the upper floor.
    """

    start: Point2
    end: Point2
    width: float
    cells: CellMask
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

    @property
    def doors(self) -> list[CellMask]:
        """(nx, ny) floor of the room before each of its openings."""
        room = self.grid.mask(self.key)
        return [cells_around(wall, room.shape) & room for wall in self.walls]

    @property
    def doorways(self) -> CellMask:
        """(nx, ny) floor of the room before any of its openings."""
        doorways = np.zeros_like(self.taken)
        for door in self.doors:
            doorways |= door
        return doorways


def place_flight(lower: StairEnd, upper: StairEnd, rise: float) -> Flight | None:
    """The best place for stairs from one room up to another, or None.

    Args:
        lower: The room at the foot.
        upper: The room at the head.
        rise: From floor to floor, metres.
    """
    for shape in FLIGHT_SHAPES:
        flight = _place(lower, upper, rise, shape)
        if flight is not None:
            return flight
    return None


def _place(lower: StairEnd, upper: StairEnd, rise: float, shape: FlightShape) -> Flight | None:
    candidates = sorted(
        candidate
        for turns in range(4)
        for candidate in _candidates(lower, upper, turns, rise, shape)
    )
    for _, turns, i, j in candidates[:_MAX_CANDIDATES]:
        flight = _flight(lower.grid, turns, (i, j), rise, shape)
        if _leaves_passage(lower, flight.cells, flight.foot) and _leaves_passage(
            upper, flight.cells, flight.head
        ):
            return flight
    return None


def _candidates(
    lower: StairEnd, upper: StairEnd, turns: int, rise: float, shape: FlightShape
) -> Iterator[tuple[float, int, int, int]]:
    """(cost, quarter turns, i, j) of places that fit, climbing along +i of the turned lattice."""
    run, landing = shape.run_cells(rise), shape.landing
    room_below, ground_below, doors_below = (
        np.rot90(mask, turns) for mask in (lower.room, lower.buildable, lower.doorways)
    )
    room_above, ground_above, doors_above = (
        np.rot90(mask, turns) for mask in (upper.room, upper.buildable, upper.doorways)
    )
    count = room_below.shape[0] - (run + 2 * landing) + 1
    if count < 1 or room_below.shape[1] < shape.width + 2:
        return

    def cells(mask: CellMask, offset: int, length: int) -> NDArray[np.int64]:
        """Set cells in the part of the stairs that starts at `offset`, for each place."""
        return window_sums(mask, length, shape.width)[offset : offset + count]

    fits = (
        (cells(~room_below | doors_below, 0, landing) == 0)
        & (cells(~ground_below | doors_below, landing, run) == 0)
        & (cells(~ground_above | doors_above, landing, run) == 0)
        & (cells(~room_above | doors_above, landing + run, landing) == 0)
    )
    built = cells(~room_below, landing, run) + cells(~room_above, landing, run)
    sides = _open_sides(room_below, run, shape.width)[landing : landing + count]
    cost = built + OPEN_SIDE_COST * sides
    for i, j in np.argwhere(fits).tolist():
        yield float(cost[i, j]), turns, i, j


def _open_sides(room: CellMask, length: int, width: int) -> NDArray[np.int64]:
    """Cells of the room along the two long sides of each window."""
    sides = np.pad(window_sums(room, length, 1), ((0, 0), (1, 1)))
    return sides[:, : -width - 1] + sides[:, width + 1 :]


def _flight(
    grid: PlanGrid, turns: int, corner: tuple[int, int], rise: float, shape: FlightShape
) -> Flight:
    run = shape.run_cells(rise)
    size = np.rot90(grid.owner, turns).shape
    i, j = corner
    foot, head = i + shape.landing, i + shape.landing + run

    def cells(begin: int, end: int) -> CellMask:
        mask = np.zeros(size, np.bool_)
        mask[begin:end, j : j + shape.width] = True
        return np.rot90(mask, -turns)

    return Flight(
        start=_center(grid, cells(foot - 1, foot + 1)),
        end=_center(grid, cells(head - 1, head + 1)),
        width=round(shape.width * CELL_M, 3),
        cells=cells(foot, head),
        foot=cells(i, foot),
        head=cells(head, head + shape.landing),
    )


def _center(grid: PlanGrid, cells: CellMask) -> Point2:
    """The middle of some cells in the world."""
    i, j = np.argwhere(cells).mean(axis=0) + 0.5
    return grid.point(float(i), float(j))


def _leaves_passage(end: StairEnd, blocked: CellMask, landing: CellMask) -> bool:
    """Whether the room can take the flight, and its landing still leads to all its openings."""
    room = end.grid.mask(end.key)
    left = room & ~blocked & ~end.taken
    pieces, _ = square_positions(left, PASSAGE_CELLS)
    piece = int(pieces[landing].max())
    if piece == 0 or not all((pieces[door] == piece).any() for door in end.doors):
        return False
    grown = room | blocked
    others = (end.grid.owner != FREE) & ~grown
    return np.array_equal(simple_room(grown, others, NARROWEST_CELLS), grown)


def cells_around(wall: SharedWall, shape: tuple[int, ...]) -> CellMask:
    """The cells near the middle of a shared wall, where its opening is: a mask of that shape."""
    i, j = (round(value) for value in wall.middle)
    reach = DOOR_CLEARANCE_CELLS
    mask = np.zeros(shape, np.bool_)
    mask[max(i - reach, 0) : i + reach, max(j - reach, 0) : j + reach] = True
    return mask
