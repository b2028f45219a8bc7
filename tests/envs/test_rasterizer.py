"""The rasteriser against brute force, closed surfaces and Embree."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from box_scenes import mesh_of, room
from ray_reference import brute_force

from shared_data import shared_data
from toponav.envs.simulator.rasterizer import NEAR_M, NO_FACE, Rasterizer
from toponav.envs.simulator.raycaster import RayCaster
from toponav.envs.simulator.renderer import Renderer
from toponav.geometry import Intrinsics, Pose
from toponav.geometry.conventions import BODY_FROM_OPTICAL
from toponav.scenes.loading import load_scene

FORWARD = Pose.identity() @ BODY_FROM_OPTICAL
"""A camera at the origin that looks along +x."""

SQUARE = Intrinsics(width=41, height=41, fx=20.0, fy=20.0, cx=20.0, cy=20.0)


def random_pose(rng: np.random.Generator) -> Pose:
    return Pose.from_quaternion(rng.standard_normal(4), rng.uniform(-0.5, 0.5, 3))


@pytest.mark.parametrize("seed", range(20))
def test_random_triangles_on_all_sides_agree_with_brute_force(seed: int) -> None:
    rng = np.random.default_rng(seed)
    # Triangles about the camera: some reach from before it to behind it.
    centers = rng.uniform(-3, 3, (120, 1, 3))
    corners = centers + rng.uniform(-0.9, 0.9, (120, 3, 3))
    mesh = mesh_of(corners.reshape(-1, 3), np.arange(360).reshape(-1, 3))
    fx, fy, cx, cy = rng.uniform((12, 12, 10, 8), (30, 30, 45, 34))
    camera = Intrinsics(57, 43, fx, fy, cx, cy)
    pose = random_pose(rng)
    rays = camera.rays().reshape(-1, 3) @ pose.rotation.T
    distance, expected = brute_force(mesh, pose.translation, rays)
    expected[distance < NEAR_M] = NO_FACE
    visible = Rasterizer(mesh).visible_faces(pose, camera).ravel()
    assert (expected >= 0).sum() > 300
    assert len(np.unique(expected)) > 4
    np.testing.assert_array_equal(visible, expected)


@pytest.mark.parametrize("seed", range(10))
def test_a_closed_surface_has_no_gaps(seed: int) -> None:
    ball = trimesh.creation.icosphere(subdivisions=4, radius=2.0)
    mesh = mesh_of(ball.vertices, ball.faces)
    visible = Rasterizer(mesh).visible_faces(
        random_pose(np.random.default_rng(seed)), Intrinsics.from_hfov(320, 240, 100.0)
    )
    assert (visible != NO_FACE).all()


def test_edges_through_pixel_centres_belong_to_some_triangle() -> None:
    # Vertices of the grid project onto whole pixels, its diagonals pass through pixel centres.
    steps = np.arange(-3, 4)
    y, z = (axis.ravel() for axis in np.meshgrid(steps, steps))
    vertices = np.column_stack([np.full(len(y), 2.0), y, z])
    corner = (np.arange(6)[:, None] * 7 + np.arange(6)).ravel()
    faces = np.concatenate(
        [
            np.column_stack([corner, corner + 1, corner + 8]),
            np.column_stack([corner, corner + 8, corner + 7]),
        ]
    )
    visible = Rasterizer(mesh_of(vertices, faces)).visible_faces(FORWARD, SQUARE)
    assert (visible != NO_FACE).all()
    assert len(np.unique(visible)) >= 32  # four by four squares are in view, others at its border


def test_the_nearer_triangle_is_seen_whatever_their_order() -> None:
    def wall(x: float) -> list[tuple[float, float, float]]:
        return [(x, 9, -9), (x, -9, -9), (x, 0, 9)]

    near_last = mesh_of(wall(3.0) + wall(2.0), [(0, 1, 2), (3, 4, 5)])
    near_first = mesh_of(wall(2.0) + wall(3.0), [(0, 1, 2), (3, 4, 5)])
    assert (Rasterizer(near_last).visible_faces(FORWARD, SQUARE)[20] == 1).all()
    assert (Rasterizer(near_first).visible_faces(FORWARD, SQUARE)[20] == 0).all()


def test_of_coinciding_triangles_the_first_is_seen_from_both_sides() -> None:
    vertices = [(2, 9, -9), (2, -9, -9), (2, 0, 9)]
    mesh = mesh_of(vertices, [(0, 1, 2), (2, 1, 0), (1, 2, 0)])
    behind = Pose.from_yaw(np.pi, (4.0, 0.0, 0.0)) @ BODY_FROM_OPTICAL
    for pose in (FORWARD, behind):
        assert (Rasterizer(mesh).visible_faces(pose, SQUARE)[20] == 0).all()


@pytest.mark.parametrize(
    "vertices",
    [
        [(-2, 1, -1), (-2, -1, -1), (-2, 0, 1)],  # behind the camera
        [(NEAR_M / 2, 1, -1), (NEAR_M / 2, -1, -1), (NEAR_M / 2, 0, 1)],  # touching it
        [(2, 5, -1), (2, 7, -1), (2, 6, 1)],  # beside the view
        [(2, 1, 5), (2, -1, 5), (2, 0, 7)],  # above it
        [(1, 0, 0), (3, 0, 0), (3, 2, 0)],  # edge-on
        [(2, 1, 1), (2, 1, 1), (2, -1, -1)],  # a segment
        [(2, 0.01, 0.01), (2, 0.02, 0.01), (2, 0.01, 0.02)],  # between pixel centres
    ],
)
def test_what_no_pixel_sees_is_not_drawn(vertices: list[tuple[float, float, float]]) -> None:
    visible = Rasterizer(mesh_of(vertices, [(0, 1, 2)])).visible_faces(FORWARD, SQUARE)
    assert (visible == NO_FACE).all()


def test_an_image_of_one_pixel() -> None:
    mesh = mesh_of([(2, 1, -1), (2, -1, -1), (2, 0, 1)], [(0, 1, 2)])
    camera = Intrinsics(1, 1, 1.0, 1.0, 0.0, 0.0)
    assert Rasterizer(mesh).visible_faces(FORWARD, camera).tolist() == [[0]]


def test_both_ways_of_finding_triangles_give_the_same_images() -> None:
    # The table stands clear of the walls: no two surfaces coincide.
    mesh = room(extra=[("table", ((3.0, 1.5, 0.1), (4.0, 2.5, 0.8)))])
    camera = Intrinsics.from_hfov(160, 120, 79.0)
    pose = Pose.from_yaw(0.3, (1.0, 1.7, 0.9)) @ BODY_FROM_OPTICAL
    drawn = Renderer(mesh).render(pose, camera)
    cast = Renderer(mesh, RayCaster(mesh)).render(pose, camera)
    assert len(np.unique(drawn.instance_ids)) > 4
    np.testing.assert_allclose(drawn.depth, cast.depth, rtol=1e-6)
    np.testing.assert_array_equal(drawn.instance_ids, cast.instance_ids)
    assert np.abs(drawn.rgb.astype(int) - cast.rgb).max() <= 1


def test_a_furnished_house_looks_as_it_does_to_embree() -> None:
    mesh = load_scene(str(shared_data("scenes/aws_small_house/aws_small_house.glb"))).mesh
    rasterizer, caster = Renderer(mesh), Renderer(mesh, RayCaster(mesh))
    camera = Intrinsics.from_hfov(320, 240, 79.0)
    rng = np.random.default_rng(0)
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    wrong = pixels = 0
    for _ in range(8):
        position = (*rng.uniform(low[:2], high[:2]), 0.88)
        pose = Pose.from_yaw(rng.uniform(-np.pi, np.pi), position) @ BODY_FROM_OPTICAL
        drawn, cast = rasterizer.render(pose, camera), caster.render(pose, camera)
        wrong += int((np.abs(drawn.depth - cast.depth) > 1e-3).sum())
        pixels += int((cast.depth > 0.0).sum())
    assert pixels > 200_000
    assert wrong < 1e-4 * pixels  # rays that graze an edge may go either way
