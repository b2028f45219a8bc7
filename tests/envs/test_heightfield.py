"""Which places of hand-made scenes are navigable: clearances, slopes, storeys, thin obstacles."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from box_scenes import boxes, mesh_of, room
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import ValidationError

from shared_data import shared_data
from toponav.envs.simulator.agent_body import AgentBody
from toponav.envs.simulator.navigation import NavigableSurface
from toponav.errors import EpisodeError, InputError, SceneError
from toponav.scenes.mesh import SceneMesh

BODY = AgentBody()
CELL_ERROR_M = 0.5 * math.sqrt(2.0) * BODY.cell_size + 1e-6
"""An obstacle lies in its cells, half a diagonal from their centres at most."""


def joined(first: SceneMesh, vertices: np.ndarray, faces: np.ndarray) -> SceneMesh:
    """A mesh with more triangles."""
    extra = mesh_of(vertices, faces)
    return replace(
        first,
        vertices=np.concatenate([first.vertices, extra.vertices]),
        faces=np.concatenate([first.faces, extra.faces + np.int32(len(first.vertices))]),
        face_uv=np.concatenate([first.face_uv, extra.face_uv]),
        face_material=np.concatenate([first.face_material, extra.face_material]),
        face_instance=np.concatenate([first.face_instance, extra.face_instance]),
    )


def connected(surface: NavigableSurface, start: tuple, goal: tuple) -> bool:
    assert surface.is_navigable(start)
    assert surface.is_navigable(goal)
    return math.isfinite(surface.geodesic_distance(start, goal))


box = st.tuples(
    st.floats(0.5, 4.5), st.floats(0.5, 3.0), st.floats(0.01, 1.0), st.floats(0.01, 1.0)
)


@settings(max_examples=15)
@given(st.lists(box, min_size=1, max_size=5))
def test_the_agents_cylinder_keeps_clear_of_boxes(placed: list[tuple]) -> None:
    extra = [("box", ((x, y, 0.0), (x + w, y + d, 1.5))) for x, y, w, d in placed]
    surface = NavigableSurface.build(room(extra=extra), floors=(0.0,))
    xy = np.random.default_rng(0).uniform((0.0, 0.0), (6.0, 4.0), (400, 2))
    clearance = np.minimum(xy, np.array([6.0, 4.0]) - xy).min(axis=1)
    for x, y, w, d in placed:
        outside = np.maximum(np.maximum([x, y] - xy, xy - [x + w, y + d]), 0.0)
        clearance = np.minimum(clearance, np.linalg.norm(outside, axis=1))
    free = np.array([surface.is_navigable((*p, 0.0)) for p in xy])
    # Both the place and the obstacle may be half a cell's diagonal from their cells' centres.
    assert not free[clearance <= BODY.radius - 2.0 * CELL_ERROR_M].any()
    # Pockets under 1 m2 between boxes are left out; what is connected to the room is not.
    blocked = xy[(clearance > BODY.radius + 2.0 * CELL_ERROR_M) & ~free]
    assert len(blocked) * 24.0 / len(xy) < len(placed) * 1.5 + 1.0
    if len(placed) == 1:
        assert not len(blocked)


@settings(max_examples=15)
@given(st.floats(-1.2, 1.2), st.floats(2.0, 4.0))
def test_a_wall_without_thickness_stops_the_agent_at_any_angle(slant: float, x: float) -> None:
    dx = 2.0 * math.tan(slant) / 2.0
    corners = np.array([(x - dx, 0.0), (x + dx, 4.0)])
    vertices = np.array([(*corners[k], z) for k in (0, 1) for z in (0.0, 1.2)])
    mesh = joined(room(), vertices, np.array([(0, 1, 2), (1, 2, 3)]))
    surface = NavigableSurface.build(mesh, floors=(0.0,))
    middle = corners.mean(axis=0)
    normal = np.array([4.0, -2.0 * dx]) / math.hypot(4.0, 2.0 * dx)
    near, far = middle - 0.5 * normal, middle + 0.5 * normal
    assert not connected(surface, (*near, 0.0), (*far, 0.0))


def table(height: float) -> list:
    legs = [
        ("table", ((x, y, 0.0), (x + 0.02, y + 0.02, height)))
        for x in (2.0, 3.98)
        for y in (1.0, 2.98)
    ]
    return [("table", ((2.0, 1.0, height), (4.0, 3.0, height + 0.03))), *legs]


def test_one_walks_under_a_high_table_but_not_through_its_legs() -> None:
    high = NavigableSurface.build(room(extra=table(1.0)), floors=(0.0,))
    low = NavigableSurface.build(room(extra=table(0.75)), floors=(0.0,))
    under, leg = (3.0, 2.0, 0.0), (2.01, 1.01, 0.0)
    assert connected(high, under, (0.5, 0.5, 0.0))
    assert not high.is_navigable(leg)
    assert not high.is_navigable((leg[0] - 0.12, leg[1], 0.0))
    assert not low.is_navigable(under)
    assert low.is_navigable((1.7, 2.0, 0.0))
    assert not low.is_navigable((1.9, 2.0, 0.0))


def test_the_top_of_a_large_table_is_an_island_of_its_own() -> None:
    surface = NavigableSurface.build(room(extra=table(0.75)), floors=(0.0,))
    top = (3.0, 2.0, 0.78)
    assert surface.is_navigable(top)
    assert surface.island_of(top) != surface.main_island
    assert surface.island_of((0.5, 0.5, 0.0)) == surface.main_island
    assert surface.island_of((3.0, 2.0, 0.0)) is None
    assert not connected(surface, (0.5, 0.5, 0.0), top)
    rng = np.random.default_rng(0)
    assert all(surface.random_point(rng)[2] == 0.0 for _ in range(50))


def test_small_tops_are_no_places_to_be() -> None:
    crate = ("box", ((2.0, 1.0, 0.0), (3.0, 2.0, 0.5)))
    surface = NavigableSurface.build(room(extra=[crate]), floors=(0.0,))
    assert not surface.is_navigable((2.5, 1.5, 0.5))


@pytest.mark.parametrize(("slope_deg", "walks"), [(30.0, True), (44.0, True), (46.0, False)])
def test_slopes_up_to_45_degrees_are_walked(slope_deg: float, walks: bool) -> None:
    run = 1.5
    top = run * math.tan(math.radians(slope_deg))
    profile = [(0.0, 0.0), (2.0, 0.0), (2.0 + run, top), (5.5, top)]
    vertices = np.array([(x, y, z) for x, z in profile for y in (0.0, 2.0)])
    faces = np.array([f for k in (0, 2, 4) for f in ((k, k + 2, k + 1), (k + 1, k + 2, k + 3))])
    surface = NavigableSurface.build(mesh_of(vertices, faces))
    assert connected(surface, (1.0, 1.0, 0.0), (5.0, 1.0, top)) == walks
    if walks:
        place = surface.snap((2.75, 1.0, 0.5 * top))
        assert place is not None
        assert place[2] == pytest.approx(0.5 * top, abs=BODY.cell_size)


@pytest.mark.parametrize(("height", "climbed"), [(0.15, True), (0.5, False)])
def test_low_pyramids_are_stepped_over(height: float, climbed: bool) -> None:
    # Steep flanks: not flat anywhere, but a low one does not stop a wheel.
    base = [(2.9, 1.9), (3.1, 1.9), (3.1, 2.1), (2.9, 2.1)]
    vertices = np.array([*((x, y, 0.0) for x, y in base), (3.0, 2.0, height)])
    faces = np.array([(k, (k + 1) % 4, 4) for k in range(4)])
    surface = NavigableSurface.build(joined(room(), vertices, faces), floors=(0.0,))
    assert surface.is_navigable((3.0, 2.0, height if climbed else 0.0)) == climbed


def test_storeys_are_told_apart_by_height() -> None:
    slabs = [("floor", ((0.0, 0.0, 2.6 * k - 0.1), (4.0 - k, 4.0 - k, 2.6 * k))) for k in range(3)]
    surface = NavigableSurface.build(boxes(slabs))
    for k in range(3):
        point = surface.snap((1.0, 1.0, 2.6 * k + 0.3))
        assert point is not None
        assert point[2] == pytest.approx(2.6 * k)
        assert surface.island_of(point) is not None
    assert not surface.is_navigable((1.0, 1.0, 1.3))
    over = surface.points_over(np.array([[1.0, 1.0], [3.5, 3.5], [9.0, 9.0]]))
    np.testing.assert_allclose(over, [[1.0, 1.0, 0.0], [3.5, 3.5, 0.0]])


def test_floors_tell_the_main_island_from_a_larger_roof() -> None:
    mesh = room()
    outside = NavigableSurface.build(mesh)
    inside = NavigableSurface.build(mesh, floors=(0.0,))
    rng = np.random.default_rng(0)
    assert outside.random_point(rng)[2] == pytest.approx(2.6)
    assert inside.random_point(rng)[2] == pytest.approx(0.0)
    free = (6.0 - 2.0 * BODY.radius) * (4.0 - 2.0 * BODY.radius)
    assert inside.area == pytest.approx(free, rel=0.02)
    with pytest.raises(InputError, match="floor"):
        inside.random_point(rng, floor_z=1.3)


def test_the_order_and_orientation_of_triangles_do_not_matter() -> None:
    mesh = room(extra=table(1.0))
    flipped = replace(mesh, faces=np.ascontiguousarray(mesh.faces[::-1, ::-1]))
    first, second = NavigableSurface.build(mesh).graph, NavigableSurface.build(flipped).graph
    np.testing.assert_array_equal(first.links, second.links)
    np.testing.assert_allclose(first.z, second.z, atol=1e-12)


def test_scenes_that_cannot_be_walked_are_refused_in_one_line() -> None:
    good = room()
    nothing = replace(good, faces=good.faces[:0])
    with pytest.raises(SceneError, match="no triangles"):
        NavigableSurface.build(nothing)
    with pytest.raises(SceneError, match="units"):
        NavigableSurface.build(replace(good, vertices=good.vertices * 1000.0))
    broken = good.vertices.copy()
    broken[0, 0] = np.nan
    with pytest.raises(SceneError, match="NaN"):
        NavigableSurface.build(replace(good, vertices=broken))
    with pytest.raises(EpisodeError, match="snap"):
        NavigableSurface.build(good, floors=(0.0,)).move((0.0, 0.0, 0.0), 0.0, 0.25)


def test_a_body_that_climbs_half_its_height_is_refused() -> None:
    with pytest.raises(ValidationError, match="max_climb"):
        AgentBody(height=0.3, max_climb=0.2)


def test_an_agent_roams_a_real_house_without_leaving_the_floor() -> None:
    from toponav.scenes.loading import load_scene

    path = shared_data("scenes/aws_small_house/aws_small_house.glb")
    scene = load_scene(str(path))
    surface = NavigableSurface.build(scene.mesh, floors=scene.floors)
    assert 110.0 < surface.area < 150.0
    rng = np.random.default_rng(0)
    position, yaw, collisions = surface.random_point(rng), 0.0, 0
    for _ in range(600):
        motion = surface.move(position, yaw, 0.25)
        assert surface.island_of(motion.position) == surface.main_island
        position, collisions = motion.position, collisions + motion.collided
        yaw += math.radians(30.0) * rng.integers(-2, 3) * (motion.collided or rng.random() < 0.2)
    assert 10 < collisions < 400
