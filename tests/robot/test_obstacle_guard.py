"""The guard lets the robot drive only as fast as it can still stop."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from toponav.geometry import Intrinsics, Pose
from toponav.geometry.conventions import BODY_FROM_OPTICAL
from toponav.mapping.view import OCCUPIED, OccupancyGrid
from toponav.robot.footprint import Footprint
from toponav.robot.motion import MotionConfig
from toponav.robot.obstacle_guard import GuardConfig, ObstacleGuard

CAMERA = Intrinsics.from_hfov(160, 120, 79.0)
CONFIG = GuardConfig(creep_speed=99.0)
"""Walls alone count: how unseen floor slows the robot down has its own test."""
MOTION = MotionConfig()
ROUND = Footprint()


def facing_wall(distance: float) -> tuple[ObstacleGuard, Pose]:
    """A guard that sees a wall so far ahead of the base."""
    guard = ObstacleGuard(CONFIG, ROUND, MOTION)
    pose = Pose.from_yaw(0.7, (3.0, -2.0, 0.0))
    camera = pose @ Pose.from_rotation(np.eye(3), (0.0, 0.0, 0.5)) @ BODY_FROM_OPTICAL
    depth = np.full((120, 160), distance, np.float32)
    guard.see(depth, CAMERA, camera, pose, 0.0)
    return guard, pose


@given(st.floats(0.4, 1.4))
def test_the_allowed_speed_stops_before_the_wall(distance) -> None:
    guard, pose = facing_wall(distance)
    speed = guard.limit(pose)
    needed = speed * CONFIG.reaction_s + speed**2 / (2.0 * MOTION.acceleration)
    assert needed + ROUND.turning_radius_m <= distance + 0.03
    free = guard.free_ahead(pose)
    assert free == pytest.approx(distance - ROUND.turning_radius_m, abs=0.05)


def test_beside_and_behind_the_robot_nothing_counts() -> None:
    guard, pose = facing_wall(1.0)
    aside = Pose.from_yaw(pose.yaw + math.pi, pose.translation)
    assert guard.limit(aside) > 10.0
    assert guard.limit(pose) < 10.0


def test_what_the_camera_no_longer_sees_is_remembered_for_a_while_and_then_forgotten() -> None:
    guard, pose = facing_wall(0.5)
    nothing = np.zeros((120, 160), np.float32)
    camera = pose @ BODY_FROM_OPTICAL
    guard.see(nothing, CAMERA, camera, pose, CONFIG.memory_s - 0.1)
    assert guard.limit(pose) < 10.0
    assert guard.limit(pose, turn_rate=0.1) < 10.0
    guard.see(nothing, CAMERA, camera, pose, CONFIG.memory_s + 0.1)
    assert guard.limit(pose) > 10.0


def test_what_has_gone_is_seen_to_be_gone() -> None:
    guard, pose = facing_wall(0.9)
    assert guard.limit(pose) < 10.0
    camera = pose @ Pose.from_rotation(np.eye(3), (0.0, 0.0, 0.5)) @ BODY_FROM_OPTICAL
    guard.see(np.full((120, 160), 3.0, np.float32), CAMERA, camera, pose, 1.0)
    assert guard.limit(pose) > 10.0


def test_a_turning_robot_looks_where_it_turns_to() -> None:
    guard, pose = facing_wall(0.6)
    aside = Pose.from_yaw(pose.yaw + 2.2, pose.translation)
    assert guard.limit(aside) > 10.0
    assert guard.limit(aside, turn_rate=-4.0) < 10.0


def test_the_floor_and_what_hangs_overhead_are_no_obstacles() -> None:
    guard = ObstacleGuard(CONFIG, ROUND, MOTION)
    camera = Pose.from_rotation(np.eye(3), (0.0, 0.0, 0.5)) @ BODY_FROM_OPTICAL
    rows = np.arange(120)[:, None] - CAMERA.cy
    with np.errstate(divide="ignore"):
        floor = np.where(rows > 5, 0.5 * CAMERA.fy / rows, 0.0)
    depth = np.broadcast_to(floor, (120, 160)).astype(np.float32)
    guard.see(depth, CAMERA, camera, Pose.identity(), 0.0)
    assert guard.limit(Pose.identity()) > 10.0


def test_where_the_floor_was_not_seen_the_robot_creeps() -> None:
    guard = ObstacleGuard(GuardConfig(), ROUND, MOTION)
    camera = Pose.from_rotation(np.eye(3), (0.0, 0.0, 0.5)) @ BODY_FROM_OPTICAL
    rows = np.arange(120)[:, None] - CAMERA.cy
    with np.errstate(divide="ignore"):
        floor = np.where(rows > 5, 0.5 * CAMERA.fy / rows, 0.0)
    depth = np.broadcast_to(floor, (120, 160)).astype(np.float32)
    guard.see(depth, CAMERA, camera, Pose.identity(), 0.0)
    blind = Pose.identity()
    assert guard.limit(blind) == GuardConfig().creep_speed
    assert guard.limit(Pose.from_yaw(0.0, (1.0, 0.0, 0.0))) == math.inf


def test_the_map_s_obstacles_count_for_good() -> None:
    guard = ObstacleGuard(CONFIG, ROUND, MOTION)
    cells = np.zeros((20, 20), np.int8)
    cells[15, 9:11] = OCCUPIED
    guard.consult(OccupancyGrid(cells, (-1.0, -1.0), 0.1))
    assert guard.free_ahead(Pose.identity()) == pytest.approx(
        0.55 - ROUND.turning_radius_m, abs=0.02
    )
