"""S_hist and the way since the last waypoint."""

from __future__ import annotations

import numpy as np
import pytest

from toponav.geometry import Intrinsics, Pose
from toponav.policy.odometry import Odometry
from toponav.types import Observation


def standing_at(x: float, y: float, yaw: float = 0.0) -> Observation:
    return Observation(
        np.zeros((1, 1, 3), np.uint8),
        np.zeros((1, 1), np.float32),
        Pose.identity(),
        Pose.from_yaw(yaw, (x, y, 0.0)),
        Intrinsics(1, 1, 1.0, 1.0, 0.0, 0.0),
    )


def test_it_starts_nowhere() -> None:
    odometry = Odometry()
    assert not odometry.started
    assert odometry.history.shape == (0, 3)
    assert odometry.since_arrival_m == 0.0


def test_it_measures_from_the_last_arrival_and_keeps_the_whole_history() -> None:
    odometry = Odometry()
    for xy in [(0.0, 0.0), (3.0, 4.0)]:
        odometry.add(standing_at(*xy))
    assert odometry.since_arrival_m == pytest.approx(5.0)
    odometry.arrive()
    assert odometry.since_arrival_m == 0.0
    odometry.add(standing_at(3.0, 5.0))
    assert odometry.since_arrival_m == pytest.approx(1.0)
    assert odometry.position_xy == (3.0, 5.0)
    np.testing.assert_allclose(odometry.history, [(0, 0, 0), (3, 4, 0), (3, 5, 0)])


def test_turns_in_place_add_nothing() -> None:
    odometry = Odometry()
    for yaw in (0.0, 0.5, 1.0):
        odometry.add(standing_at(1.0, 1.0, yaw))
    assert len(odometry.history) == 1
    assert odometry.since_arrival_m == 0.0
