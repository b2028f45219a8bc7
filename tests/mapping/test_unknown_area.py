"""Unknown floor beyond a frontier: through unknown cells, within reach, beyond the grid."""

from __future__ import annotations

import numpy as np
import pytest

from toponav.mapping.unknown_area import unknown_area_m2
from toponav.mapping.view import FREE, OCCUPIED, UNKNOWN, OccupancyGrid


def area(cells: np.ndarray, seeds: list[tuple[int, int]], reach_m: float) -> float:
    grid = OccupancyGrid(cells.astype(np.int8), (0.0, 0.0), 0.1)
    return unknown_area_m2(grid, np.array(seeds), reach_m)


def test_a_closed_room_holds_its_unknown_cells_and_no_more() -> None:
    cells = np.full((9, 9), OCCUPIED)
    cells[1:8, 1:8] = UNKNOWN
    cells[1:8, 1] = FREE
    assert area(cells, [(4, 1)], 9.0) == pytest.approx(7 * 6 * 0.01)
    assert area(cells, [(4, 1), (5, 1)], 0.1) == pytest.approx(2 * 0.01)


def test_free_floor_and_obstacles_are_not_crossed() -> None:
    cells = np.full((3, 9), UNKNOWN)
    cells[:, 4] = OCCUPIED
    cells[0], cells[2], cells[:, 0] = OCCUPIED, OCCUPIED, OCCUPIED
    cells[1, 1] = FREE
    assert area(cells, [(1, 1)], 5.0) == pytest.approx(2 * 0.01)


def test_beyond_the_grid_nothing_is_known() -> None:
    assert area(np.full((3, 3), FREE), [(0, 1)], 0.1) == pytest.approx(0.01)
    assert area(np.full((1, 1), FREE), [(0, 0)], 0.2) == pytest.approx(12 * 0.01)
