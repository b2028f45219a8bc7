"""Bumps, stalls and waypoints in vain."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from toponav.control.planner import CostField, Planner, PlannerConfig
from toponav.control.recovery import (
    BarrenWaypoints,
    BumpMemory,
    ProgressMonitor,
    RecoveryConfig,
)
from toponav.geometry import Pose
from toponav.mapping.view import FREE, OCCUPIED, OccupancyGrid

CONFIG = RecoveryConfig()


def open_grid() -> OccupancyGrid:
    """Four metres square around the origin."""
    return OccupancyGrid(np.full((40, 40), FREE, np.int8), (-2.0, -2.0), 0.1)


def grid_with(*occupied_xy: tuple[float, float]) -> OccupancyGrid:
    grid = open_grid()
    i, j = grid.index_of(occupied_xy).T
    grid.cells[i, j] = OCCUPIED
    return grid


def pose(x: float = 0.0, y: float = 0.0, yaw_deg: float = 0.0) -> Pose:
    return Pose.from_yaw(math.radians(yaw_deg), (x, y, 0.0))


AHEAD = (0.25, 0.05)
"""In the cell that a bump at the origin, heading along x, would be felt in."""


def is_barred(bumps: BumpMemory, xy: tuple[float, float], deg: float, grid: OccupancyGrid) -> bool:
    return bumps.barring(xy, grid)(math.radians(deg))


def test_nothing_is_barred_or_felt_without_bumps() -> None:
    bumps = BumpMemory(CONFIG)
    assert not is_barred(bumps, (0.0, 0.0), 0.0, open_grid())
    assert bumps.obstacles(open_grid()).shape == (0, 2)


@pytest.mark.parametrize(
    ("xy", "heading_deg", "barred"),
    [
        ((0.0, 0.0), 0.0, True),
        ((0.0, 0.0), 19.0, True),
        ((0.0, 0.0), 360.0, True),
        ((0.0, 0.0), 30.0, False),
        ((0.0, 0.0), -30.0, False),
        ((0.0, 0.19), 0.0, True),
        ((0.0, 0.21), 0.0, False),
    ],
)
def test_a_graze_of_a_mapped_obstacle_bars_its_heading_near_its_place(
    xy: tuple[float, float], heading_deg: float, barred: bool
) -> None:
    bumps = BumpMemory(CONFIG)
    bumps.add(pose())
    assert is_barred(bumps, xy, heading_deg, grid_with(AHEAD)) is barred
    assert bumps.obstacles(grid_with(AHEAD)).shape == (0, 2)


def test_where_a_walk_was_given_up_a_graze_blocks() -> None:
    bumps = BumpMemory(CONFIG)
    bumps.add(pose())
    bumps.add(pose(1.5, 1.5))
    grid = grid_with(AHEAD, (1.75, 1.55))
    assert bumps.obstacles(grid).shape == (0, 2)
    bumps.give_up((0.3, 0.1))
    np.testing.assert_allclose(bumps.obstacles(grid), [[CONFIG.contact_m, 0.0]])
    bumps.stand((CONFIG.contact_m, 0.0))  # it came through all the same
    assert bumps.obstacles(grid).shape == (0, 2)


@pytest.mark.parametrize(
    ("xy", "heading_deg", "barred"),
    [
        ((0.0, 0.0), 80.0, True),
        ((0.0, 0.0), -80.0, True),
        ((0.0, 0.0), 90.0, False),
        ((0.0, 0.0), 180.0, False),
        ((-0.1, 0.0), 80.0, False),
        ((-0.1, 0.0), 10.0, True),
    ],
)
def test_what_no_image_shows_bars_the_half_circle_while_it_is_touched(
    xy: tuple[float, float], heading_deg: float, barred: bool
) -> None:
    bumps = BumpMemory(CONFIG)
    bumps.add(pose())
    assert is_barred(bumps, xy, heading_deg, open_grid()) is barred


@pytest.mark.parametrize(
    ("occupied", "explained"),
    [(AHEAD, True), ((0.05, 0.25), True), ((-0.15, 0.05), False), ((0.65, 0.05), False)],
)
def test_a_bump_is_an_obstacle_unless_the_map_explains_it(
    occupied: tuple[float, float], explained: bool
) -> None:
    bumps = BumpMemory(CONFIG)
    bumps.add(pose())
    felt = bumps.obstacles(grid_with(occupied))
    np.testing.assert_allclose(felt, np.zeros((0, 2)) if explained else [(0.25, 0.0)])


def test_an_obstacle_that_was_felt_is_forgotten_when_the_map_shows_it() -> None:
    bumps = BumpMemory(CONFIG)
    bumps.add(pose(yaw_deg=90.0))
    np.testing.assert_allclose(bumps.obstacles(open_grid()), [(0.0, 0.25)], atol=1e-12)
    assert not len(bumps.obstacles(grid_with((0.05, 0.25))))


def test_repeated_bumps_at_one_place_block_it_though_the_map_explains_them() -> None:
    grid, bumps = grid_with(AHEAD), BumpMemory(CONFIG)
    bumps.add(pose())
    bumps.add(pose(yaw_deg=30.0))
    bumps.add(pose(x=1.0, yaw_deg=180.0))  # elsewhere, so unexplained
    np.testing.assert_allclose(bumps.obstacles(grid), [(0.75, 0.0)], atol=1e-12)
    bumps.add(pose(yaw_deg=-30.0))
    assert len(bumps.obstacles(grid)) == 4


def test_what_the_agent_came_through_is_no_obstacle() -> None:
    bumps = BumpMemory(CONFIG)
    bumps.stand((0.3, 0.05))
    for yaw_deg in (0.0, 30.0, 90.0):
        bumps.add(pose(yaw_deg=yaw_deg))
    felt = bumps.obstacles(open_grid())
    np.testing.assert_allclose(felt, [(0.0, 0.25)], atol=1e-12)
    assert is_barred(bumps, (0.0, 0.0), 0.0, open_grid()), "it has to aim better"


def test_the_way_back_is_free_though_it_bumped_beside_it_but_not_where_it_bumped() -> None:
    bumps, grid = BumpMemory(CONFIG), open_grid()
    bumps.stand((-0.25, 0.0))
    bumps.add(pose(0.0, 0.0, 120.0))
    back = bumps.barring((0.0, 0.0), grid, back=True)
    assert is_barred(bumps, (0.0, 0.0), 180.0, grid)
    assert not back(math.radians(180.0))
    assert back(math.radians(120.0))
    bumps.add(pose(0.0, 0.0, 180.0))
    assert bumps.barring((0.0, 0.0), grid, back=True)(math.radians(180.0))


def test_where_walks_are_given_up_again_what_was_felt_there_is_forgotten() -> None:
    bumps, grid = BumpMemory(CONFIG), open_grid()
    bumps.add(pose())
    bumps.add(pose(3.0, 0.0))
    bumps.give_up((0.0, 0.0))
    assert len(bumps.obstacles(grid)) == 2
    bumps.give_up((0.1, 0.0))
    assert bumps.obstacles(grid)[:, 0].tolist() == [3.25]


def test_bumps_off_the_map_are_felt() -> None:
    bumps = BumpMemory(CONFIG)
    bumps.add(pose(x=50.0))
    np.testing.assert_allclose(bumps.obstacles(open_grid()), [(50.25, 0.0)])


def corridor(goal_x: float = 19.95) -> CostField:
    """Twenty metres along x: the cost-to-go from x is goal_x - x."""
    grid = OccupancyGrid(np.full((200, 3), FREE, np.int8), (0.0, 0.0), 0.1)
    planner = Planner(PlannerConfig())
    return planner.cost_field(planner.clearance(grid, (0.0, 0.0)), (goal_x, 0.15))


def calls_until_stalled(monitor: ProgressMonitor, xs: list[float], field: CostField) -> int | None:
    """How many steps it took, going through `xs` again and again; None if it never stalls."""
    for call in range(5 * CONFIG.window_steps):
        if monitor.stalled((xs[call % len(xs)], 0.15), field):
            return call
    return None


@given(st.integers(0, 6), st.integers(0, 29))
def test_a_step_after_every_few_turns_is_progress(turns: int, phase: int) -> None:
    monitor, field = ProgressMonitor(CONFIG), corridor()
    for call in range(200):
        step = (call + phase) // (turns + 1)
        assert not monitor.stalled((0.05 + 0.09 * step, 0.15), field)


@pytest.mark.parametrize("xs", [[3.0], [3.0, 3.2], [3.0, 2.0, 1.0, 2.0]])
def test_standing_still_or_going_to_and_fro_stalls(xs: list[float]) -> None:
    calls = calls_until_stalled(ProgressMonitor(CONFIG), xs, corridor())
    assert calls is not None
    assert CONFIG.window_steps <= calls <= CONFIG.window_steps + len(xs)


def test_the_same_pose_for_the_third_time_is_a_circle() -> None:
    monitor = ProgressMonitor(CONFIG)
    turn_there = [pose(yaw_deg=30.0 * k) for k in range(6)]
    turn_back = [pose(x=0.25, yaw_deg=180.0 + 30.0 * k) for k in range(6)]
    to_and_fro = [*turn_there, *turn_back]
    assert not any(monitor.circles(p) for p in [*to_and_fro, *to_and_fro])
    assert monitor.circles(pose())
    monitor.restart()
    assert not monitor.circles(pose())


def test_a_new_goal_is_given_new_patience() -> None:
    monitor, field = ProgressMonitor(CONFIG), corridor()
    for _ in range(CONFIG.window_steps):
        assert not monitor.stalled((3.0, 0.15), field)
    monitor.restart()
    assert calls_until_stalled(monitor, [3.0], field) == CONFIG.window_steps


def test_a_way_that_grows_longer_on_the_walk_is_progress() -> None:
    """Every step the map shows the goal to be as far ahead as before."""
    monitor = ProgressMonitor(CONFIG)
    fields = [corridor(goal_x=2.05 + 0.1 * step) for step in range(100)]
    assert not any(
        monitor.stalled((0.05 + 0.1 * step, 0.15), field) for step, field in enumerate(fields)
    )


def test_walking_where_nothing_can_be_reached_is_no_progress() -> None:
    monitor, field = ProgressMonitor(CONFIG), corridor(goal_x=500.0)
    assert np.isinf(field.cost).all()
    steps = 0.05 + 0.1 * np.arange(100)
    assert [monitor.stalled((x, 0.15), field) for x in steps].index(True) == CONFIG.window_steps


def test_barren_waypoints_are_ruled_out_around_and_forgiven_later() -> None:
    barren = BarrenWaypoints(CONFIG)
    points = np.array([[0.0, 0.0, 0.0], [0.49, 0.0, 0.0], [0.51, 0.0, 0.0]], np.float32)
    assert barren.admissible(points, 0).all()
    barren.add(np.array([0.0, 0.0, 0.1]), decision=3)
    for decision in (3, 3 + CONFIG.barren_decisions):
        assert barren.admissible(points, decision).tolist() == [False, False, True]
    assert barren.admissible(points[:, :2], 4 + CONFIG.barren_decisions).all()
    assert barren.admissible(points[:0], 3).shape == (0,)
