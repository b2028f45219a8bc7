"""Gaps hardly wider than the agent: what the follower alone cannot thread."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from kinematic_world import RADIUS_M, BoxWorld, Walker
from policy_maps import make_view
from toponav.control.discrete import FollowerConfig
from toponav.control.maneuver import maneuver, solid_points
from toponav.control.planner import CostField, Planner, PlannerConfig
from toponav.mapping.view import OccupancyGrid

GOAL = np.array([[3.6, 1.5]])


def wall_with_gap(width_m: float) -> BoxWorld:
    """A room of 4 x 3 m, cut in two by a thick wall with a gap in it."""
    low, high = 1.5 - width_m / 2.0, 1.5 + width_m / 2.0
    outside = [(-0.1, -0.1, 4.1, 0.0), (-0.1, 3.0, 4.1, 3.1), (-0.1, 0.0, 0.0, 3.0)]
    inside = [(4.0, 0.0, 4.1, 3.0), (1.8, 0.0, 2.3, low), (1.8, high, 2.3, 3.0)]
    return BoxWorld((4.0, 3.0), np.array(outside + inside))


def surface(world: BoxWorld) -> np.ndarray:
    """(N, 3) points 4 cm apart on the boxes' sides."""
    parts = []
    for x0, y0, x1, y1 in world.boxes:
        xs, ys = np.arange(x0, x1, 0.04), np.arange(y0, y1, 0.04)
        parts += [[(x, y) for x in xs for y in (y0, y1)], [(x, y) for y in ys for x in (x0, x1)]]
    xy = np.concatenate([np.array(part) for part in parts])
    return np.column_stack([xy, np.full(len(xy), 0.5)])


def seek(world: BoxWorld, walker: Walker, gain_m: float = 1.0) -> tuple[CostField, int]:
    """Walk what is found to be just wide enough; the field, and how many actions there were."""
    grid = world.grid()
    planner = Planner(PlannerConfig())
    field = planner.cost_field(planner.clearance(grid, walker.xy, squeeze=True), GOAL)
    base = walker.observe().world_from_base
    actions = maneuver(base, field, surface(world), FollowerConfig(), RADIUS_M, gain_m)
    for action in actions:
        walker.apply(action)
    return field, len(actions)


@pytest.mark.parametrize("yaw_deg", [0.0, 7.0, 14.0, 21.0])
@pytest.mark.parametrize("y", [1.2, 1.46, 1.55])
def test_a_gap_with_two_centimetres_to_spare_on_either_side_is_threaded(
    yaw_deg: float, y: float
) -> None:
    world = wall_with_gap(2.0 * RADIUS_M + 0.04)
    walker = Walker(world, np.array([1.4, y]), math.radians(yaw_deg))
    field, actions = seek(world, walker)
    assert actions
    assert not walker.collisions
    assert walker.xy[0] > 1.8
    assert field.at(walker.xy) <= field.at([1.4, y]) - 1.0


def test_a_gap_that_is_too_narrow_is_left_alone() -> None:
    world = wall_with_gap(2.0 * RADIUS_M - 0.02)
    walker = Walker(world, np.array([1.4, 1.5]), 0.1)
    assert seek(world, walker)[1] == 0


def test_who_touches_something_may_leave_it() -> None:
    world = wall_with_gap(0.6)
    walker = Walker(world, np.array([1.63, 1.0]), 0.0)  # a centimetre into the wall's margin
    _, actions = seek(world, walker)
    assert actions
    assert walker.xy[0] > 2.0


def test_of_a_flight_only_what_rises_beside_a_tread_is_solid() -> None:
    rail, tread, wall = (1.05, 0.55, 0.7), (0.55, 0.55, 0.1), (1.55, 1.55, 0.5)
    cells = np.ones((20, 20), np.int8)
    grid = OccupancyGrid(cells, (0.0, 0.0), 0.1, np.full(cells.shape, np.nan, np.float32))
    grid.cells[15, 15] = -1
    grid.stairs[5, 5], grid.stairs[10, 5] = 0.1, 0.7
    view = make_view(obstacles=np.array([wall]), objects={"stairs": np.array([rail, tread])})
    view = replace(view, grid=grid)
    clearance = Planner(PlannerConfig()).clearance(grid, (0.55, 0.55))
    found = solid_points(view, clearance, foot_z=0.0)
    np.testing.assert_allclose(sorted(map(tuple, found)), [rail[:2], wall[:2]], atol=1e-6)
