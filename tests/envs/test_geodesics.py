"""Geodesics against visibility graphs and worked lengths; straight walks against brute force."""

from __future__ import annotations

import math

import numpy as np
import pytest
from box_scenes import boxes, mesh_of
from grid_reference import CELL_M, exact_distances, flat_graph
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.ndimage import distance_transform_edt

from toponav.envs.simulator.agent_body import AgentBody
from toponav.envs.simulator.navigation import NavigableSurface

CORNER_ERROR_M = 0.01
"""Among obstacles of single cells a path may miss the best turn by a fraction of a cell."""


def surface_of(free: np.ndarray) -> NavigableSurface:
    return NavigableSurface(flat_graph(free), AgentBody())


def random_mask(seed: int, size: int, density: float, clearance: float = 0.0) -> np.ndarray:
    """Scattered blocked cells and two walls; `clearance` in cells widens them all."""
    rng = np.random.default_rng(seed)
    free = rng.random((size, size)) > density
    for axis in (0, 1):
        i, j, length = rng.integers(size), rng.integers(size), rng.integers(4, size // 2)
        (free if axis else free.T)[i, j : j + length] = False
    return free if clearance == 0.0 else distance_transform_edt(free) > clearance


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize(
    ("size", "density", "clearance"),
    [(20, 0.05, 0.0), (20, 0.3, 0.0), (40, 0.004, 3.6), (40, 0.012, 3.6)],
)
def test_distances_agree_with_a_visibility_graph(
    seed: int, size: int, density: float, clearance: float
) -> None:
    free = random_mask(seed, size, density, clearance)
    surface = surface_of(free)
    goal = surface.random_point(np.random.default_rng(seed))
    exact = exact_distances(free, (goal[0] / CELL_M, goal[1] / CELL_M))
    field = surface.distance_field(goal)
    x, y = np.nonzero(free)
    centres = np.column_stack([CELL_M * (x + 0.5), CELL_M * (y + 0.5), np.zeros(len(x))])
    found = np.array([field.at(centre) for centre in centres])
    np.testing.assert_array_equal(np.isfinite(found), np.isfinite(exact))
    reached = np.isfinite(exact)
    error = found[reached] - exact[reached]
    assert error.min() > -1e-4
    assert error.max() < CORNER_ERROR_M
    assert error.mean() < 0.05 * CORNER_ERROR_M


def test_the_path_through_an_l_shaped_corridor_touches_its_inner_corner() -> None:
    free = np.zeros((100, 80), np.bool_)
    free[:, :20] = True
    free[80:, :] = True
    surface = surface_of(free)
    start, goal = np.array([0.3, 0.2, 0.0]), np.array([4.6, 3.7, 0.0])
    corner = np.array([4.0, 1.0, 0.0])
    expected = math.dist(start, corner) + math.dist(corner, goal)
    assert surface.geodesic_distance(start, goal) == pytest.approx(expected, abs=1e-5)
    np.testing.assert_allclose(surface.shortest_path(start, goal), [start, corner, goal], atol=1e-5)


place = st.tuples(st.floats(0.0, 2.999), st.floats(0.0, 2.999), st.just(0.0))


@settings(max_examples=60)
@given(place, place)
def test_distances_on_open_floor_are_euclidean(start: tuple, goal: tuple) -> None:
    found = surface_of(np.ones((60, 60), np.bool_)).geodesic_distance(start, goal)
    assert found == pytest.approx(math.dist(start, goal), abs=1e-9)


def test_a_field_of_many_goals_is_the_nearest_of_each() -> None:
    free = random_mask(5, 40, 0.004, 3.6)
    surface = surface_of(free)
    rng = np.random.default_rng(0)
    goals = np.array([surface.random_point(rng) for _ in range(6)])
    together = surface.distance_field(goals)
    single = [surface.distance_field(goal) for goal in goals]
    for _ in range(40):
        point = surface.random_point(rng)
        nearest = min(field.at(point) for field in single)
        assert together.at(point) == pytest.approx(nearest, abs=CORNER_ERROR_M)


def test_a_single_distance_is_that_of_the_field() -> None:
    surface = surface_of(random_mask(7, 40, 0.01, 3.6))
    rng = np.random.default_rng(1)
    goal = surface.random_point(rng)
    field = surface.distance_field(goal)
    for _ in range(40):
        start = surface.random_point(rng)
        assert surface.geodesic_distance(start, goal) == pytest.approx(field.at(start), abs=1e-9)


def test_close_to_goals_that_share_a_cell_each_distance_is_exact() -> None:
    surface = surface_of(np.ones((40, 40), np.bool_))
    goals = np.array([[1.001, 1.001, 0.0], [1.049, 1.049, 0.0]])
    field = surface.distance_field(goals)
    for point in ((1.06, 1.07, 0.0), (0.98, 0.97, 0.0), (1.045, 1.005, 0.0), *goals):
        nearest = np.linalg.norm(goals - np.asarray(point), axis=1).min()
        assert field.at(point) == pytest.approx(nearest, abs=1e-12)


def test_a_ramp_is_measured_along_its_slope() -> None:
    corners = [(0, 0, 0), (2, 0, 0), (6, 0, 1.6), (8, 0, 1.6)]
    vertices = [(x, y, z) for x, _, z in corners for y in (0.0, 2.0)]
    faces = [f for k in (0, 2, 4) for f in ((k, k + 2, k + 1), (k + 1, k + 2, k + 3))]
    surface = NavigableSurface.build(mesh_of(vertices, faces))
    expected = 1.5 + math.hypot(4.0, 1.6) + 1.5
    up = surface.geodesic_distance((0.5, 1.0, 0.0), (7.5, 1.0, 1.6))
    down = surface.geodesic_distance((7.5, 1.0, 1.6), (0.5, 1.0, 0.0))
    assert up == pytest.approx(expected, rel=0.01)
    assert down == pytest.approx(expected, rel=0.01)


def test_stairs_measure_what_an_agent_measures_that_climbs_them() -> None:
    steps = [
        ("stairs", ((1.0 + 0.25 * k, 0.0, 0.0), (5.5, 1.2, 0.18 * (k + 1)))) for k in range(10)
    ]
    surface = NavigableSurface.build(
        boxes([("floor", ((0.0, 0.0, -0.1), (5.5, 1.2, 0.0))), *steps])
    )
    position = np.array([0.5, 0.6, 0.0])
    start, travelled = position, 0.0
    for _ in range(16):
        motion = surface.move(position, 0.0, 0.25)
        assert not motion.collided
        travelled += math.dist(position, motion.position)
        position = motion.position
    assert position[2] == pytest.approx(1.8)
    assert surface.geodesic_distance(start, position) == pytest.approx(travelled, rel=0.02)


def first_block(free: np.ndarray, start: np.ndarray, yaw: float, distance: float) -> float:
    """Metres to the first sample on a line that lies in no free cell; inf without one."""
    along = np.linspace(0.0, distance, 20_000)
    xy = start[:2] + along[:, None] * [math.cos(yaw), math.sin(yaw)]
    cell = np.floor(xy / CELL_M).astype(int)
    inside = np.all((cell >= 0) & (cell < free.shape), axis=1)
    cell = np.clip(cell, 0, np.array(free.shape) - 1)
    blocked = ~(inside & free[cell[:, 0], cell[:, 1]])
    return float(along[np.argmax(blocked)]) if blocked.any() else math.inf


@settings(max_examples=120)
@given(st.integers(0, 100_000), st.floats(-math.pi, math.pi), st.floats(0.05, 1.5))
def test_moves_end_where_the_line_first_leaves_the_cells(
    seed: int, yaw: float, distance: float
) -> None:
    free = random_mask(seed, 24, 0.08)
    surface = surface_of(free)
    start = surface.random_point(np.random.default_rng(seed))
    motion = surface.move(start, yaw, distance)
    walked = math.dist(start, motion.position)
    limit = first_block(free, start, yaw, distance)
    if motion.collided:
        # A line may cut a blocked cell's tip between two samples; it never gets any further.
        assert walked <= limit
        ahead = motion.position[:2] + 3e-4 * np.array([math.cos(yaw), math.sin(yaw)])
        assert walked == pytest.approx(limit, abs=3e-4) or not surface.is_navigable([*ahead, 0.0])
    else:
        assert walked == pytest.approx(distance)
        assert limit == math.inf


@settings(max_examples=150)
@given(
    seed=st.integers(0, 1000),
    quarters=st.tuples(st.integers(0, 96), st.integers(0, 96)),
    turns=st.lists(st.integers(0, 15), min_size=1, max_size=12),
)
def test_an_agent_on_the_borders_of_cells_stays_on_the_surface(
    seed: int, quarters: tuple[int, int], turns: list[int]
) -> None:
    # Starts on borders and corners of cells, and headings along them and through corners.
    surface = surface_of(random_mask(seed, 24, 0.1))
    position = surface.snap((quarters[0] * CELL_M / 4, quarters[1] * CELL_M / 4, 0.0), math.inf)
    assert position is not None
    for turn in turns:
        position = surface.move(position, turn * math.pi / 8, 0.25).position
        assert surface.is_navigable(position)
