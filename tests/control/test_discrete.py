"""One decision of the follower at a time; whole walks are in test_locomotion.py."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from toponav.control.discrete import DiscreteFollower, FollowerConfig
from toponav.control.planner import CostField, Planner, PlannerConfig
from toponav.geometry import Pose
from toponav.mapping.view import FREE, OCCUPIED, UNKNOWN, OccupancyGrid
from toponav.types import Action

FOLLOWER = DiscreteFollower(FollowerConfig())
TURN = math.radians(30.0)


def open_field(goal: tuple[float, float], cells: np.ndarray | None = None) -> CostField:
    """Ten metres square around the origin."""
    grid_cells = np.full((100, 100), FREE, np.int8) if cells is None else cells
    grid = OccupancyGrid(grid_cells, (-5.0, -5.0), 0.1)
    planner = Planner(PlannerConfig())
    return planner.cost_field(planner.clearance(grid, (0.0, 0.0)), goal)


def at_origin(yaw: float) -> Pose:
    return Pose.from_yaw(yaw, (0.0, 0.0, 0.0))


def never(heading: float) -> bool:
    return False


@given(st.floats(-math.pi, math.pi), st.floats(-math.pi, math.pi))
def test_in_the_open_it_turns_the_shorter_way_to_the_goal(yaw: float, bearing: float) -> None:
    goal = (4.0 * math.cos(bearing), 4.0 * math.sin(bearing))
    action = FOLLOWER.next_action(at_origin(yaw), open_field(goal), never)
    off = math.remainder(bearing - yaw, math.tau)
    # On a grid a fan of directions is equally short: near the goal's either will do.
    if abs(off) < 0.05:
        assert action is Action.MOVE_FORWARD
    elif 1.5 * TURN < abs(off) < math.pi - 0.5 * TURN:
        assert action is (Action.TURN_LEFT if off > 0 else Action.TURN_RIGHT)
    else:
        assert action is not None


def test_a_goal_behind_is_turned_to_by_the_left() -> None:
    assert FOLLOWER.next_action(at_origin(0.0), open_field((-4.0, 0.05)), never) is Action.TURN_LEFT


@pytest.mark.parametrize("obstacle", [OCCUPIED, UNKNOWN])
def test_it_does_not_step_into_what_is_not_known_to_be_free(obstacle: int) -> None:
    cells = np.full((100, 100), FREE, np.int8)
    cells[52:55, 45:55] = obstacle  # 0.2 m ahead
    action = FOLLOWER.next_action(at_origin(0.0), open_field((4.0, 0.0), cells), never)
    assert action in (Action.TURN_LEFT, Action.TURN_RIGHT)


def test_a_barred_heading_is_not_tried_again() -> None:
    field = open_field((4.0, 0.0))
    assert FOLLOWER.next_action(at_origin(0.0), field, never) is Action.MOVE_FORWARD
    barred = FOLLOWER.next_action(at_origin(0.0), field, lambda heading: abs(heading) < 0.1)
    assert barred in (Action.TURN_LEFT, Action.TURN_RIGHT)


def test_it_gives_up_when_every_heading_is_barred_or_nothing_can_be_reached() -> None:
    assert (
        FOLLOWER.next_action(at_origin(0.0), open_field((4.0, 0.0)), lambda heading: True) is None
    )
    cells = np.full((100, 100), FREE, np.int8)
    cells[70] = OCCUPIED
    assert FOLLOWER.next_action(at_origin(0.0), open_field((4.0, 0.0), cells), never) is None


def test_it_stays_inside_the_map() -> None:
    field = open_field((4.0, 0.0))
    edge = Pose.from_yaw(0.0, (4.99, 0.0, 0.0))
    assert FOLLOWER.next_action(edge, field, never) in (Action.TURN_LEFT, Action.TURN_RIGHT)


@given(
    st.floats(-math.pi, math.pi), st.tuples(st.floats(-4, 4), st.floats(-4, 4)), st.integers(0, 99)
)
def test_turning_in_place_ends_within_half_a_turn(
    yaw: float, goal: tuple[float, float], seed: int
) -> None:
    """On one map the agent never turns back and forth, whatever stands around it."""
    rng = np.random.default_rng(seed)
    cells = np.full((100, 100), FREE, np.int8)
    blocks = rng.integers(0, 100, (150, 2))
    cells[blocks[:, 0], blocks[:, 1]] = OCCUPIED
    field = open_field(goal, cells)
    turns: list[Action] = []
    while (action := FOLLOWER.next_action(at_origin(yaw), field, never)) is not None:
        if action is Action.MOVE_FORWARD:
            break
        turns.append(action)
        assert len(turns) <= 6
        yaw += TURN if action is Action.TURN_LEFT else -TURN
    assert len(set(turns)) <= 1


@given(st.floats(-math.pi, math.pi), st.floats(-math.pi, math.pi))
def test_facing_a_point_takes_the_fewest_turns(yaw: float, bearing: float) -> None:
    point = np.array([math.cos(bearing), math.sin(bearing), 1.0])
    off = abs(math.remainder(bearing - yaw, math.tau))
    turns = 0
    while (action := FOLLOWER.face(at_origin(yaw), point)) is not None:
        yaw += TURN if action is Action.TURN_LEFT else -TURN
        turns += 1
        assert turns <= 6
    assert abs(math.remainder(bearing - yaw, math.tau)) <= TURN / 2 + 1e-6
    assert turns * TURN <= off + TURN / 2 + 1e-6
