"""SE(3) axioms and conversions."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from toponav.errors import PoseError
from toponav.geometry import Pose
from toponav.geometry.conventions import (
    BODY_FROM_OPTICAL,
    OPTICAL_FROM_OPENGL,
    WORLD_FROM_HABITAT,
    WORLD_FROM_Y_DOWN,
)

coordinate = st.floats(-50, 50)
angle = st.floats(-math.pi, math.pi)


@st.composite
def poses(draw: st.DrawFn) -> Pose:
    quaternion = np.array([draw(st.floats(-1, 1)) for _ in range(4)])
    if np.linalg.norm(quaternion) < 1e-3:
        quaternion = np.array([0.0, 0.0, 0.0, 1.0])
    return Pose.from_quaternion(quaternion, [draw(coordinate) for _ in range(3)])


@given(poses(), poses(), poses())
def test_group_axioms(a: Pose, b: Pose, c: Pose) -> None:
    np.testing.assert_allclose(((a @ b) @ c).matrix, (a @ (b @ c)).matrix, atol=1e-8)
    np.testing.assert_allclose((a @ a.inverse()).matrix, np.eye(4), atol=1e-9)
    np.testing.assert_allclose((Pose.identity() @ a).matrix, a.matrix)


@given(poses(), poses(), st.lists(coordinate, min_size=3, max_size=3))
def test_composition_applies_right_to_left(a: Pose, b: Pose, point: list[float]) -> None:
    np.testing.assert_allclose((a @ b).apply(point), a.apply(b.apply(point)), atol=1e-8)


@given(poses())
def test_quaternion_round_trip(pose: Pose) -> None:
    again = Pose.from_quaternion(pose.quaternion_xyzw, pose.translation)
    np.testing.assert_allclose(again.matrix, pose.matrix, atol=1e-9)
    assert pose.quaternion_xyzw[3] >= 0.0


@given(angle)
def test_yaw_is_counter_clockwise_from_x(yaw: float) -> None:
    pose = Pose.from_yaw(yaw, [1.0, 2.0, 3.0])
    heading = pose.apply([1.0, 0.0, 0.0]) - pose.translation
    np.testing.assert_allclose(heading, [math.cos(yaw), math.sin(yaw), 0.0], atol=1e-12)
    assert math.isclose(math.remainder(pose.yaw - yaw, math.tau), 0.0, abs_tol=1e-9)


@pytest.mark.parametrize(
    ("matrix", "message"),
    [
        (np.eye(3), "4 x 4"),
        (np.diag([1.0, 1.0, -1.0, 1.0]), "not a rotation"),
        (np.diag([2.0, 2.0, 2.0, 1.0]), "not a rotation"),
        (np.full((4, 4), np.nan), "NaN"),
        (np.vstack([np.eye(4)[:3], [0.0, 0.0, 1.0, 1.0]]), "last row"),
    ],
)
def test_what_is_not_a_rigid_transformation_is_refused(matrix: np.ndarray, message: str) -> None:
    with pytest.raises(PoseError, match=message):
        Pose(matrix)


def test_a_pose_cannot_be_changed() -> None:
    pose = Pose.identity()
    with pytest.raises(ValueError, match="read-only"):
        pose.matrix[0, 3] = 1.0


def test_conventions_move_the_axes_they_name() -> None:
    np.testing.assert_allclose(BODY_FROM_OPTICAL.apply([0, 0, 1]), [1, 0, 0])  # forward
    np.testing.assert_allclose(BODY_FROM_OPTICAL.apply([1, 0, 0]), [0, -1, 0])  # right
    np.testing.assert_allclose(BODY_FROM_OPTICAL.apply([0, 1, 0]), [0, 0, -1])  # down
    np.testing.assert_allclose(OPTICAL_FROM_OPENGL.apply([0, 0, -1]), [0, 0, 1])
    np.testing.assert_allclose(WORLD_FROM_HABITAT.apply([0, 1, 0]), [0, 0, 1])  # up
    np.testing.assert_allclose(WORLD_FROM_HABITAT.apply([0, 0, -1]), [0, 1, 0])
    np.testing.assert_allclose(WORLD_FROM_Y_DOWN.apply([0, -1, 0]), [0, 0, 1])
