"""Recordings: what is read, what is estimated, and what every kind of damage is told as."""

import math
import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image
from scipy.spatial.transform import Rotation

from recorded_hall import CAMERA, CAMERA_HEIGHT, FLOOR_Z, camera_pose, hall_depth, write_recording
from shared_data import shared_data
from toponav.envs.leveling import SurfacePatches, estimate_floor, estimate_up, leveling_rotation
from toponav.envs.recording import WORLD_FROM_AXES, Recording, WorldAxes, open_recording
from toponav.errors import InputError, RecordingError
from toponav.geometry import Pose


@pytest.fixture
def recording(tmp_path: Path) -> Path:
    write_recording(tmp_path / "hall", Pose.identity())
    return tmp_path / "hall"


@pytest.mark.parametrize("axes", list(WORLD_FROM_AXES))
@pytest.mark.parametrize("told", [True, False])
def test_poses_come_out_z_up_whatever_the_worlds_axes(
    tmp_path: Path, axes: WorldAxes, told: bool
) -> None:
    poses = write_recording(tmp_path, WORLD_FROM_AXES[axes].inverse())
    opened = open_recording(tmp_path, axes if told else None)
    assert len(opened) == len(poses)
    for got, expected in zip(opened.poses, poses, strict=True):
        np.testing.assert_allclose(got.matrix, expected.matrix, atol=1e-6)
    assert opened.floor_z == pytest.approx(FLOOR_Z, abs=0.01)


def test_a_tilted_world_is_levelled(tmp_path: Path) -> None:
    tilt = Pose.from_rotation(
        Rotation.from_euler("xyz", [20.0, -10.0, 0.0], degrees=True).as_matrix(), (1.0, 2.0, 3.0)
    )
    poses = write_recording(tmp_path, tilt)
    opened = open_recording(tmp_path, "z-up")
    for got, expected in zip(opened.poses, poses, strict=True):
        up_in_camera = got.rotation.T @ [0.0, 0.0, 1.0]
        expected_up = expected.rotation.T @ [0.0, 0.0, 1.0]
        assert math.degrees(math.acos(min(1.0, up_in_camera @ expected_up))) < 0.3
    assert opened.floor_z is not None
    heights = [pose.translation[2] - opened.floor_z for pose in opened.poses]
    np.testing.assert_allclose(heights, CAMERA_HEIGHT, atol=0.03)


def test_observations_hold_what_was_recorded(recording: Path) -> None:
    opened = open_recording(recording)
    observation = opened.observation(3)
    pose = camera_pose(0.6, 0.2)
    expected = hall_depth(pose).astype(np.float32)
    expected[0, :2] = 0.0
    np.testing.assert_allclose(observation.depth, expected, atol=6e-4)
    assert observation.rgb[5, 7].tolist() == [3, 20, 30]
    assert observation.step == 3
    assert observation.timestamp_s == pytest.approx(30 / 30.0)
    np.testing.assert_allclose(
        observation.world_from_base.translation, (0.6, 0.0, FLOOR_Z), atol=0.01
    )
    assert observation.world_from_base.yaw == pytest.approx(0.2)
    assert len(list(opened)) == 6


def test_a_thinned_recording_keeps_every_nth_frame(recording: Path) -> None:
    opened = open_recording(recording)
    thinned = opened.every(4)
    assert [frame.number for frame in thinned.frames] == [0, 40]
    assert thinned.observation(1).rgb[0, 0, 0] == 4
    assert thinned.floor_z == opened.floor_z
    with pytest.raises(InputError, match="at least 1"):
        opened.every(0)


def test_a_camera_that_looks_straight_down_heads_where_its_upper_edge_points(
    tmp_path: Path,
) -> None:
    write_recording(tmp_path, Pose.identity(), metadata={"floor_z": 0.0, "gravity_aligned": True})
    down = Pose.from_yaw(0.7, (0.0, 0.0, 1.0)) @ Pose.from_rotation(
        np.array([[0.0, -1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, -1.0]]), np.zeros(3)
    )
    np.savetxt(tmp_path / "frame-000000.pose.txt", down.matrix)
    assert open_recording(tmp_path, "z-up").observation(0).world_from_base.yaw == pytest.approx(0.7)


def test_metadata_settles_what_would_be_estimated(tmp_path: Path) -> None:
    metadata = {
        "world": "y-up",
        "gravity_aligned": True,
        "depth_scale": 0.002,
        "camera_height": 0.5,
        "frame_rate_hz": 10.0,
    }
    write_recording(tmp_path, WORLD_FROM_AXES["y-up"].inverse(), metadata=metadata)
    opened = open_recording(tmp_path)
    assert opened.floor_z is None
    observation = opened.observation(2)
    z = observation.world_from_camera.translation[2]
    assert observation.world_from_base.translation[2] == pytest.approx(z - 0.5)
    assert observation.timestamp_s == pytest.approx(2.0)
    np.testing.assert_allclose(
        observation.depth[60, 80], 2.0 * hall_depth(camera_pose(0.4, -0.1))[60, 80], atol=2e-3
    )


def test_the_caller_overrules_the_metadata(tmp_path: Path) -> None:
    poses = write_recording(
        tmp_path, WORLD_FROM_AXES["y-down"].inverse(), metadata={"world": "z-up"}
    )
    opened = open_recording(tmp_path, "y-down")
    np.testing.assert_allclose(opened.poses[0].matrix, poses[0].matrix, atol=1e-6)


def truncate(path: Path) -> None:
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])


def write_matrix(path: Path, matrix: NDArray[np.float64]) -> None:
    np.savetxt(path, matrix)


def with_nan(path: Path) -> None:
    pose = np.loadtxt(path)
    pose[0, 3] = np.nan
    np.savetxt(path, pose)


def halved_image(path: Path) -> None:
    with Image.open(path) as image:
        half = image.resize((CAMERA.width // 2, CAMERA.height // 2), Image.Resampling.NEAREST)
    half.save(path)


Damage = Callable[[Path], None]
DAMAGES: dict[str, tuple[str, Damage, str]] = {
    "no pose": ("frame-000020.pose.txt", Path.unlink, r"no \.pose file"),
    "no depth": ("frame-000020.depth.png", Path.unlink, r"no \.depth file"),
    "no colour": ("frame-000020.color.png", Path.unlink, r"no \.color file"),
    "truncated depth": ("frame-000020.depth.png", truncate, "damaged or not an image"),
    "truncated colour": ("frame-000020.color.png", truncate, "damaged or not an image"),
    "empty depth": ("frame-000020.depth.png", lambda p: p.write_bytes(b""), "damaged or not"),
    "text for depth": ("frame-000020.depth.png", lambda p: p.write_text("hello"), "damaged or not"),
    "NaN pose": ("frame-000020.pose.txt", with_nan, "NaN"),
    "words in a pose": ("frame-000020.pose.txt", lambda p: p.write_text("lost"), "4 x 4 matrix"),
    "short pose": ("frame-000020.pose.txt", lambda p: p.write_text("1 0 0"), "3 numbers"),
    "scaled pose": (
        "frame-000020.pose.txt",
        lambda p: write_matrix(p, np.diag([2.0, 2.0, 2.0, 1.0])),
        "not a rotation",
    ),
    "mirrored pose": (
        "frame-000020.pose.txt",
        lambda p: write_matrix(p, np.diag([1.0, 1.0, -1.0, 1.0])),
        "not a rotation",
    ),
    "no intrinsics": ("camera-intrinsics.txt", Path.unlink, "is missing"),
    "intrinsics of a larger image": (
        "camera-intrinsics.txt",
        lambda p: write_matrix(p, CAMERA.matrix * [[4.0], [4.0], [1.0]]),
        "scale it to their size",
    ),
    "intrinsics with a negative focal length": (
        "camera-intrinsics.txt",
        lambda p: write_matrix(p, CAMERA.matrix * [[-1.0, 1.0, 1.0]] * 1),
        "positive",
    ),
    "small colour image": ("frame-000020.color.png", halved_image, "80 x 60.*160 x 120"),
    "small depth image": ("frame-000020.depth.png", halved_image, "80 x 60.*160 x 120"),
    "colour for depth": (
        "frame-000020.depth.png",
        lambda p: shutil.copy(p.with_name("frame-000020.color.png"), p),
        "not a depth image",
    ),
    "depth for colour": (
        "frame-000020.color.png",
        lambda p: shutil.copy(p.with_name("frame-000020.depth.png"), p),
        "not an RGB image",
    ),
    "broken metadata": ("recording.json", lambda p: p.write_text("{"), "not readable JSON"),
    "unknown metadata": ("recording.json", lambda p: p.write_text('{"worlds": 1}'), "worlds"),
    "impossible metadata": (
        "recording.json",
        lambda p: p.write_text('{"depth_scale": 0}'),
        "depth_scale",
    ),
}


@pytest.mark.parametrize("kind", DAMAGES)
def test_damage_is_one_line_that_names_the_file(recording: Path, kind: str) -> None:
    name, damage, message = DAMAGES[kind]
    damage(recording / name)
    with pytest.raises(RecordingError, match=message) as caught:
        list(open_recording(recording, "z-up"))
    text = str(caught.value)
    assert "\n" not in text
    stem = name.split(".")[0]
    assert stem in text


@pytest.mark.parametrize("make", [Path.mkdir, Path.touch, lambda path: None])
def test_a_path_without_frames_is_refused(tmp_path: Path, make: Callable[[Path], None]) -> None:
    make(tmp_path / "nothing")
    with pytest.raises(RecordingError, match="nothing"):
        open_recording(tmp_path / "nothing")


def test_a_camera_held_sideways_cannot_tell_which_axis_is_up(tmp_path: Path) -> None:
    lying = Pose.from_rotation(
        Rotation.from_euler("x", 90.0, degrees=True).as_matrix(), np.zeros(3)
    )
    sideways = Pose.from_rotation(
        Rotation.from_euler("z", 90.0, degrees=True).as_matrix(), np.zeros(3)
    )
    write_recording(tmp_path, sideways @ lying)
    with pytest.raises(RecordingError, match="say one of z-up, y-up, y-down"):
        open_recording(tmp_path)


def test_without_a_floor_in_sight_the_user_is_asked_for_it(tmp_path: Path) -> None:
    write_recording(tmp_path, Pose.identity())
    for path in tmp_path.glob("*.depth.png"):
        Image.fromarray(np.zeros((CAMERA.height, CAMERA.width), np.uint16)).save(path)
    with pytest.raises(RecordingError, match="floor_z or camera_height"):
        open_recording(tmp_path)
    (tmp_path / "recording.json").write_text('{"floor_z": -0.4}')
    assert open_recording(tmp_path).floor_z == -0.4


@pytest.mark.parametrize("seed", range(5))
def test_up_and_floor_are_found_among_walls_tables_and_noise(seed: int) -> None:
    rng = np.random.default_rng(seed)
    tilt = Rotation.from_euler("xy", rng.uniform(-25.0, 25.0, 2), degrees=True).as_matrix()

    def plane(normal: tuple[float, float, float], height: float, count: int) -> SurfacePatches:
        points = rng.uniform(-3.0, 3.0, (count, 3))
        points[:, 2] = np.where(normal[2] > 0.0, height, points[:, 2])
        normals = np.array(normal) + rng.normal(0.0, 0.05, (count, 3))
        return SurfacePatches(points, normals / np.linalg.norm(normals, axis=1, keepdims=True))

    parts = [
        plane((0.0, 0.0, 1.0), -1.3, 800),
        plane((0.0, 0.0, 1.0), -0.5, 5000),
        plane((1.0, 0.0, 0.0), 0.0, 4000),
        plane((0.0, -1.0, 0.0), 0.0, 4000),
        plane((0.0, 0.0, 1.0), -2.0, 40),
    ]
    level = SurfacePatches(
        np.concatenate([part.points for part in parts]),
        np.concatenate([part.normals for part in parts]),
    )
    up = estimate_up(level.rotated(tilt))
    assert up is not None
    assert math.degrees(math.acos(min(1.0, up @ tilt[:, 2]))) < 0.5
    np.testing.assert_allclose(leveling_rotation(up) @ up, (0.0, 0.0, 1.0), atol=1e-12)
    assert estimate_floor(level) == pytest.approx(-1.3, abs=0.01)


def test_the_kitchen_is_levelled_and_stands_on_its_floor() -> None:
    """7-Scenes' worlds are tilted like the first camera; a counter is 0.6 to 0.8 m high."""
    opened: Recording = open_recording(shared_data("rgbd/7scenes-redkitchen"))
    assert len(opened) == 100
    assert opened.floor_z is not None
    heights = np.array([pose.translation[2] for pose in opened.poses]) - opened.floor_z
    assert 1.0 < heights.min() < heights.max() < 2.2
    up = [-pose.rotation[2, 1] for pose in opened.poses]
    assert np.mean(up) > 0.8
