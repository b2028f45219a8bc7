"""Motions reach their end within the limits; the pilot drives them only when it is safe."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from toponav.geometry import Intrinsics, Pose
from toponav.robot.config import CameraConfig
from toponav.robot.footprint import Footprint
from toponav.robot.frames import FrameReader
from toponav.robot.intent import Follow, Turn
from toponav.robot.motion import STILL, MotionConfig, Twist, motion_of, within_limits
from toponav.robot.obstacle_guard import GuardConfig, ObstacleGuard
from toponav.robot.pilot import Outcome, Pilot
from toponav.robot.watchdog import Watchdog, WatchdogConfig

CONFIG = MotionConfig()


class Unicycle:
    """A body that does what it is told, and checks that it may."""

    def __init__(self, yaw: float = 0.0) -> None:
        self.x = self.y = self.now_s = 0.0
        self.yaw, self.last = yaw, STILL

    @property
    def pose(self) -> Pose:
        return Pose.from_yaw(self.yaw, (self.x, self.y, 0.0))

    def move(self, twist: Twist, step_s: float) -> None:
        assert 0.0 <= twist.speed <= CONFIG.max_speed
        assert abs(twist.turn_rate) <= CONFIG.max_turn_rate
        self.now_s += step_s
        self.yaw += twist.turn_rate * step_s
        self.x += twist.speed * step_s * math.cos(self.yaw)
        self.y += twist.speed * step_s * math.sin(self.yaw)
        self.last = twist


def drive(body: Unicycle, intent, rate: float = 20.0) -> None:
    motion = motion_of(intent, body.pose, CONFIG)
    while (wanted := motion.wanted(body.pose)) is not None:
        body.move(within_limits(wanted, body.last, 1.0 / rate, CONFIG), 1.0 / rate)
        assert body.now_s < 120.0
    body.last = STILL


@given(
    angle=st.floats(-7.0, 7.0), yaw=st.floats(-3.1, 3.1), rate=st.sampled_from([10.0, 20.0, 50.0])
)
def test_any_turn_ends_where_it_should(angle, yaw, rate) -> None:
    body = Unicycle(yaw)
    drive(body, Turn(angle), rate)
    assert math.degrees(body.yaw - yaw) == pytest.approx(math.degrees(angle), abs=5.0)
    assert (body.x, body.y) == (0.0, 0.0)


@given(st.lists(st.floats(-1.2, 1.2), min_size=1, max_size=6), st.floats(-3.1, 3.1))
def test_any_way_is_followed_to_its_end_and_never_left_far(bends, yaw) -> None:
    heading, corners = 0.0, [np.zeros(2)]
    for bend in bends:
        heading += bend
        for _ in range(8):
            corners.append(corners[-1] + 0.1 * np.array([math.cos(heading), math.sin(heading)]))
    way, body, away = np.array(corners), Unicycle(yaw), 0.0
    motion = motion_of(Follow(way), body.pose, CONFIG)
    while (wanted := motion.wanted(body.pose)) is not None:
        body.move(within_limits(wanted, body.last, 0.05, CONFIG), 0.05)
        away = max(away, float(np.hypot(*(way - (body.x, body.y)).T).min()))
        assert body.now_s < 120.0
    assert math.dist((body.x, body.y), way[-1]) <= CONFIG.tolerance_m
    assert away < 0.25


class Robot:
    """A pilot on a body in the open, with all that it needs to know."""

    def __init__(self, keep_out=()) -> None:
        self.watchdog = Watchdog(WatchdogConfig(keep_out=keep_out))
        self.guard = ObstacleGuard(GuardConfig(), Footprint(), CONFIG)
        self.pilot = Pilot(CONFIG, self.watchdog, self.guard)
        self.body = Unicycle()
        self.pilot.begin(AHEAD, self.body.pose)

    def tick(self, *, fed: bool = True) -> Twist:
        """A twentieth of a second, with the senses or without."""
        pose, now_s = self.body.pose, self.body.now_s
        if fed:
            self.watchdog.depth_came(now_s)
            self.watchdog.pose_came(now_s)
            self.guard.see(FLOOR, CAMERA, pose @ PLACED, pose, now_s)
        twist = self.pilot.tick(pose, pose, now_s)
        self.body.move(twist, 0.05)
        return twist


CAMERA = Intrinsics.from_hfov(80, 60, 79.0)
PLACED = FrameReader(CameraConfig(tilt_deg=20.0)).base_from_camera


def bare_floor() -> np.ndarray:
    """(H, W) depth of an endless floor, metres, 0 beyond 5 m and over the horizon."""
    v, u = np.mgrid[: CAMERA.height, : CAMERA.width]
    rays = np.stack([(u - CAMERA.cx) / CAMERA.fx, (v - CAMERA.cy) / CAMERA.fy, np.ones_like(u)], -1)
    down = -(rays @ PLACED.matrix[:3, :3].T)[..., 2]
    depth = np.divide(PLACED.translation[2], down, out=np.zeros_like(down), where=down > 0.0)
    return np.where(depth < 5.0, depth, 0.0).astype(np.float32)


FLOOR = bare_floor()

AHEAD = Follow(np.stack([np.arange(0.1, 5.0, 0.1), np.zeros(49)], axis=-1))


def test_the_pilot_stops_at_once_when_nothing_fresh_comes_and_goes_on_when_it_does() -> None:
    robot = Robot()
    for _ in range(160):  # at first it creeps over the floor below the image
        robot.tick()
    assert robot.body.last.speed == pytest.approx(CONFIG.max_speed)
    begun_s = robot.body.now_s
    while robot.tick(fed=False).speed:
        assert robot.body.now_s - begun_s < 1.0
    assert robot.pilot.objection.startswith("no fresh")
    assert robot.pilot.outcome is Outcome.UNDER_WAY
    there = robot.body.x
    for _ in range(100):
        robot.tick()
    assert robot.body.x > there + 1.0


def test_over_floor_that_was_not_seen_it_creeps() -> None:
    robot = Robot()
    robot.guard.see = lambda *_: None
    for _ in range(100):
        robot.tick()
        assert robot.body.last.speed <= GuardConfig().creep_speed
    assert robot.body.x > 0.3


def test_a_body_that_gets_nowhere_is_blocked() -> None:
    robot = Robot()
    stuck = robot.body.pose
    for k in range(100):
        robot.watchdog.depth_came(0.05 * k)
        robot.watchdog.pose_came(0.05 * k)
        robot.pilot.tick(stuck, stuck, 0.05 * k)
    assert robot.pilot.outcome is Outcome.BLOCKED
    assert robot.pilot.tick(stuck, stuck, 5.0) == STILL


def test_a_keep_out_area_is_not_entered() -> None:
    robot = Robot(keep_out=(((2.0, -1.0), (3.0, -1.0), (3.0, 1.0), (2.0, 1.0)),))
    for _ in range(400):
        robot.tick()
    assert 1.0 < robot.body.x < 2.0
    assert robot.pilot.outcome is Outcome.BLOCKED


def test_stopping_by_hand_is_at_once() -> None:
    robot = Robot()
    for _ in range(20):
        robot.tick()
    robot.pilot.stop()
    assert robot.tick() == STILL
    assert robot.pilot.outcome is Outcome.NONE
