"""The renderer on OpenGL against Embree, across processes and threads, and without OpenGL."""

from __future__ import annotations

import hashlib
import json
import multiprocessing
import subprocess
import sys
import threading

import numpy as np
import pytest
import trimesh
from box_scenes import mesh_of, room

from shared_data import shared_data
from toponav.envs.simulator import HouseEnv, HouseEnvConfig
from toponav.envs.simulator.navigation import NavigableSurface
from toponav.envs.simulator.opengl import context as gl_context
from toponav.envs.simulator.opengl.shaders import NEAR_M
from toponav.envs.simulator.renderer import RenderedFrame, Renderer
from toponav.envs.simulator.renderers import make_renderer, why_missing
from toponav.envs.simulator.shading import NO_INSTANCE
from toponav.errors import InputError, MissingExtraError
from toponav.geometry import Intrinsics, Pose
from toponav.geometry.conventions import BODY_FROM_OPTICAL
from toponav.scenes.loading import load_scene
from toponav.scenes.mesh import Material, Scene, SceneMesh

CAMERA = Intrinsics.from_hfov(320, 240, 79.0)
FORWARD = Pose.identity() @ BODY_FROM_OPTICAL
IN_ROOM = Pose.from_yaw(0.3, (1.0, 1.7, 0.9)) @ BODY_FROM_OPTICAL

needs_opengl = pytest.mark.skipif(
    "why_missing('gl') is not None", reason="no OpenGL without a display here"
)


def places(scene: Scene, count: int) -> list[Pose]:
    """Cameras where an agent can stand, level or tilted."""
    rng = np.random.default_rng(0)
    surface = NavigableSurface.build(scene.mesh, floors=scene.floors)
    eye = Pose.from_yaw(0.0, (0.0, 0.0, 0.88))
    found = []
    for k in range(count):
        body = Pose.from_yaw(rng.uniform(-np.pi, np.pi), surface.random_point(rng))
        tilt = Pose.from_quaternion((0.0, 0.26 * (k % 3 - 1), 0.0, 1.0), (0.0, 0.0, 0.0))
        found.append(body @ eye @ tilt @ BODY_FROM_OPTICAL)
    return found


def off_edges(depth: np.ndarray) -> np.ndarray:
    """Pixels that see one plane with their neighbours: its inverse depth is linear in the image."""
    inverse = np.divide(1.0, depth, where=depth > 0.0, out=np.full(depth.shape, np.nan))
    level = np.zeros(depth.shape, np.bool_)
    inner = inverse[1:-1, 1:-1]
    across = inverse[1:-1, :-2] + inverse[1:-1, 2:] - 2.0 * inner
    down = inverse[:-2, 1:-1] + inverse[2:, 1:-1] - 2.0 * inner
    level[1:-1, 1:-1] = (np.abs(across) < 1e-5) & (np.abs(down) < 1e-5)
    return level


def textured_room() -> SceneMesh:
    """A room with a table, pictures of several sizes all over it, and coloured corners."""
    base = room(extra=[("table", ((3.0, 1.5, 0.1), (4.0, 2.5, 0.8)))])
    rng = np.random.default_rng(1)
    count = len(base.faces)
    materials = tuple(
        Material(str(k), rng.integers(0, 256, (*size, 3)).astype(np.uint8))
        for k, size in enumerate([(1, 1), (4, 4), (3, 7), (16, 2)])
    )
    return SceneMesh(
        base.vertices,
        base.faces,
        rng.uniform(-3.0, 3.0, (count, 3, 2)).astype(np.float32),
        rng.integers(0, 4, count).astype(np.int32),
        base.face_instance,
        materials,
        base.instances,
        corner_colors=rng.integers(0, 256, (count, 3, 3)).astype(np.uint8),
    )


def scene_called(name: str) -> Scene:
    if name == "textured room":
        return Scene(name, textured_room(), floors=(0.0,))
    if name == "aws":
        return load_scene(str(shared_data("scenes/aws_small_house/aws_small_house.glb")))
    return load_scene(name)


@needs_opengl
@pytest.mark.parametrize("name", ["generated:0", "textured room", "aws"])
def test_opengl_and_embree_agree(name: str) -> None:
    scene = scene_called(name)
    drawn, cast = (make_renderer(which, scene.mesh) for which in ("gl", "embree"))
    textures = seen = compared = 0
    for pose in places(scene, 9):
        ours, theirs = drawn.render(pose, CAMERA), cast.render(pose, CAMERA)
        level = off_edges(theirs.depth)
        compared += int(level.sum())
        assert np.abs(ours.depth - theirs.depth)[level].max(initial=0.0) < 0.01
        assert (ours.instance_ids == theirs.instance_ids).mean() >= 0.99
        near = np.abs(ours.rgb.astype(int) - theirs.rgb).max(axis=2) <= 2
        assert near.mean() >= 0.98  # a texel's edge falls on either side of a pixel's centre
        assert ((ours.depth == 0.0) == (ours.instance_ids == NO_INSTANCE)).all()
        seen += int((theirs.depth > 0.0).sum())
        textures = max(textures, len(np.unique(theirs.rgb.reshape(-1, 3), axis=0)))
    assert seen > 9 * CAMERA.width * CAMERA.height // 3
    assert compared > 0.6 * seen
    assert textures > 100


@needs_opengl
def test_an_unlit_scene_is_shown_as_it_is() -> None:
    square = mesh_of([(2, 9, -9), (2, -9, -9), (2, 0, 9)], [(0, 1, 2)])
    material = Material("plain", np.array([[[10, 120, 230]]], np.uint8))
    mesh = SceneMesh(
        square.vertices, square.faces, square.face_uv, square.face_material,
        square.face_instance, (material,), square.instances, lit=False,
    )  # fmt: skip
    frame = make_renderer("gl", mesh).render(FORWARD, CAMERA)
    assert frame.rgb[120, 160].tolist() == [10, 120, 230]
    assert frame.depth[120, 160] == pytest.approx(2.0, abs=1e-5)


@needs_opengl
def test_nothing_is_black_and_without_depth_or_id() -> None:
    mesh = mesh_of([(5, 0, 0), (5, 1, 0), (5, 0, 1)], [(0, 1, 2)])
    behind = Pose.from_yaw(np.pi, (0.0, 0.0, 0.0)) @ BODY_FROM_OPTICAL
    renderer = make_renderer("gl", mesh)
    assert (renderer.render(FORWARD, CAMERA).instance_ids == 0).any()
    frame = renderer.render(behind, CAMERA)  # what was drawn before is gone
    assert not frame.depth.any()
    assert not frame.rgb.any()
    assert (frame.instance_ids == NO_INSTANCE).all()


@needs_opengl
@pytest.mark.parametrize(
    ("forward_m", "depth_m"),
    [(-2.0, 0.5), (0.0, 1.5), (-1.5 - 0.5 * NEAR_M, 3.0 + 0.5 * NEAR_M)],
    ids=["outside", "inside", "too near for the side in front"],
)
def test_both_sides_of_a_box_can_be_seen(forward_m: float, depth_m: float) -> None:
    box = trimesh.creation.box((3.0, 3.0, 3.0))
    pose = Pose.from_yaw(0.0, (forward_m, 0.3, 0.2)) @ BODY_FROM_OPTICAL
    frame = make_renderer("gl", mesh_of(box.vertices, box.faces)).render(pose, CAMERA)
    assert frame.depth[120, 160] == pytest.approx(depth_m, abs=1e-3)


@needs_opengl
def test_far_from_the_origin_depth_is_as_exact() -> None:
    near, far = room(), room()
    far = mesh_of(far.vertices + 300.0, far.faces, far.face_instance, ["wall"] * 6)
    moved = Pose.from_yaw(0.3, (301.0, 301.7, 300.9)) @ BODY_FROM_OPTICAL
    np.testing.assert_allclose(
        make_renderer("gl", near).render(IN_ROOM, CAMERA).depth,
        make_renderer("gl", far).render(moved, CAMERA).depth,
        atol=1e-3,
    )


@needs_opengl
def test_one_renderer_serves_cameras_of_several_sizes() -> None:
    mesh = textured_room()
    drawn, cast = make_renderer("gl", mesh), Renderer(mesh)
    # Neither square pixels nor a principal point in the middle.
    odd = Intrinsics(67, 45, 40.0, 55.0, 20.0, 30.0)
    for camera in (CAMERA, odd, CAMERA):
        ours, theirs = drawn.render(IN_ROOM, camera), cast.render(IN_ROOM, camera)
        level = off_edges(theirs.depth)
        np.testing.assert_allclose(ours.depth[level], theirs.depth[level], atol=1e-3)


@needs_opengl
def test_renderers_of_two_scenes_take_turns() -> None:
    one, two = make_renderer("gl", textured_room()), make_renderer("gl", room())
    first = one.render(IN_ROOM, CAMERA)
    two.render(IN_ROOM, CAMERA)
    assert digest(one.render(IN_ROOM, CAMERA)) == digest(first)


def digest(frame: RenderedFrame) -> str:
    parts = (frame.rgb, frame.depth, frame.instance_ids)
    return hashlib.sha256(b"".join(part.tobytes() for part in parts)).hexdigest()


def render_once() -> str:
    return digest(make_renderer("gl", textured_room()).render(IN_ROOM, CAMERA))


@needs_opengl
def test_the_same_pose_gives_the_same_image_in_every_process_and_thread() -> None:
    renderer = make_renderer("gl", textured_room())
    expected = digest(renderer.render(IN_ROOM, CAMERA))
    assert digest(renderer.render(IN_ROOM, CAMERA)) == expected
    in_thread: list[str] = []
    thread = threading.Thread(
        target=lambda: in_thread.append(digest(renderer.render(IN_ROOM, CAMERA)))
    )
    thread.start()
    thread.join()
    assert in_thread == [expected]
    with multiprocessing.get_context("spawn").Pool(2) as pool:
        assert pool.starmap(render_once, [()] * 2) == [expected] * 2


FORK = """
import json, multiprocessing, sys
sys.path.insert(0, "tests/envs"), sys.path.insert(0, "tests")
from test_opengl import IN_ROOM, CAMERA, digest, make_renderer, textured_room

renderer = make_renderer("gl", textured_room())

def render(queue):
    try:
        queue.put(digest(renderer.render(IN_ROOM, CAMERA)))
    except Exception as error:
        queue.put(str(error))

def in_fork():
    context = multiprocessing.get_context("fork")
    queue = context.Queue()
    context.Process(target=render, args=(queue,)).start()
    return queue.get(timeout=60)

before = in_fork()
here = digest(renderer.render(IN_ROOM, CAMERA))
print(json.dumps([before, here, in_fork()]))
"""


@needs_opengl
def test_forks_render_unless_opengl_runs_already(request: pytest.FixtureRequest) -> None:
    result = subprocess.run(
        [sys.executable, "-c", FORK],
        cwd=request.config.rootpath,
        capture_output=True,
        text=True,
        check=True,
        timeout=120,
    )
    before, here, after = json.loads(result.stdout)
    assert before == here
    assert "started before this process was forked" in after


@needs_opengl
def test_an_environment_renders_with_opengl_if_told_to() -> None:
    scene = load_scene("generated:0")
    images = {}
    for name in ("raster", "gl"):
        env = HouseEnv(scene, HouseEnvConfig(width=160, height=120, renderer=name))
        env.reset(seed=3)
        images[name] = env.observe()
    assert (images["gl"].depth > 0.0).any()
    differs = np.abs(images["gl"].depth - images["raster"].depth) > 0.01
    assert differs.mean() < 0.01


def test_the_default_renderer_is_the_deterministic_one() -> None:
    assert HouseEnvConfig().renderer == "raster"


@pytest.mark.parametrize("library", ["LIBEGL", "LIBGL"])
def test_without_egl_the_message_names_extra_and_packages(
    monkeypatch: pytest.MonkeyPatch, library: str
) -> None:
    pytest.importorskip("moderngl")
    monkeypatch.setattr(gl_context, library, "libNowhere.so.7")
    monkeypatch.setattr(gl_context, "_of_thread", threading.local())
    reason = why_missing("gl")
    assert reason is not None
    assert "\n" not in reason
    assert "toponav[gl]" in reason
    assert "libegl1 libgl1 libgl1-mesa-dri" in reason


def test_without_moderngl_the_message_names_the_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "moderngl", None)
    with pytest.raises(MissingExtraError, match=r"pip install 'toponav\[gl\]'"):
        make_renderer("gl", room())


@pytest.mark.parametrize(("device", "error"), [("99", MissingExtraError), ("gpu", InputError)])
def test_a_device_that_is_not_there_is_an_error(
    monkeypatch: pytest.MonkeyPatch, device: str, error: type[Exception]
) -> None:
    pytest.importorskip("moderngl")
    monkeypatch.setenv(gl_context.DEVICE_VARIABLE, device)
    monkeypatch.setattr(gl_context, "_of_thread", threading.local())
    with pytest.raises(error):
        gl_context.thread_context()
