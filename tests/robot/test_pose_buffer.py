"""Poses are interpolated between what came, never beyond."""

from __future__ import annotations

import math

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from toponav.geometry import Pose
from toponav.robot.pose_buffer import PoseBuffer


@given(yaw=st.floats(-3.1, 3.1), turn=st.floats(-3.0, 3.0), share=st.floats(0.0, 1.0))
def test_between_two_poses_the_way_is_straight_and_the_turn_even(yaw, turn, share) -> None:
    buffer = PoseBuffer()
    buffer.add(1.0, Pose.from_yaw(yaw, (0.0, 0.0, 0.0)))
    buffer.add(2.0, Pose.from_yaw(yaw + turn, (1.0, 2.0, 0.0)))
    pose = buffer.at(1.0 + share)
    assert pose is not None
    np.testing.assert_allclose(pose.translation, (share, 2.0 * share, 0.0), atol=1e-9)
    assert abs(math.remainder(pose.yaw - yaw - share * turn, math.tau)) < 1e-6


def test_outside_the_known_times_there_is_no_pose() -> None:
    buffer = PoseBuffer(kept_s=1.0)
    assert buffer.at(0.0) is None
    for stamp in (0.0, 1.0, 2.0):
        buffer.add(stamp, Pose.identity())
    assert buffer.at(0.5) is None, "forgotten"
    assert buffer.at(2.1) is None, "not yet known"
    assert buffer.at(1.5) is not None
