"""Rendered images against analytic rooms and a brute-force ray tracer."""

from __future__ import annotations

import numpy as np
import pytest
from box_scenes import mesh_of, room
from ray_reference import brute_force

from toponav.envs.simulator.raycaster import RayCaster
from toponav.envs.simulator.renderer import Renderer
from toponav.envs.simulator.shading import NO_INSTANCE
from toponav.geometry import Intrinsics, Pose
from toponav.geometry.conventions import BODY_FROM_OPTICAL
from toponav.scenes.mesh import Material, SceneMesh

SIZE = np.array([6.0, 4.0, 2.5])
CAMERA = Intrinsics.from_hfov(64, 48, 79.0)


def camera_pose(rng: np.random.Generator, offset: float = 0.0) -> Pose:
    position = rng.uniform(0.3, SIZE - 0.3) + offset
    body = Pose.from_quaternion(rng.standard_normal(4), position)
    return body @ BODY_FROM_OPTICAL


def analytic_depth(pose: Pose, offset: float = 0.0) -> np.ndarray:
    """Distance along rays with z = 1 to the inside of the box."""
    directions = CAMERA.rays() @ pose.rotation.T
    eye = pose.translation - offset
    with np.errstate(divide="ignore"):
        exits = np.where(directions > 0.0, (SIZE - eye) / directions, -eye / directions)
    return exits.min(axis=-1)


@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize("offset", [0.0, 300.0])
def test_depth_of_a_box_room_is_exact_to_a_millimetre(seed: int, offset: float) -> None:
    scene = room(tuple(SIZE))
    mesh = mesh_of(scene.vertices + offset, scene.faces)
    pose = camera_pose(np.random.default_rng(seed), offset)
    frame = Renderer(mesh).render(pose, CAMERA)
    np.testing.assert_allclose(frame.depth, analytic_depth(pose, offset), atol=1e-3)


@pytest.mark.parametrize("seed", range(6))
def test_rays_agree_with_brute_force_on_random_triangles(seed: int) -> None:
    rng = np.random.default_rng(seed)
    mesh = mesh_of(rng.uniform(-3, 3, (180, 3)), np.arange(180).reshape(-1, 3))
    origin = rng.uniform(-1, 1, 3)
    directions = rng.standard_normal((4000, 3))
    expected, expected_face = brute_force(mesh, origin, directions)
    distance, face = RayCaster(mesh).first_hit(np.tile(origin, (4000, 1)), directions)
    same = face == expected_face
    assert same.mean() > 0.999  # a ray through a shared edge may go either way
    finite = same & np.isfinite(expected)
    assert finite.sum() > 100
    np.testing.assert_allclose(distance[finite], expected[finite], rtol=1e-4)
    assert np.isinf(distance[face < 0]).all()


def test_ids_name_the_instance_that_is_seen() -> None:
    cube = ("box", ((3.0, 1.8, 0.6), (3.4, 2.2, 1.0)))
    mesh = room(extra=[cube])
    pose = Pose.from_yaw(0.0, (1.0, 2.0, 0.8)) @ BODY_FROM_OPTICAL
    frame = Renderer(mesh).render(pose, CAMERA)
    assert mesh.instances[frame.instance_ids[24, 32]].category == "box"
    assert mesh.instances[frame.instance_ids[47, 32]].category == "floor"
    assert mesh.instances[frame.instance_ids[0, 32]].category == "ceiling"


def test_nothing_is_black_and_without_depth_or_id() -> None:
    mesh = mesh_of([(5, 0, 0), (5, 1, 0), (5, 0, 1)], [(0, 1, 2)])
    pose = Pose.from_yaw(np.pi, (0.0, 0.0, 0.0)) @ BODY_FROM_OPTICAL
    frame = Renderer(mesh).render(pose, CAMERA)
    assert not frame.depth.any()
    assert not frame.rgb.any()
    assert (frame.instance_ids == NO_INSTANCE).all()


def test_row_0_of_a_texture_is_its_top_and_it_repeats() -> None:
    colors = np.array([[[250, 0, 0], [0, 250, 0]], [[0, 0, 250], [250, 250, 0]]], np.uint8)
    square = [(2, 1, -1), (2, -1, -1), (2, -1, 1), (2, 1, 1)]
    base = mesh_of(square, [(0, 1, 2), (0, 2, 3)])
    uv = np.array([(0, 0), (1, 0), (1, 1), (0, 1)], np.float32) * 2.0  # two repeats each way
    mesh = SceneMesh(
        base.vertices, base.faces, uv[base.faces], base.face_material, base.face_instance,
        (Material("four", colors),), base.instances,
    )  # fmt: skip
    camera = Intrinsics.from_hfov(80, 80, 2.0 * np.degrees(np.arctan(0.5)))
    frame = Renderer(mesh).render(Pose.identity() @ BODY_FROM_OPTICAL, camera)
    corners = {(10, 10): 0, (10, 30): 1, (30, 10): 2, (30, 30): 3, (50, 50): 0, (70, 30): 3}
    for (row, column), k in corners.items():
        seen, painted = frame.rgb[row, column].astype(float), colors.reshape(-1, 3)[k]
        assert ((seen > 0) == (painted > 0)).all(), (row, column)


def test_corner_colours_multiply_the_texture() -> None:
    base = mesh_of([(2, 1, -1), (2, -1, -1), (2, 0, 1)], [(0, 1, 2)])
    tint = np.tile(np.array([0, 255, 0], np.uint8), (1, 3, 1))
    mesh = SceneMesh(
        base.vertices, base.faces, base.face_uv, base.face_material, base.face_instance,
        base.materials, base.instances, corner_colors=tint,
    )  # fmt: skip
    frame = Renderer(mesh).render(Pose.identity() @ BODY_FROM_OPTICAL, CAMERA)
    seen = frame.rgb[frame.instance_ids == 0]
    assert len(seen)
    assert (seen[:, 1] > 100).all()
    assert not seen[:, [0, 2]].any()


def test_surfaces_that_face_the_camera_are_brighter_than_grazing_ones() -> None:
    def brightness(normal_yaw: float) -> float:
        turn = Pose.from_yaw(normal_yaw, (2.0, 0.0, 0.0))
        square = turn.apply([(0, 1, -1), (0, -1, -1), (0, -1, 1), (0, 1, 1)])
        mesh = mesh_of(square, [(0, 1, 2), (0, 2, 3)])
        frame = Renderer(mesh).render(Pose.identity() @ BODY_FROM_OPTICAL, CAMERA)
        return float(frame.rgb[24, 32].mean())

    assert brightness(0.0) > brightness(1.3) + 5.0
