"""Whole walks of a disc with the protocol's motion through rooms, doors and clutter."""

from __future__ import annotations

import math

import numpy as np
import pytest
from kinematic_world import BoxWorld, Walker, furnished, rooms, standing_point, walk
from scipy import ndimage

from toponav.control.locomotion import Locomotion, LocomotionConfig, Progress
from toponav.control.recovery import RecoveryConfig
from toponav.mapping.view import FREE, OCCUPIED, OccupancyGrid
from toponav.types import Action

ARRIVAL_M = LocomotionConfig().arrival_m
PASSABLE_M = 0.25
"""Half the width of passages that every walk must get through: the agent's radius and 7 cm."""


def maze(seed: int) -> tuple[np.random.Generator, BoxWorld, OccupancyGrid]:
    """Twelve rooms with doors of 0.7 to 0.9 m, and a grid that lies anyhow."""
    rng = np.random.default_rng(seed)
    world = rooms(rng, 4, 3, (0.7, 0.9))
    return rng, world, world.grid(offset=rng.uniform(-0.1, 0.0, 2))


def connected(world: BoxWorld, a: np.ndarray, b: np.ndarray, margin: float) -> bool:
    """Whether a disc of radius `margin` can be moved from a to b, on a 5 cm lattice."""
    step = 0.05
    x, y = (np.arange(0.0, size, step) for size in world.size)
    room = np.stack([world.clearance(np.stack([0 * y + xi, y], axis=-1)) for xi in x]) > margin
    labels, _ = ndimage.label(room)
    at_a, at_b = (labels[tuple(np.round(p / step).astype(int))] for p in (a, b))
    return bool(at_a and at_a == at_b)


@pytest.mark.parametrize("seed", range(40))
def test_it_walks_through_every_maze_of_rooms_without_a_bump(seed: int) -> None:
    rng, world, grid = maze(seed)
    start, goal = standing_point(rng, world, 0.2), standing_point(rng, world, 0.3)
    walker = Walker(world, start, rng.uniform(-math.pi, math.pi))
    way = Locomotion(LocomotionConfig())
    way.go_to(goal)
    planned = way.path(walker.observe(), grid)
    assert walk(walker, grid, goal) is Progress.ARRIVED
    assert np.hypot(*(walker.xy - goal)) <= ARRIVAL_M
    assert walker.collisions == 0
    length = float(np.hypot(*np.diff(planned, axis=0).T).sum())
    assert walker.length_m <= 1.15 * length + 0.5


@pytest.mark.parametrize("seed", range(20))
def test_it_gets_wherever_there_is_room_among_furniture(seed: int) -> None:
    rng, world, _ = maze(100 + seed)
    world = furnished(rng, world, 14)
    grid = world.grid()
    start = standing_point(rng, world, PASSABLE_M)
    goal = standing_point(rng, world, 0.3)
    for _ in range(20):
        if connected(world, start, goal, PASSABLE_M):
            break
        goal = standing_point(rng, world, 0.3)
    else:
        pytest.skip("this clutter closes every way")
    walker = Walker(world, start, rng.uniform(-math.pi, math.pi))
    assert walk(walker, grid, goal) is Progress.ARRIVED
    assert np.hypot(*(walker.xy - goal)) <= ARRIVAL_M


def test_the_same_walk_twice_is_the_same() -> None:
    rng, world, grid = maze(7)
    start, goal = standing_point(rng, world, 0.2), standing_point(rng, world, 0.3)
    walks = [Walker(world, start, 0.3) for _ in range(2)]
    for walker in walks:
        walk(walker, grid, goal)
    assert walks[0].actions == walks[1].actions
    assert len(walks[0].actions) > 5


BIG_ROOM = BoxWorld(
    (6.0, 4.0), np.array([(-1, -1, 7, 0), (-1, 4, 7, 5), (-1, -1, 0, 5), (6, -1, 7, 5)], float)
)


def with_box(*box: float) -> BoxWorld:
    return BoxWorld(BIG_ROOM.size, np.vstack([BIG_ROOM.boxes, [box]]))


@pytest.mark.parametrize("yaw", np.linspace(-3.0, 3.0, 5).tolist())
def test_it_feels_its_way_round_an_obstacle_that_the_map_never_shows(yaw: float) -> None:
    walker = Walker(with_box(2.8, 1.2, 3.2, 2.8), np.array([1.0, 2.0]), yaw)
    assert walk(walker, BIG_ROOM.grid(), (5.0, 2.0)) is Progress.ARRIVED
    assert 0 < walker.collisions < 25


def test_it_gives_up_where_an_unseen_obstacle_leaves_no_way() -> None:
    walker = Walker(with_box(2.8, -1.0, 3.2, 5.0), np.array([1.0, 2.0]), 0.0)
    assert walk(walker, BIG_ROOM.grid(), (5.0, 2.0)) is Progress.GAVE_UP
    assert walker.steps < 400


def test_it_replans_when_the_map_shows_a_wall() -> None:
    """The wall and its door come into the map within 1.5 m: the way gets longer on the walk."""
    world = with_box(2.9, -1.0, 3.1, 3.1)
    full, believed = world.grid(), BIG_ROOM.grid().cells.copy()
    centers = full.center_of(np.moveaxis(np.indices(full.cells.shape), 0, -1))
    walker = Walker(world, np.array([1.0, 0.6]), 0.0)
    locomotion = Locomotion(LocomotionConfig())
    locomotion.go_to(np.array([5.0, 0.6]))
    while walker.steps < 150:
        near = np.hypot(*np.moveaxis(centers - walker.xy, -1, 0)) < 1.5
        believed[near] = full.cells[near]
        grid = OccupancyGrid(believed, full.origin, full.resolution)
        observation = walker.observe()
        locomotion.observe(observation)
        action = locomotion.next_action(observation, grid)
        if action is None:
            break
        walker.apply(action)
    assert locomotion.progress is Progress.ARRIVED
    assert walker.collisions == 0
    assert walker.length_m > 6.0


def test_it_walks_out_of_a_place_that_the_map_calls_an_obstacle() -> None:
    grid = BIG_ROOM.grid()
    i, j = grid.index_of((1.0, 2.0))
    grid.cells[i - 1 : i + 2, j - 1 : j + 2] = OCCUPIED
    walker = Walker(BIG_ROOM, np.array([1.0, 2.0]), 0.0)
    assert walk(walker, grid, (5.0, 2.0)) is Progress.ARRIVED


def test_a_goal_in_furniture_is_walked_up_to() -> None:
    world = with_box(3.0, 1.0, 4.0, 3.0)
    walker = Walker(world, np.array([1.0, 2.0]), 0.0)
    assert walk(walker, world.grid(), (3.05, 2.0)) is Progress.ARRIVED
    assert 2.4 < walker.xy[0] < 3.0


def test_it_is_idle_until_it_is_sent_and_stays_where_it_arrived() -> None:
    walker, grid = Walker(BIG_ROOM, np.array([1.0, 2.0]), 0.0), BIG_ROOM.grid()
    locomotion = Locomotion(LocomotionConfig())
    assert locomotion.progress is Progress.IDLE
    assert locomotion.next_action(walker.observe(), grid) is None
    locomotion.go_to(np.array([1.1, 2.0, 0.0]))
    assert locomotion.next_action(walker.observe(), grid) is None
    assert locomotion.progress is Progress.ARRIVED
    locomotion.go_to(np.array([3.0, 2.0]))
    assert locomotion.next_action(walker.observe(), grid) is Action.MOVE_FORWARD


def test_an_agent_that_cannot_move_gives_up_for_want_of_progress() -> None:
    """Motors that do nothing: no collision is ever reported."""
    walker, grid = Walker(BIG_ROOM, np.array([1.0, 2.0]), 0.0), BIG_ROOM.grid()
    locomotion = Locomotion(LocomotionConfig(recovery=RecoveryConfig(window_steps=7)))
    locomotion.go_to(np.array([5.0, 2.0]))
    actions = [locomotion.next_action(walker.observe(), grid) for _ in range(8)]
    assert actions == [Action.MOVE_FORWARD] * 7 + [None]
    assert locomotion.progress is Progress.GAVE_UP


def test_unknown_space_is_not_walked_into() -> None:
    grid = BIG_ROOM.grid()
    grid.cells[grid.cells == FREE] = 0
    walker = Walker(BIG_ROOM, np.array([1.0, 2.0]), 0.0)
    assert walk(walker, grid, (5.0, 2.0)) is Progress.GAVE_UP
    assert walker.steps == 0


def test_reach_and_path_agree_on_what_can_be_walked_to() -> None:
    _, world, grid = maze(3)
    walker = Walker(world, standing_point(np.random.default_rng(0), world, 0.3), 0.0)
    locomotion = Locomotion(LocomotionConfig())
    reach = locomotion.reach(walker.observe(), grid)
    goal = standing_point(np.random.default_rng(1), world, 0.3)
    locomotion.go_to(goal)
    path = locomotion.path(walker.observe(), grid)
    assert reach.length_from(goal) == pytest.approx(np.hypot(*np.diff(path, axis=0).T).sum())
