from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from memory_maps import open_grid
from shapely.geometry import LineString, Point, box

from toponav.mapping.view import OCCUPIED, UNKNOWN, OccupancyGrid
from toponav.memory.traversability import cells_on_segment, is_clear

UNIT = OccupancyGrid(np.zeros((8, 8), np.int8), (0.0, 0.0), 1.0)
quarters = st.integers(0, 31).map(lambda n: n / 4.0)
anywhere = st.floats(0.0, 7.99, allow_subnormal=False)


def touched_cells(
    start: tuple[float, float], end: tuple[float, float], by: float
) -> set[tuple[int, int]]:
    """Cells whose square, grown by `by` on every side, meets the segment: shapely's answer."""
    line = LineString([start, end]) if start != end else Point(start)
    square = [(i, j) for i in range(-1, 9) for j in range(-1, 9)]
    return {
        (i, j) for i, j in square if box(i - by, j - by, i + 1 + by, j + 1 + by).intersects(line)
    }


@given(anywhere, anywhere, anywhere, anywhere)
def test_supercover_lies_between_the_cells_entered_and_the_cells_touched(x0, y0, x1, y1):
    cells = {(int(i), int(j)) for i, j in cells_on_segment(UNIT, (x0, y0), (x1, y1))}
    assert touched_cells((x0, y0), (x1, y1), -1e-6) <= cells
    assert cells <= touched_cells((x0, y0), (x1, y1), 1e-6)


@given(quarters, quarters, quarters, quarters)
def test_supercover_holds_on_grid_lines_and_corners(x0, y0, x1, y1):
    cells = {(int(i), int(j)) for i, j in cells_on_segment(UNIT, (x0, y0), (x1, y1))}
    assert touched_cells((x0, y0), (x1, y1), -1e-6) <= cells
    assert cells <= touched_cells((x0, y0), (x1, y1), 1e-6)


def test_a_corner_counts_both_cells_beside_it():
    cells = cells_on_segment(UNIT, (0.5, 0.5), (1.5, 1.5))
    assert cells.tolist() == [[0, 0], [0, 1], [1, 0], [1, 1]]


def test_a_point_has_one_cell():
    assert cells_on_segment(UNIT, (2.5, 3.5), (2.5, 3.5)).tolist() == [[2, 3]]


@pytest.mark.parametrize("slope", [1, -1])
def test_a_diagonal_wall_one_cell_thick_blocks_every_crossing(slope):
    grid = open_grid(4.0)
    index = np.arange(40)
    grid.cells[index, index if slope == 1 else 39 - index] = OCCUPIED
    for shift in np.linspace(-1.0, 1.0, 21):
        start, end = (shift - 0.4, slope * (shift + 0.4)), (shift + 0.4, slope * (shift - 0.4))
        assert not is_clear(grid, start, end)


def test_only_occupied_cells_on_the_line_block():
    grid = open_grid(4.0)
    grid.cells[:] = UNKNOWN
    assert is_clear(grid, (-1.0, 0.05), (1.0, 0.05))
    grid.cells[tuple(grid.index_of((0.05, 0.35)))] = OCCUPIED
    assert is_clear(grid, (-1.0, 0.05), (1.0, 0.05))
    grid.cells[tuple(grid.index_of((0.05, 0.05)))] = OCCUPIED
    assert not is_clear(grid, (-1.0, 0.05), (1.0, 0.05))


def test_outside_the_grid_nothing_blocks():
    grid = open_grid(2.0)
    grid.cells[:] = OCCUPIED
    assert is_clear(grid, (5.0, 5.0), (6.0, -5.0))
