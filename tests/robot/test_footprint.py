"""One shape of the body: what the guard, the planner and the simulated body take from it agree."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from toponav.errors import ConfigError
from toponav.geometry import Intrinsics, Pose
from toponav.mapping.view import OCCUPIED, OccupancyGrid
from toponav.robot.config import robot_config
from toponav.robot.footprint import Footprint
from toponav.robot.motion import MotionConfig
from toponav.robot.obstacle_guard import GuardConfig, ObstacleGuard

DOG = Footprint(length_m=0.70, width_m=0.31)
BODIES = st.tuples(st.floats(0.1, 0.6), st.floats(0.0, 0.6)).map(
    lambda sizes: Footprint(length_m=sum(sizes), width_m=sizes[0])
)


def covers(body: Footprint, x: float, y: float) -> bool:
    """Whether a point in the base frame lies in a body: near to the line between its ends."""
    nearest = max(-body.end_m, min(body.end_m, x))
    return math.hypot(x - nearest, y) < body.half_width_m


@given(BODIES, st.floats(0.01, 0.7), st.floats(-math.pi, math.pi))
def test_the_half_angle_says_what_the_body_covers(body, away, bearing) -> None:
    half = float(body.half_angle_at(np.array([away]))[0])
    off = min(abs(bearing), math.pi - abs(bearing))
    if abs(off - half) > 1e-3 and abs(away - body.turning_radius_m) > 1e-3:
        x, y = away * math.cos(bearing), away * math.sin(bearing)
        assert covers(body, x, y) == (off < half or (half == math.pi / 2))


@given(BODIES, st.floats(-1.0, 1.0))
def test_the_front_is_where_the_body_ends(body, share) -> None:
    left = share * body.half_width_m
    front = float(body.front_at(np.array([left]))[0])
    assert covers(body, front - 1e-6, left) or abs(share) > 0.99
    assert not covers(body, front + 1e-6, left)


@given(BODIES)
def test_circles_as_wide_as_the_body_cover_it_from_end_to_end(body) -> None:
    circles = body.circles()
    assert circles[0] == -body.end_m
    assert circles[-1] == body.end_m
    assert (np.diff(circles) <= body.half_width_m).all()


def guard_of(body: Footprint, x: float, y: float) -> ObstacleGuard:
    """A guard with one mapped obstacle; unseen floor does not slow it down."""
    guard = ObstacleGuard(GuardConfig(creep_speed=99.0), body, MotionConfig())
    cells = np.full((1, 1), OCCUPIED, np.int8)
    guard.consult(OccupancyGrid(cells, (x - 0.05, y - 0.05), 0.1))
    return guard


def test_a_long_body_does_not_turn_its_ends_into_what_is_beside_it() -> None:
    here = Pose.identity()
    beside = guard_of(DOG, 0.2, 0.165)  # left of the front end
    assert beside.turn_limit(here, 0.8) < 0.5
    assert beside.turn_limit(here, -0.8) > 1.0
    # The same to the right of the rear end.
    behind = guard_of(DOG, -0.2, -0.165)
    assert behind.turn_limit(here, 0.8) == pytest.approx(beside.turn_limit(here, 0.8))
    assert guard_of(DOG, 0.0, 0.36).turn_limit(here, 0.8) > 10.0


def test_a_round_body_turns_freely() -> None:
    assert guard_of(Footprint(), 0.1, 0.16).turn_limit(Pose.identity(), 0.8) == math.inf


def test_over_floor_that_was_not_seen_the_ends_of_a_long_body_creep() -> None:
    config, here = GuardConfig(), Pose.identity()
    guard = ObstacleGuard(config, DOG, MotionConfig())
    assert guard.turn_limit(here, 0.8) * DOG.turning_radius_m == pytest.approx(config.creep_speed)
    camera = Intrinsics.from_hfov(8, 6, 69.0)
    for step in range(8):  # once it has turned, it knows what it stands on
        turned = Pose.from_yaw(0.1 * step, (0.0, 0.0, 0.0))
        guard.see(np.zeros((6, 8), np.float32), camera, turned, turned, 0.0)
    assert guard.turn_limit(turned, -0.8) == math.inf
    assert guard.turn_limit(turned, 0.8) * DOG.turning_radius_m < 0.11


def test_a_narrow_body_passes_where_a_wide_one_would_touch() -> None:
    wide = Footprint(length_m=0.70, width_m=0.70)
    assert guard_of(DOG, 0.8, 0.25).free_ahead(Pose.identity()) == GuardConfig().reach_m
    assert guard_of(wide, 0.8, 0.25).free_ahead(Pose.identity()) < 0.8


def test_a_body_wider_than_long_is_refused_with_what_to_do() -> None:
    with pytest.raises(ConfigError, match="give its width as the length"):
        robot_config("generic", {"footprint": {"length_m": 0.3, "width_m": 0.5}})
