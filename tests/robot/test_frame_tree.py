"""Where the camera sits, as /tf tells it: chains of transforms, in any order of arrival."""

from __future__ import annotations

import math
from types import SimpleNamespace

import numpy as np
import pytest

from toponav.geometry import Pose
from toponav.robot.config import CameraConfig
from toponav.robot.frame_tree import FrameTree
from toponav.robot.frames import FrameReader, camera_mount


def transform(parent: str, child: str, pose: Pose) -> SimpleNamespace:
    """A geometry_msgs/TransformStamped."""
    at = SimpleNamespace(**dict(zip("xyz", pose.translation, strict=True)))
    turn = SimpleNamespace(**dict(zip("xyzw", pose.quaternion_xyzw, strict=True)))
    return SimpleNamespace(
        header=SimpleNamespace(frame_id=parent),
        child_frame_id=child,
        transform=SimpleNamespace(translation=at, rotation=turn),
    )


def told(*transforms: SimpleNamespace) -> SimpleNamespace:
    """A tf2_msgs/TFMessage."""
    return SimpleNamespace(transforms=list(transforms))


UP = Pose.from_yaw(0.0, (0.0, 0.0, 0.3))
AHEAD = Pose.from_yaw(0.5, (0.3, 0.1, 0.1))


def test_frames_are_joined_along_the_chain_whichever_comes_first() -> None:
    tree = FrameTree()
    assert tree.between("base", "camera") is None
    tree.take(told(transform("trunk", "camera", AHEAD)))
    assert tree.between("base", "camera") is None
    tree.take(told(transform("/base", "/trunk", UP)))
    joined = tree.between("base", "camera")
    assert joined is not None
    np.testing.assert_allclose(joined.matrix, (UP @ AHEAD).matrix, atol=1e-9)


def test_frames_are_joined_through_a_common_parent_and_the_newest_counts() -> None:
    tree = FrameTree()
    tree.take(told(transform("trunk", "base", UP), transform("trunk", "camera", UP)))
    tree.take(told(transform("trunk", "camera", AHEAD)))
    joined = tree.between("base", "camera")
    assert joined is not None
    np.testing.assert_allclose(joined.matrix, (UP.inverse() @ AHEAD).matrix, atol=1e-9)


def test_frames_in_a_circle_end() -> None:
    tree = FrameTree()
    tree.take(told(transform("a", "b", UP), transform("b", "a", UP)))
    assert tree.between("base", "a") is None


def info(frame: str) -> SimpleNamespace:
    return SimpleNamespace(
        header=SimpleNamespace(frame_id=frame), width=4, height=3, k=np.eye(3).ravel()
    )


def test_the_reader_says_what_it_waits_for_and_then_knows_where_the_camera_sits() -> None:
    camera = CameraConfig(xyz=(0.3, 0.0, 0.45), tilt_deg=5.0)
    mount = camera_mount(camera)
    reader = FrameReader(camera.model_copy(update={"extrinsics": "tf"}))
    assert reader.base_from_camera is None
    reader.take_info(info("optical"))
    assert reader.lacks == "no transform from base_footprint to optical on /tf"
    reader.take_transforms(told(transform("base_footprint", "optical", mount)))
    assert reader.lacks == ""
    assert reader.base_from_camera is not None
    np.testing.assert_allclose(reader.base_from_camera.matrix, mount.matrix, atol=1e-9)


def test_a_camera_of_the_robot_s_file_is_not_moved_by_transforms() -> None:
    reader = FrameReader(CameraConfig())
    reader.take_transforms(told(transform("base_footprint", "optical", AHEAD)))
    assert reader.base_from_camera is not None
    assert reader.base_from_camera.translation[2] == pytest.approx(0.88)
    assert math.isclose(reader.base_from_camera.translation[0], 0.0, abs_tol=1e-9)
