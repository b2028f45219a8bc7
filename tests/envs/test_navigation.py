"""The navigable surface: motion, geodesics against a fine grid, stairs, doors and gaps."""

from __future__ import annotations

import math

import numpy as np
import pytest
from box_scenes import boxes, room
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.sparse import coo_array
from scipy.sparse.csgraph import dijkstra

from toponav.envs.simulator.navigation import NavigableSurface
from toponav.errors import SceneError

RADIUS = 0.18
WALL = ("wall", ((2.9, 0.0, 0.0), (3.1, 2.6, 2.5)))  # leaves a passage at the north end
CRATE = ("box", ((4.2, 2.4, 0.0), (4.9, 3.1, 0.8)))


@pytest.fixture(scope="module")
def surface() -> NavigableSurface:
    return NavigableSurface.build(room(extra=[WALL, CRATE]), floors=(0.0,))


def fine_grid_distance(start: np.ndarray, goal: np.ndarray, cell: float = 0.02) -> float:
    """Dijkstra over a 2 cm grid with 32 neighbours between the agent-sized obstacles."""
    nx, ny = round(6.0 / cell), round(4.0 / cell)
    x = (np.arange(nx) + 0.5) * cell
    y = (np.arange(ny) + 0.5) * cell
    px, py = np.meshgrid(x, y, indexing="ij")
    free = (px > RADIUS) & (px < 6.0 - RADIUS) & (py > RADIUS) & (py < 4.0 - RADIUS)
    for _, ((x0, y0, _), (x1, y1, _)) in (WALL, CRATE):
        gap = np.hypot(np.clip(x0 - px, 0, None) + np.clip(px - x1, 0, None),
                       np.clip(y0 - py, 0, None) + np.clip(py - y1, 0, None))  # fmt: skip
        free &= gap > RADIUS
    index = np.arange(nx * ny).reshape(nx, ny)
    steps = [(1, 0), (0, 1), (1, 1), (1, -1), (2, 1), (1, 2), (2, -1), (1, -2), (3, 1), (1, 3),
             (3, -1), (1, -3), (3, 2), (2, 3), (3, -2), (2, -3)]  # fmt: skip
    rows, columns, lengths = [], [], []
    for dx, dy in steps:
        a = index[: nx - dx, max(0, -dy) : ny - max(0, dy)]
        b = index[dx:, max(0, dy) : ny + min(0, dy)]
        both = free.ravel()[a] & free.ravel()[b]
        rows.append(a[both])
        columns.append(b[both])
        lengths.append(np.full(int(both.sum()), math.hypot(dx, dy) * cell))
    graph = coo_array(
        (np.concatenate(lengths), (np.concatenate(rows), np.concatenate(columns))),
        shape=(nx * ny, nx * ny),
    ).tocsr()
    source, target = (index[int(p[0] / cell), int(p[1] / cell)] for p in (start, goal))
    return float(dijkstra(graph, directed=False, indices=source)[target])


def test_geodesics_agree_with_dijkstra_on_a_fine_grid(surface: NavigableSurface) -> None:
    rng = np.random.default_rng(3)
    for _ in range(12):
        start, goal = surface.random_point(rng), surface.random_point(rng)
        expected = fine_grid_distance(start, goal)
        if not math.isfinite(expected):
            continue  # nearer to an obstacle than the fine grid's exact radius
        found = surface.geodesic_distance(start, goal)
        assert found == pytest.approx(expected, rel=0.025, abs=0.06)


def test_geodesic_round_a_corner_is_the_worked_length(surface: NavigableSurface) -> None:
    # From (2, 1) to (4, 1) round the wall: a tangent to the circle of the agent's radius about
    # each of its two corners, the arc up to the top, and the wall's thickness between.
    start, goal = (2.0, 1.0, 0.0), (4.0, 1.0, 0.0)
    to_corner = math.hypot(0.9, 1.6)
    tangent = math.sqrt(to_corner**2 - RADIUS**2)
    arc = math.pi / 2 + math.atan2(1.6, 0.9) - math.acos(RADIUS / to_corner)
    expected = 2.0 * (tangent + RADIUS * arc) + 0.2
    found = surface.geodesic_distance(start, goal)
    assert found == pytest.approx(expected, rel=0.03)


def test_the_field_and_the_path_tell_the_same_length(surface: NavigableSurface) -> None:
    rng = np.random.default_rng(0)
    goal = surface.random_point(rng)
    field = surface.distance_field([goal])
    for _ in range(20):
        start = surface.random_point(rng)
        path = surface.shortest_path(start, goal)
        length = float(np.linalg.norm(np.diff(path, axis=0), axis=1).sum())
        assert field.at(start) == pytest.approx(length, abs=0.02)
        np.testing.assert_allclose(path[0], start, atol=1e-9)
        np.testing.assert_allclose(path[-1], goal, atol=1e-9)


def test_distances_are_symmetric_and_obey_the_triangle_inequality(
    surface: NavigableSurface,
) -> None:
    rng = np.random.default_rng(1)
    for _ in range(10):
        a, b, c = (surface.random_point(rng) for _ in range(3))
        ab, bc, ac = (surface.geodesic_distance(p, q) for p, q in ((a, b), (b, c), (a, c)))
        assert ab == pytest.approx(surface.geodesic_distance(b, a), rel=0.02, abs=0.03)
        assert ac <= (ab + bc) * 1.02 + 0.03
        assert ab >= math.dist(a, b) - 1e-6


@settings(max_examples=150)
@given(st.integers(0, 10_000), st.floats(-math.pi, math.pi), st.floats(0.01, 3.0))
def test_a_move_stays_on_its_line_and_on_the_surface(
    surface: NavigableSurface, seed: int, yaw: float, distance: float
) -> None:
    start = surface.random_point(np.random.default_rng(seed))
    motion = surface.move(start, yaw, distance)
    assert surface.is_navigable(motion.position)
    offset = motion.position[:2] - start[:2]
    heading = np.array([math.cos(yaw), math.sin(yaw)])
    along, across = offset @ heading, offset[0] * heading[1] - offset[1] * heading[0]
    assert abs(across) < 1e-9
    assert -1e-9 <= along <= distance + 1e-9
    assert motion.collided == (along < distance - 1e-9)


@pytest.mark.parametrize("slope_deg", [0.2, 1.0, 5.0])
def test_at_a_wall_a_step_that_grazes_it_ends_where_it_began(slope_deg: float) -> None:
    surface = NavigableSurface.build(room(), floors=(0.0,))
    touching = surface.move((2.0, 2.0, 0.0), -math.pi / 2, 3.0)
    grazing = surface.move(touching.position, -math.radians(slope_deg), 0.25)
    assert touching.collided and grazing.collided
    # habitat-sim's agent stands on the border itself: it does not move at all.
    assert math.dist(grazing.position, touching.position) < 1e-3


def test_points_off_the_surface() -> None:
    surface = NavigableSurface.build(room(extra=[CRATE]), floors=(0.0,))
    inside_crate = (4.5, 2.8, 0.0)
    assert not surface.is_navigable(inside_crate)
    snapped = surface.snap(inside_crate, 1.0)
    assert snapped is not None
    assert surface.is_navigable(snapped)
    assert surface.snap((50.0, 50.0, 0.0), 1.0) is None
    assert surface.geodesic_distance((1.0, 1.0, 0.0), inside_crate) == math.inf
    assert surface.distance_field(np.zeros((0, 3))).at((1.0, 1.0, 0.0)) == math.inf


def split_room(gap: tuple[float, float], low: float = 0.0, top: float = 2.5) -> NavigableSurface:
    """Two halves joined by a gap in y through which one passes between heights."""
    parts = [
        ("wall", ((2.9, 0.0, low), (3.1, gap[0], top))),
        ("wall", ((2.9, gap[1], low), (3.1, 4.0, top))),
    ]
    return NavigableSurface.build(room(extra=parts), floors=(0.0,))


@pytest.mark.parametrize(("width", "passes"), [(0.7, True), (0.9, True), (0.3, False)])
def test_doors_pass_an_agent_of_18_cm_radius(width: float, passes: bool) -> None:
    surface = split_room((2.0 - width / 2, 2.0 + width / 2))
    distance = surface.geodesic_distance((1.5, 2.0, 0.0), (4.5, 2.0, 0.0))
    assert math.isfinite(distance) == passes


@pytest.mark.parametrize(("clearance", "passes"), [(0.8, False), (1.0, True)])
def test_low_beams_stop_an_agent_of_88_cm(clearance: float, passes: bool) -> None:
    beam = ("wall", ((2.9, 0.0, clearance), (3.1, 4.0, 2.5)))
    surface = NavigableSurface.build(room(extra=[beam]), floors=(0.0,))
    assert math.isfinite(surface.geodesic_distance((1, 2, 0), (5, 2, 0))) == passes


@pytest.mark.parametrize(("height", "passes"), [(0.15, True), (0.25, False)])
def test_steps_up_to_20_cm_are_climbed(height: float, passes: bool) -> None:
    platform = ("floor", ((3.0, 0.0, 0.0), (6.0, 4.0, height)))
    surface = NavigableSurface.build(room(extra=[platform]))
    distance = surface.geodesic_distance((1.0, 2.0, 0.0), (5.0, 2.0, height))
    assert math.isfinite(distance) == passes


def test_stairs_join_two_floors_both_ways() -> None:
    steps = [("stairs", ((1.5 + 0.3 * k, 0.0, 0.0), (6.0, 1.5, 0.17 * (k + 1)))) for k in range(8)]
    surface = NavigableSurface.build(boxes([
        ("floor", ((0.0, 0.0, -0.1), (6.0, 4.0, 0.0))), *steps,
    ]))  # fmt: skip
    low, high = np.array([0.7, 0.75, 0.0]), np.array([5.0, 0.75, 1.36])
    up, down = surface.geodesic_distance(low, high), surface.geodesic_distance(high, low)
    assert up == pytest.approx(down, rel=0.03)
    assert 4.3 < up < 5.6
    position = low
    for _ in range(18):
        motion = surface.move(position, 0.0, 0.25)
        assert not motion.collided or position[0] > 4.5
        position = motion.position
    assert position[2] == pytest.approx(1.36, abs=0.01)


def test_a_scene_without_floor_is_refused() -> None:
    wall = boxes([("wall", ((0.0, 0.0, 0.0), (0.05, 3.0, 2.0)))])
    with pytest.raises(SceneError, match="no floor"):
        NavigableSurface.build(wall)
