"""Flights on the grid: gaps closed, ends told from sides, floor beside them not guessed."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from toponav.mapping.flights import (
    beside_unknown,
    ends_of_flights,
    filled_flights,
    tread_heights,
)
from toponav.mapping.view import DROP, FREE, OCCUPIED, UNKNOWN, OccupancyGrid

LANDING, WIDTH, TREADS = 10, 8, 14
"""Cells: the floor before a flight that leads down along x, the flight's width, two a tread."""


def flight() -> tuple[NDArray[np.int8], NDArray[np.float32], NDArray[np.bool_]]:
    """Cells, heights and observed floor of a landing and a flight down between two walls."""
    cells = np.full((LANDING + TREADS + 6, WIDTH + 2), UNKNOWN, np.int8)
    heights = np.full(cells.shape, np.nan, np.float32)
    inside = slice(1, WIDTH + 1)
    cells[:LANDING, inside] = FREE
    floor = cells == FREE
    on_flight = slice(LANDING, LANDING + TREADS)
    cells[on_flight, inside] = FREE
    heights[on_flight, inside] = -0.17 * (1 + np.arange(TREADS) // 2)[:, None]
    cells[: LANDING + TREADS, [0, -1]] = OCCUPIED
    return cells, heights, floor


def filled(
    cells: NDArray[np.int8], heights: NDArray[np.float32], floor: NDArray[np.bool_]
) -> tuple[NDArray[np.int8], NDArray[np.float32]]:
    return filled_flights(OccupancyGrid(cells, (0.0, 0.0), 0.1), heights, floor)


def test_a_whole_flight_stays_as_it_is() -> None:
    cells, heights, floor = flight()
    new_cells, new_heights = filled(cells, heights, floor)
    assert (new_cells == cells).all()
    assert np.array_equal(new_heights, heights, equal_nan=True)


def test_a_gap_is_closed_with_an_even_slope() -> None:
    cells, heights, floor = flight()
    gap = slice(LANDING + 4, LANDING + 9)
    truth = heights[gap, 1:-1].copy()
    cells[gap, 1:-1], heights[gap, 1:-1] = UNKNOWN, np.nan
    new_cells, new_heights = filled(cells, heights, floor)
    assert (new_cells[gap, 1:-1] == FREE).all()
    assert np.abs(new_heights[gap, 1:-1] - truth).max() < 0.25
    steps = np.abs(np.diff(new_heights[LANDING : LANDING + TREADS, 4]))
    assert steps.max() < 0.3, "the planner takes higher ones for the side of a flight"


def test_floor_that_no_image_showed_is_a_drop_beside_treads_and_floor_elsewhere() -> None:
    cells, heights, floor = flight()
    guess = slice(LANDING + TREADS, LANDING + TREADS + 2)
    cells[guess, 1:-1] = FREE
    cells[2, 4], floor[2, 4] = FREE, False
    new_cells, _ = filled(cells, heights, floor)
    assert (new_cells[guess, 1:-1] == DROP).all()
    assert new_cells[2, 4] == FREE


def test_the_riser_between_the_floor_and_the_first_tread_is_no_gap() -> None:
    cells, heights, floor = flight()
    cells[LANDING - 1, 1:-1], floor[LANDING - 1, 1:-1] = UNKNOWN, False
    new_cells, new_heights = filled(cells, heights, floor)
    assert (new_cells[LANDING - 1, 1:-1] == FREE).all()
    between = np.abs(new_heights[LANDING - 1, 1:-1])
    assert (between > 0.0).all()
    assert (between < np.abs(heights[LANDING, 1:-1])).all()


def test_the_ends_of_a_flight_are_its_last_treads() -> None:
    cells, heights, _ = flight()
    grid = OccupancyGrid(cells, (0.0, 0.0), 0.1, heights)
    centers = grid.center_of([[LANDING + 4, 1], [LANDING + TREADS - 1, 4], [2, 4]])
    assert ends_of_flights(grid, centers).tolist() == [False, True, True]


def test_what_borders_on_the_unknown() -> None:
    cells, heights, _ = flight()
    grid = OccupancyGrid(cells, (0.0, 0.0), 0.1, heights)
    centers = grid.center_of([[LANDING + TREADS - 1, 4], [LANDING, 4], [0, 4]])
    assert beside_unknown(grid, centers).tolist() == [True, False, True]


def test_a_foot_that_reaches_over_the_next_tread_does_not_lift_it() -> None:
    grid = OccupancyGrid(np.full((5, 1), FREE, np.int8), (0.0, 0.0), 0.1)
    seen = np.array([[0.05, 0.05, 0.8], [0.15, 0.05, 0.6], [0.15, 0.05, 0.5]], np.float32)
    stood = np.array([[0.05, 0.05, 0.8], [0.15, 0.05, 0.8], [0.25, 0.05, 0.8]], np.float32)
    heights = tread_heights(grid, seen, stood, floor_z=1.0)
    assert heights is not None
    np.testing.assert_allclose(heights[:, 0], [-0.2, -0.4, -0.2, np.nan, np.nan], rtol=1e-5)
    assert tread_heights(grid, seen[:0], stood[:0], floor_z=1.0) is None
