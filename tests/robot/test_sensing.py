"""Watchdog, pose jumps, image pairs and configuration of a robot."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from toponav.errors import ConfigError
from toponav.geometry import Pose
from toponav.robot.config import PROFILES, navigator_config, robot_config, robot_yaml
from toponav.robot.frame_sync import FrameSync
from toponav.robot.pose_buffer import PoseBuffer
from toponav.robot.pose_continuity import PoseContinuity
from toponav.robot.watchdog import Watchdog, WatchdogConfig


def test_nothing_moves_before_depth_and_pose_came_and_while_either_is_stale() -> None:
    watchdog = Watchdog(WatchdogConfig(max_depth_silence_s=0.5, max_pose_silence_s=0.2))
    assert watchdog.objection(0.0) == "no fresh pose"
    watchdog.pose_came(0.0)
    assert watchdog.objection(0.0) == "no fresh depth"
    watchdog.depth_came(0.0)
    assert watchdog.objection(0.2) is None
    assert watchdog.objection(0.21) == "no fresh pose"
    watchdog.pose_came(0.51)
    assert watchdog.objection(0.51) == "no fresh depth"


def test_depth_that_was_taken_long_ago_is_not_fresh_however_often_it_comes() -> None:
    watchdog = Watchdog(WatchdogConfig(max_depth_latency_s=1.0))
    watchdog.pose_came(0.0)
    watchdog.depth_came(0.0, latency_s=1.1)
    assert watchdog.objection(0.0) == "depth comes too late"
    watchdog.depth_came(0.0, latency_s=0.3)
    assert watchdog.objection(0.0) is None


def test_a_hold_ends_by_itself() -> None:
    watchdog = Watchdog(WatchdogConfig())
    watchdog.pose_came(0.0)
    watchdog.depth_came(0.0)
    watchdog.hold(0.2, "why")
    assert watchdog.objection(0.1) == "why"
    assert watchdog.objection(0.2) is None


@given(
    jump=st.tuples(st.floats(-2, 2), st.floats(-2, 2), st.floats(-3, 3)).filter(
        lambda j: abs(j[0]) > 0.2 or abs(j[1]) > 0.2 or abs(j[2]) > 0.4
    )
)
def test_jumps_are_taken_out_and_motion_is_left_in(jump) -> None:
    x, y, yaw = jump
    continuity = PoseContinuity(0.5, 1.0)
    moved = Pose.from_yaw(yaw, (x, y, 0.0))
    for k in range(40):
        world = Pose.from_yaw(0.01 * k, (0.01 * k, 0.0, 0.0))
        slam = moved @ world if k >= 20 else world
        pose, jumped = continuity.add(0.02 * k, slam)
        assert jumped == (k == 20)
        np.testing.assert_allclose(pose.translation, world.translation, atol=0.011)
        np.testing.assert_allclose(
            (continuity.slam_from_world @ pose).matrix, slam.matrix, atol=1e-9
        )
    assert continuity.jumps == 1


def steady_poses(seconds: float) -> PoseBuffer:
    poses = PoseBuffer(kept_s=100.0)
    for k in range(round(seconds * 10) + 1):
        poses.add(0.1 * k, Pose.from_yaw(0.0, (0.1 * k, 0.0, 0.0)))
    return poses


def test_pairs_are_found_in_any_order_and_lone_images_are_dropped() -> None:
    sync, poses = FrameSync(("depth", "color"), slop_s=0.02), steady_poses(2.0)
    sync.add("color", 0.51, "c5")
    sync.add("depth", 0.6, "d6")
    sync.add("depth", 0.5, "d5")
    sync.add("color", 0.7, "c7")
    instant = sync.newest(poses)
    assert instant is not None
    assert instant.parts == {"depth": "d5", "color": "c5"}
    assert instant.world_from_base.translation[0] == pytest.approx(0.5)
    assert sync.newest(poses) is None
    sync.add("color", 0.6, "c6")
    newer = sync.newest(poses)
    assert newer is not None
    assert newer.parts == {"depth": "d6", "color": "c6"}


def test_an_image_waits_for_the_pose_that_follows_it() -> None:
    sync, poses = FrameSync(("depth",), 0.02), steady_poses(1.0)
    sync.add("depth", 1.05, "d")
    assert sync.newest(poses) is None
    poses.add(1.1, Pose.identity())
    assert sync.newest(poses) is not None


@pytest.mark.parametrize("name", PROFILES)
def test_every_profile_makes_a_robot_and_an_agent_that_fits_it(name, tmp_path) -> None:
    robot = robot_config(name)
    config = navigator_config(robot)
    assert config.panorama.views == robot.panorama_views
    assert config.panorama.spacing_deg * robot.panorama_views >= 359.0
    assert config.locomotion.planner.radius_m >= robot.footprint.turning_radius_m
    path = tmp_path / "robot.yaml"
    path.write_text(robot_yaml(robot))
    assert robot_config(str(path)) == robot


def test_a_file_overrides_its_profile_and_unknown_keys_are_named(tmp_path) -> None:
    path = tmp_path / "mine.yaml"
    path.write_text("profile: go2_d435i\nmotion:\n  max_speed: 0.2\n")
    robot = robot_config(str(path))
    assert robot.motion.max_speed == 0.2
    assert robot.panorama_views == 9
    path.write_text("motion:\n  max_sped: 0.2\n")
    with pytest.raises(ConfigError, match="max_sped"):
        robot_config(str(path))
    for impossible, said in (
        ("pose_topic: my pose", "pose_topic"),
        ("watchdog: {keep_out: [[[0, 0], [1, 1]]]}", "keep_out"),
        ("camera: [1, 2", "not YAML"),
        ("- generic", "not a mapping"),
    ):
        path.write_text(impossible)
        with pytest.raises(ConfigError, match=said):
            robot_config(str(path))
    with pytest.raises(ConfigError, match="known: generic"):
        robot_config("rover")
