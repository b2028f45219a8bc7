"""Clearances by brute force, and ways in maps made for one trap each."""

from __future__ import annotations

import math

import numpy as np
import pytest
from kinematic_world import furnished, rooms, standing_point

from toponav.control.planner import Planner, PlannerConfig
from toponav.mapping.view import FREE, OCCUPIED, UNKNOWN, OccupancyGrid

R = 0.1
FAR = (100.0, 100.0)
"""An agent that stands elsewhere frees no cells."""


def drawn(*rows: str) -> OccupancyGrid:
    """A grid from a drawing: # occupied, . free, ? unknown; x grows to the right, y downwards."""
    values = {"#": OCCUPIED, ".": FREE, "?": UNKNOWN}
    cells = np.array([[values[c] for c in row] for row in rows], np.int8).T
    return OccupancyGrid(np.ascontiguousarray(cells), (0.0, 0.0), R)


def center(i: int, j: int) -> tuple[float, float]:
    return ((i + 0.5) * R, (j + 0.5) * R)


PLANNER = Planner(PlannerConfig())
THIN = Planner(PlannerConfig(radius_m=0.01, escape_radius_m=0.0, clearance_weight=0.0))
"""An agent so small that it fits into every free cell."""


def test_clearance_is_the_distance_to_the_nearest_occupied_cell() -> None:
    rng = np.random.default_rng(0)
    cells = rng.choice([FREE, FREE, FREE, UNKNOWN, OCCUPIED], (25, 18)).astype(np.int8)
    grid = OccupancyGrid(cells, (-1.0, 2.0), R)
    clearance = PLANNER.clearance(grid, FAR)
    careful = Planner(PlannerConfig(tight_weight=10.0)).clearance(grid, FAR)
    occupied = np.argwhere(cells == OCCUPIED)
    for i, j in np.ndindex(cells.shape):
        centers = R * np.hypot(*(occupied - (i, j)).T).min()
        assert clearance.distance_m[i, j] == pytest.approx(centers - R / 2)
        assert clearance.traversable[i, j] == (cells[i, j] == FREE and centers > 0.18)
        shortfall = min(max(0.0, 1.0 - (centers - R / 2) / 0.5), 1.0)
        assert clearance.step_cost[i, j] == pytest.approx(1.0 + 3.0 * shortfall**2)
        tight = min(max(0.0, 1.0 - (centers - R / 2) / 0.18), 1.0)
        more = 1.0 + 3.0 * shortfall**2 + 10.0 * tight**2
        assert careful.step_cost[i, j] == pytest.approx(more)


def test_open_space_has_no_clearance_to_lose() -> None:
    clearance = PLANNER.clearance(drawn("...", "..?"), FAR)
    assert np.isinf(clearance.distance_m).all()
    assert (clearance.step_cost == 1.0).all()
    assert clearance.traversable.sum() == 5


def test_the_agent_may_leave_a_place_where_it_does_not_fit() -> None:
    grid = drawn(*["#" * 9] * 2, "##" + "." * 7, *["#" * 9] * 2)
    free = PLANNER.clearance(grid, FAR).traversable
    here = PLANNER.clearance(grid, center(2, 2)).traversable
    assert not free.any()
    assert here[2:7, 2].all()  # 0.45 m
    assert not here[7:, 2].any()


@pytest.mark.parametrize("under", ["#", "?"])
def test_the_cells_under_the_agent_are_passable_whatever_the_map_says(under: str) -> None:
    rows = [list("." * 15) for _ in range(9)]
    rows[4][4] = under
    grid = drawn(*map("".join, rows))
    clearance = PLANNER.clearance(grid, center(4, 4))
    assert clearance.traversable[4, 4]
    field = PLANNER.cost_field(clearance, center(14, 4))
    assert np.isfinite(field.at(center(4, 4)))


def test_what_the_agent_felt_is_an_obstacle() -> None:
    grid = drawn(*["." * 11] * 11)
    clearance = PLANNER.clearance(grid, FAR, [center(5, 5), FAR])
    assert not clearance.traversable[5, 5]
    assert not clearance.traversable[6, 5]  # inflated like one that was seen
    assert clearance.traversable[7, 5]
    assert (grid.cells == FREE).all()


def test_unknown_space_is_never_crossed() -> None:
    grid = drawn("..?..", "..?..", "..?..")
    field = THIN.cost_field(THIN.clearance(grid, FAR), center(0, 0))
    assert np.isfinite(field.cost[:2]).all()
    assert np.isinf(field.cost[2:]).all()
    assert field.path_from(center(4, 0)).shape == (0, 2)
    assert field.length_from(center(4, 0)) == math.inf


def test_a_way_leads_from_cell_to_goal_over_traversable_cells() -> None:
    rng = np.random.default_rng(8)
    world = furnished(rng, rooms(rng, 3, 2, (0.8, 0.9)), 6)
    grid = world.grid()
    start, goal = (standing_point(rng, world, 0.3) for _ in range(2))
    field = PLANNER.cost_field(PLANNER.clearance(grid, start), goal)
    path = field.path_from(start)
    assert len(path) > 5
    np.testing.assert_allclose(path[[0, -1]], grid.center_of(grid.index_of([start, goal])))
    cells = grid.index_of(path)
    assert field.clearance.traversable[cells[:, 0], cells[:, 1]].all()
    assert (np.diff(field.cost[cells[:, 0], cells[:, 1]]) < 0).all()
    length = np.hypot(*np.diff(path, axis=0).T)
    assert length.max() <= math.sqrt(5) * R + 1e-9
    assert field.length_from(start) == pytest.approx(length.sum())
    assert field.length_from(start) <= field.at(start)


def test_a_way_goes_round_a_wall_and_measures_it() -> None:
    grid = drawn(".....", ".###.", ".....")
    field = THIN.cost_field(THIN.clearance(grid, FAR), center(2, 0))
    around = 6 * R  # two cells aside, two down, two back: no corner is cut
    assert field.length_from(center(2, 2)) == pytest.approx(around)
    assert field.at(center(2, 2)) == pytest.approx(around)
    assert field.geodesic(center(2, 0), center(2, 2)) == pytest.approx(around)
    assert field.geodesic(center(2, 2), center(2, 0)) == pytest.approx(around)


def test_ways_keep_to_the_middle_of_a_corridor() -> None:
    grid = drawn("#" * 40, *["." * 40] * 10, "#" * 40)
    start, goal = center(1, 3), center(38, 3)
    path = PLANNER.cost_field(PLANNER.clearance(grid, FAR), goal).path_from(start)
    middle = path[np.abs(path[:, 0] - 2.0) < 0.5, 1]
    np.testing.assert_allclose(middle, 0.6, atol=0.051)


def test_the_nearest_of_several_goals_is_the_goal() -> None:
    grid = drawn("." * 20)
    goals = [center(0, 0), center(19, 0)]
    field = THIN.cost_field(THIN.clearance(grid, FAR), goals)
    np.testing.assert_allclose(field.path_from(center(6, 0))[-1], goals[0])
    np.testing.assert_allclose(field.path_from(center(14, 0))[-1], goals[1])
    np.testing.assert_allclose(field.goals, goals)


def test_a_goal_in_an_obstacle_is_moved_beside_it() -> None:
    grid = drawn(*["." * 15] * 7, *["#" * 15] * 3)
    field = PLANNER.cost_field(PLANNER.clearance(grid, FAR), (0.72, 0.72, 0.0))
    np.testing.assert_allclose(field.goals, [center(7, 5)])
    assert np.isfinite(field.at(center(0, 0)))


@pytest.mark.parametrize("goal", [center(7, 9), (-5.0, 0.0), (50.0, 0.2)])
def test_a_goal_without_room_near_it_is_dropped(goal: tuple[float, float]) -> None:
    grid = drawn(*["." * 15] * 5, *["#" * 15] * 5)
    field = PLANNER.cost_field(PLANNER.clearance(grid, FAR), goal)
    assert field.goals.shape == (0, 2)
    assert np.isinf(field.cost).all()


def test_the_field_is_infinite_outside_the_grid() -> None:
    field = THIN.cost_field(THIN.clearance(drawn("..."), FAR), center(0, 0))
    assert field.at([FAR, (-0.01, 0.05), center(2, 0)]).tolist() == pytest.approx(
        [math.inf, math.inf, 2 * R]
    )


@pytest.mark.parametrize("offset", np.linspace(0.0, 0.09, 4).tolist())
@pytest.mark.parametrize("width", [0.7, 0.8, 0.9])
def test_doors_stay_passable_wherever_the_grid_lies(width: float, offset: float) -> None:
    x = (np.arange(40) + 0.5) * R
    low, high = 2.0 + offset, 2.0 + offset + width
    wall = (x - R / 2 < low - 1e-9) | (x + R / 2 > high + 1e-9)
    cells = np.full((40, 31), FREE, np.int8)
    cells[wall, 15] = OCCUPIED
    grid = OccupancyGrid(cells, (0.0, 0.0), R)
    field = PLANNER.cost_field(PLANNER.clearance(grid, FAR), (1.0, 3.0))
    path = field.path_from((1.0, 0.2))
    crossing = path[np.argmin(np.abs(path[:, 1] - 1.55)), 0]
    assert crossing == pytest.approx((low + high) / 2, abs=0.12)


def test_a_gap_that_may_be_just_wide_enough_is_crossed_only_when_it_must_be() -> None:
    cells = np.full((20, 20), FREE, np.int8)
    cells[:9, 11] = cells[11:, 8] = OCCUPIED  # two corners, 0.32 m apart
    grid = OccupancyGrid(cells, (0.0, 0.0), R)
    goal, start = (1.0, 1.7), (1.0, 0.3)

    def cost(squeeze: bool) -> float:
        clearance = PLANNER.clearance(grid, FAR, squeeze=squeeze)
        return float(PLANNER.cost_field(clearance, goal).at(start))

    assert math.isinf(cost(squeeze=False))
    assert math.isfinite(cost(squeeze=True))


def flight(rise_m: float) -> OccupancyGrid:
    """Floor all round a flight of five cells' width that climbs along x, `rise_m` a cell."""
    grid = drawn(*["." * 25] * 25)
    stairs = np.full((25, 25), np.nan, np.float32)
    stairs[8:17, 10:15] = rise_m * (1 + np.arange(9, dtype=np.float32))[:, None]
    return OccupancyGrid(grid.cells, grid.origin, R, stairs)


@pytest.mark.parametrize("rise_m", [0.17, -0.17])
def test_a_flight_is_entered_at_its_end_and_not_over_its_side(rise_m: float) -> None:
    clearance = THIN.clearance(flight(rise_m), FAR)
    field = THIN.cost_field(clearance, [center(12, 12)])
    path = field.path_from(center(12, 2))
    on_stairs = [cell for cell in clearance.grid.index_of(path) if 10 <= cell[1] < 15]
    entered = next(cell for cell in on_stairs if 8 <= cell[0] < 17)
    assert entered[0] == 8  # the lowest tread
    assert field.length_from(center(12, 2)) > 1.2  # the way round; straight it is one metre


def test_a_flat_stair_is_floor() -> None:
    clearance = THIN.clearance(flight(0.02), FAR)
    assert clearance.traversable.all()
    assert THIN.cost_field(clearance, [center(12, 12)]).length_from(center(12, 2)) == pytest.approx(
        1.0
    )
