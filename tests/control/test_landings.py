"""A flight of which all but the last treads are known: where the agent may expect to step next."""

from __future__ import annotations

import numpy as np
import pytest

from toponav.control.landings import landings
from toponav.control.planner import Planner, PlannerConfig
from toponav.mapping.view import DROP, FREE, OCCUPIED, UNKNOWN, OccupancyGrid

R = 0.1
SIDE = 60
LEFT, RIGHT = 25, 34
"""Rows of the flight, which leads along x, ends exclusive."""
SLOPE = 0.6
FOOT = 40
"""Where the flight would reach the floor's height."""


def flight(last: int, sign: float = 1.0) -> OccupancyGrid:
    """Treads from column 10 up to `last`, walls on both sides of them, and nothing else known."""
    cells = np.full((SIDE, SIDE), UNKNOWN, np.int8)
    stairs = np.full((SIDE, SIDE), np.nan, np.float32)
    steps = np.arange(10, last)
    cells[10:last, LEFT:RIGHT] = FREE
    stairs[10:last, LEFT:RIGHT] = (sign * SLOPE * R * (FOOT - steps))[:, None]
    cells[10:last, [LEFT - 1, RIGHT]] = OCCUPIED
    return OccupancyGrid(cells, (0.0, 0.0), R, stairs)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_treads_and_a_landing_are_taken_to_follow(sign) -> None:
    guessed = landings(flight(34, sign), 0.8)
    middle = (LEFT + RIGHT) // 2
    assert guessed[34 : FOOT + 7, middle].all()
    assert not guessed[FOOT + 10 :].any()
    assert not guessed[:33].any()
    beside = guessed[:, RIGHT + 4]
    assert not beside[: FOOT - 1].any()
    assert beside[FOOT + 1 : FOOT + 6].all()


def test_what_looks_like_a_drop_before_the_last_treads_is_guessed_as_well() -> None:
    grid = flight(34)
    grid.cells[34:FOOT, LEFT:RIGHT] = DROP
    grid.cells[10:30, RIGHT + 1 :] = DROP  # beside the flight, where it is one
    guessed = landings(grid, 0.8)
    assert guessed[34 : FOOT + 7, (LEFT + RIGHT) // 2].all()
    assert not guessed[10:30].any()


def test_nothing_known_is_guessed_anew() -> None:
    grid = flight(34)
    assert not (landings(grid, 0.8) & (grid.cells != UNKNOWN)).any()


def test_a_flight_that_breaks_off_high_up_ends_elsewhere() -> None:
    assert not landings(flight(28), 0.8).any()


def test_level_treads_lead_nowhere() -> None:
    grid = flight(34)
    grid.stairs[np.isfinite(grid.stairs)] = 0.2
    assert not landings(grid, 0.8).any()


def test_without_a_length_or_stairs_there_is_none() -> None:
    grid = flight(34)
    assert not landings(grid, 0.0).any()
    assert not landings(OccupancyGrid(grid.cells, grid.origin, R), 0.8).any()


def test_the_planner_goes_on_to_the_floor_only_where_it_may_guess() -> None:
    grid = flight(34)
    here = grid.center_of((20, (LEFT + RIGHT) // 2))
    beyond = grid.center_of((FOOT + 3, (LEFT + RIGHT) // 2))
    for landing_m in (0.0, 0.8):
        planner = Planner(PlannerConfig(landing_m=landing_m))
        field = planner.cost_field(planner.clearance(grid, here), beyond)
        assert np.isfinite(field.at(here)) == (landing_m > 0.0)
