"""Flights of stairs told by their shape, where no detector names them.

Detectors of common objects know no stairs, and a mask that knows them leaves treads out. Treads
rise from each other at even heights, one step at a time, in one direction and as wide as a person:
nothing else in a building does.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation, label

CELL_M = 0.1
"""Edge of the cells whose highest points are compared."""

BAND_M = (-3.0, 2.0)
"""Heights about the agent's floor that are looked at: a storey down, and up to below ceilings."""

FLAT_M = 0.08
"""Nearer to the floor's height than this is floor."""

RISERS_M = (0.12, 0.22)
"""Heights of a step that people climb."""

WINDOW_MARGIN_M = 1.5
"""What lies so near to what a frame has changed is looked at with it."""

STEP_REACH = 4
"""The next tread is no more cells away than this."""

LEAST_CELLS = 25
"""Cells of treads that make a flight."""

LEAST_RISE_M = 0.45
"""Treads that make a flight rise by this: four of them."""

LEAST_WIDTH_M = 0.55
"""A flight is no narrower; shelves, drawers and the arms of chairs are."""

SLOPES = (0.45, 1.1)
"""Height of a flight for each metre of its length."""

OFF_PLANE_M = 0.15
"""Treads are no farther from the plane through all of them: a step is on both sides of it."""

LEAST_FITTING = 0.7
"""Share of the cells that the plane must pass this near."""

LEAST_EVENNESS = 0.6
"""How well heights agree with equal steps, from 0 for any heights to 1 for steps without error."""

LEAST_FILLED = 0.6
"""Share of its cells, in plan, of which a tread must have been seen."""

GROWTH_M = 0.6
"""A known flight goes on where treads are seen this near to its end, two steps further: who comes
down it does not see the next one."""

GROWTH_CELLS = 4
"""In so many columns of cells across the flight."""

NEWS_M = 0.05
"""An end or side that has moved by less is where it was: news costs a look at the whole map."""

WALL_M = 1.7
"""Treads are sought below this height over the floor: what reaches higher is more likely a wall."""

BELOW_M = 1.0
"""What is this far under the line of the treads is part of the flight: its sides, what bears it."""


class Flight(NamedTuple):
    """A straight flight.

    Attributes:
        middle: (x, y, z) on the plane through its treads, metres.
        uphill: (x, y) unit vector.
        slope: Height for each metre of length.
        along: Least and greatest distance uphill from the middle, metres.
        across: The same to the left.
        riser: Height of a step, metres.
    """

    middle: tuple[float, float, float]
    uphill: tuple[float, float]
    slope: float
    along: tuple[float, float]
    across: tuple[float, float]
    riser: float


class FlightFinder:
    """Watches the highest points over the floor for flights.

    Heights only rise and a flight stays one: what has been seen to go leaves the map, not this.
    """

    def __init__(self) -> None:
        """Know of none."""
        self._tops: dict[int, _Tops] = {}
        self._flights: list[Flight] = []

    @property
    def has_flights(self) -> bool:
        """Whether any is known."""
        return bool(self._flights)

    @property
    def nbytes(self) -> int:
        """Memory held, bytes."""
        return sum(tops.heights.nbytes for tops in self._tops.values())

    def look(self, floor: int, floor_z: float, points: NDArray[np.float32]) -> bool:
        """Take the points that a frame has moved; returns whether a flight was found or has grown.

        Args:
            floor: Index of the floor on which the agent is.
            floor_z: Its height, metres.
            points: (N, 3) voxels of M_scene that the frame touched, world frame, metres.
        """
        tops = self._tops.setdefault(floor, _Tops())
        box = tops.add(points, floor_z)
        if box is None:
            return False
        cells, corner = tops.window(box)
        treads = _treads(cells, (FLAT_M, WALL_M), RISERS_M, STEP_REACH)
        if np.count_nonzero(treads) < LEAST_CELLS:
            return False
        around = np.ones((3, 3))
        parts, count = label(binary_dilation(treads, around), around)  # over gaps of two cells
        parts[~treads] = 0
        sizes = np.bincount(parts.ravel(), minlength=count + 1)[1:]
        news = False
        for part in np.flatnonzero(sizes >= LEAST_CELLS) + 1:
            at = np.argwhere(parts == part)
            heights = floor_z + cells[at[:, 0], at[:, 1]].astype(np.float64)
            centers = np.asarray((at + corner + 0.5) * CELL_M, np.float64)
            flight = _fit(centers, heights)
            news |= flight is not None and self._note(flight)
        return news

    def grow(self, points: NDArray[np.float32]) -> bool:
        """Let the flights go on where the treads of a frame do; returns whether one has.

        Args:
            points: (N, 3) as for `look`.
        """
        grown = False
        for k, flight in enumerate(self._flights):
            along = _grown(flight, points)
            if np.abs(np.subtract(along, flight.along)).max() >= NEWS_M:
                self._flights[k] = flight._replace(along=along)
                grown = True
        return grown

    def inside(self, points: NDArray[np.float32]) -> NDArray[np.bool_]:
        """(N,) which of (N, 3) points belong to a flight."""
        found = np.zeros(len(points), np.bool_)
        for flight in self._flights:
            _add_inside(found, flight, points)
        return found

    def _note(self, flight: Flight) -> bool:
        """Keep a flight, or widen the one of which it is a part; returns whether that is news."""
        for k, known in enumerate(self._flights):
            joined = _joined(known, flight)
            if joined is not None:
                ends = np.subtract((*joined.along, *joined.across), (*known.along, *known.across))
                news = bool((np.abs(ends) >= NEWS_M).any())
                self._flights[k] = joined if news else known
                return news
        self._flights.append(flight)
        return True


class _Tops:
    """The highest point in every cell of a floor, between two heights over it; NaN without any."""

    def __init__(self) -> None:
        self.heights = np.full((0, 0), np.nan, np.float32)
        self._first = np.zeros(2, np.int64)

    def add(
        self, points: NDArray[np.float32], floor_z: float
    ) -> tuple[NDArray[np.int64], NDArray[np.int64]] | None:
        """Raise the heights; returns the least and greatest cell that changed and is no floor."""
        low, high = _extent(points, floor_z, BAND_M)
        if low[0] > high[0]:
            return None
        self._cover(low, high)
        changed = _raise(self.heights, self._first, points, floor_z, BAND_M, FLAT_M)
        return None if changed[0, 0] > changed[1, 0] else (changed[0], changed[1])

    def window(
        self, box: tuple[NDArray[np.int64], NDArray[np.int64]]
    ) -> tuple[NDArray[np.float32], NDArray[np.int64]]:
        """The heights in a box with a margin of a flight's width, and the cell of its corner."""
        margin = round(WINDOW_MARGIN_M / CELL_M)
        low = np.maximum(box[0] - margin - self._first, 0)
        high = np.minimum(box[1] + margin + 1 - self._first, self.heights.shape)
        return self.heights[low[0] : high[0], low[1] : high[1]], low + self._first

    def _cover(self, low: NDArray[np.int64], high: NDArray[np.int64]) -> None:
        """Grow until cells `low` to `high`, inclusive, are there."""
        end = self._first + self.heights.shape
        if self.heights.size and (low >= self._first).all() and (high < end).all():
            return
        first, end = (self._first, end) if self.heights.size else (low, low)
        margin = 64
        new_first = np.where(low < first, low - margin, first)
        shape = np.where(high >= end, high + 1 + margin, end) - new_first
        grown = np.full(tuple(shape), np.nan, np.float32)
        i, j = first - new_first
        grown[i : i + self.heights.shape[0], j : j + self.heights.shape[1]] = self.heights
        self.heights, self._first = grown, new_first


def _fit(xy: NDArray[np.float64], z: NDArray[np.float64]) -> Flight | None:
    """The flight of (N, 2) cells at (N,) heights, metres; None if they are none."""
    middle = xy.mean(axis=0)
    design = np.column_stack([xy - middle, np.ones(len(xy))])
    fitting = np.ones(len(xy), np.bool_)
    for _ in range(3):
        (a, b, height), *_ = np.linalg.lstsq(design[fitting], z[fitting], rcond=None)
        off = z - design @ (a, b, height)
        fitting = np.abs(off) < OFF_PLANE_M
        if fitting.mean() < LEAST_FITTING:
            return None
    slope = math.hypot(a, b)
    if not SLOPES[0] <= slope <= SLOPES[1] or np.ptp(z[fitting]) < LEAST_RISE_M:
        return None
    riser, evenness = _even_steps(z[fitting])
    uphill = np.array([a, b]) / slope
    along = (xy[fitting] - middle) @ uphill
    across = (xy[fitting] - middle) @ (-uphill[1], uphill[0])
    right, left = np.percentile(across, (3.0, 97.0)) + np.array([-0.5, 0.5]) * CELL_M
    ends = np.array([along.min(), along.max()]) + np.array([-0.5, 0.5]) * CELL_M
    filled = len(along) * CELL_M**2 / ((left - right) * (ends[1] - ends[0]))
    if evenness < LEAST_EVENNESS or left - right < LEAST_WIDTH_M or filled < LEAST_FILLED:
        return None
    return Flight(
        (float(middle[0]), float(middle[1]), float(height)),
        (float(uphill[0]), float(uphill[1])),
        slope,
        (float(ends[0]), float(ends[1])),
        (float(right), float(left)),
        riser,
    )


def _even_steps(z: NDArray[np.float64]) -> tuple[float, float]:
    """The height of a step that heights agree with best, and how well, from 0 to 1."""
    risers = np.arange(*RISERS_M, 0.005)
    evenness = np.abs(np.exp(2j * np.pi * z / risers[:, None]).mean(axis=1))
    best = int(np.argmax(evenness))
    return float(risers[best]), float(evenness[best])


def _joined(known: Flight, new: Flight) -> Flight | None:
    """A flight that reaches as far as both; None if they are not one."""
    turn = known.uphill[0] * new.uphill[0] + known.uphill[1] * new.uphill[1]
    offset = np.subtract(new.middle, known.middle)
    along = float(offset[0] * known.uphill[0] + offset[1] * known.uphill[1])
    across = float(offset[1] * known.uphill[0] - offset[0] * known.uphill[1])
    over = float(offset[2]) - known.slope * along
    near = known.across[0] - CELL_M <= across <= known.across[1] + CELL_M
    if turn < math.cos(math.radians(20.0)) or abs(over) > known.riser or not near:
        return None
    return known._replace(
        along=(
            min(known.along[0], along + new.along[0]),
            max(known.along[1], along + new.along[1]),
        ),
        across=(
            min(known.across[0], across + new.across[0]),
            max(known.across[1], across + new.across[1]),
        ),
    )


@njit(cache=True)
def _extent(
    points: NDArray[np.float32], floor_z: float, band: tuple[float, float]
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Least and greatest cell with a point in the band; the least is greater without any."""
    low = np.full(2, np.iinfo(np.int64).max >> 1)
    high = np.full(2, np.iinfo(np.int64).min >> 1)
    for row in range(len(points)):
        if band[0] < points[row, 2] - floor_z < band[1]:
            for axis in range(2):
                cell = int(np.floor(points[row, axis] / CELL_M))
                low[axis], high[axis] = min(low[axis], cell), max(high[axis], cell)
    return low, high


@njit(cache=True)
def _raise(
    heights: NDArray[np.float32],
    first: NDArray[np.int64],
    points: NDArray[np.float32],
    floor_z: float,
    band: tuple[float, float],
    flat_m: float,
) -> NDArray[np.int64]:
    """Raise the heights to points; (2, 2) least and greatest cell, no floor, that was raised."""
    changed = np.empty((2, 2), np.int64)
    changed[0], changed[1] = np.iinfo(np.int64).max >> 1, np.iinfo(np.int64).min >> 1
    for row in range(len(points)):
        z = points[row, 2] - floor_z
        if not band[0] < z < band[1]:
            continue
        i = int(np.floor(points[row, 0] / CELL_M)) - first[0]
        j = int(np.floor(points[row, 1] / CELL_M)) - first[1]
        if z <= heights[i, j] + np.float32(0.01):
            continue
        heights[i, j] = z
        if abs(z) > flat_m:
            changed[0, 0], changed[1, 0] = min(changed[0, 0], i), max(changed[1, 0], i)
            changed[0, 1], changed[1, 1] = min(changed[0, 1], j), max(changed[1, 1], j)
    if changed[0, 0] <= changed[1, 0]:
        for axis in range(2):
            changed[0, axis] += first[axis]
            changed[1, axis] += first[axis]
    return changed


@njit(cache=True)
def _treads(
    heights: NDArray[np.float32],
    between: tuple[float, float],
    risers: tuple[float, float],
    reach: int,
) -> NDArray[np.bool_]:
    """Cells from which one steps up and down to others nearby, by a step each way."""
    rows, columns = heights.shape
    treads = np.zeros((rows, columns), np.bool_)
    for i in range(rows):
        for j in range(columns):
            height = heights[i, j]
            if not abs(height) > between[0] or height > between[1]:  # NaN is neither
                continue
            up, down = False, False
            for a in range(max(0, i - reach), min(rows, i + reach + 1)):
                for b in range(max(0, j - reach), min(columns, j + reach + 1)):
                    step = heights[a, b] - height
                    up |= risers[0] < step < risers[1]
                    down |= risers[0] < -step < risers[1]
                if up and down:
                    treads[i, j] = True
                    break
    return treads


@njit(cache=True)
def _add_inside(found: NDArray[np.bool_], flight: Flight, points: NDArray[np.float32]) -> None:
    """Set `found` for those of (N, 3) points that belong to a flight.

    One more tread at either end does, too: without a step down or up it was not seen to be one.
    """
    low, high = flight.along
    tread = flight.riser / flight.slope
    for row in range(len(points)):
        x, y, z = _offset(flight, points[row])
        if not flight.across[0] <= y <= flight.across[1]:
            continue
        over = z - flight.slope * x
        if low <= x <= high:
            lowest = flight.slope * low - 0.5 * flight.riser
            found[row] |= -BELOW_M <= over <= 0.5 * flight.riser + CELL_M and z >= lowest
        elif low - tread <= x <= high + tread:
            found[row] |= abs(over) <= 0.5 * flight.riser + 0.5 * CELL_M


@njit(cache=True)
def _grown(flight: Flight, points: NDArray[np.float32]) -> tuple[float, float]:
    """`along` of a flight with the treads that go on at its ends."""
    low, high = flight.along
    ends = np.array([low, high])
    cells = int((flight.across[1] - flight.across[0]) / CELL_M) + 1
    seen = np.zeros((2, cells), np.bool_)
    for row in range(len(points)):
        x, y, z = _offset(flight, points[row])
        beyond = low - GROWTH_M <= x < low or high < x <= high + GROWTH_M
        beside = flight.across[0] <= y <= flight.across[1]
        if beyond and beside and abs(z - flight.slope * x) <= 0.5 * flight.riser + 0.5 * CELL_M:
            end = int(x > high)
            seen[end, int((y - flight.across[0]) / CELL_M)] = True
            ends[end] = max(ends[end], x) if end else min(ends[end], x)
    return (
        ends[0] if seen[0].sum() >= GROWTH_CELLS else low,
        ends[1] if seen[1].sum() >= GROWTH_CELLS else high,
    )


@njit(cache=True)
def _offset(flight: Flight, point: NDArray[np.float32]) -> tuple[float, float, float]:
    """How far uphill, to the left and over its middle a point of a flight lies, metres."""
    x, y = point[0] - flight.middle[0], point[1] - flight.middle[1]
    ahead, aside = flight.uphill
    return x * ahead + y * aside, y * ahead - x * aside, point[2] - flight.middle[2]
