"""Gaps hardly wider than the agent: what the follower alone cannot thread."""

from __future__ import annotations

import math

import numpy as np
import pytest
from kinematic_world import RADIUS_M, BoxWorld, Walker

from toponav.control.discrete import FollowerConfig
from toponav.control.maneuver import maneuver, solid_points
from toponav.control.planner import CostField, Planner, PlannerConfig
from toponav.mapping.view import FREE, OCCUPIED, MapView, OccupancyGrid, PointCloud

GOAL = np.array([[3.6, 1.5]])


def wall_with_gap(width_m: float) -> BoxWorld:
    """A room of 4 x 3 m, cut in two by a wall with a gap in it."""
    low, high = 1.5 - width_m / 2.0, 1.5 + width_m / 2.0
    outside = [(-0.1, -0.1, 4.1, 0.0), (-0.1, 3.0, 4.1, 3.1), (-0.1, 0.0, 0.0, 3.0)]
    inside = [(4.0, 0.0, 4.1, 3.0), (1.8, 0.0, 1.92, low), (1.8, high, 1.92, 3.0)]
    return BoxWorld((4.0, 3.0), np.array(outside + inside))


def surface(world: BoxWorld) -> np.ndarray:
    """(N, 3) points 4 cm apart on the boxes' sides."""
    parts = []
    for x0, y0, x1, y1 in world.boxes:
        xs, ys = (np.linspace(a, b, math.ceil((b - a) / 0.04) + 1) for a, b in ((x0, x1), (y0, y1)))
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
def test_a_gap_with_three_centimetres_to_spare_on_either_side_is_threaded(
    yaw_deg: float, y: float
) -> None:
    world = wall_with_gap(2.0 * RADIUS_M + 0.06)
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
    assert seek(world, walker)[1] > 0


def cloud(*points: tuple[float, float, float]) -> PointCloud:
    xyz = np.array(points, np.float32).reshape(-1, 3)
    return PointCloud(xyz, np.zeros((len(xyz), 3), np.uint8), np.ones(len(xyz), np.int32))


def test_of_a_flight_only_what_rises_beside_a_tread_is_solid() -> None:
    rail, tread, wall = (1.05, 0.55, 0.7), (0.95, 0.55, 0.1), (1.55, 1.55, 0.5)
    cells = np.full((20, 20), FREE, np.int8)
    cells[15, 15] = OCCUPIED
    heights = np.full(cells.shape, np.nan, np.float32)
    heights[9, 5], heights[10, 5] = tread[2], rail[2]
    grid = OccupancyGrid(cells, (0.0, 0.0), 0.1, heights)
    nothing = cloud()
    view = MapView(
        scene=nothing,
        objects={"stairs": cloud(rail, tread)},
        navigable=nothing,
        obstacles=cloud(wall),
        frontiers=np.zeros((0, 3)),
        frontier_labels=np.zeros(0, np.int64),
        grid=grid,
        floor_z=0.0,
    )
    clearance = Planner(PlannerConfig()).clearance(grid, (0.3, 0.3))
    found = solid_points(view, clearance, foot_z=0.0)
    np.testing.assert_allclose(found, [wall[:2], rail[:2]], atol=1e-6)
