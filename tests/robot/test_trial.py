"""What is read off a trace: when the body stood still, and for how long."""

from __future__ import annotations

import math

import numpy as np
import pytest

from toponav.robot.trial import moves_after, speed_at, stop_time


def trace_of(speeds: list[float]) -> np.ndarray:
    """A body that drives along x with a speed in each second."""
    rows = np.zeros((len(speeds), 7))
    rows[:, 0] = np.arange(len(speeds))
    rows[:, 4] = speeds
    rows[:, 1] = np.cumsum(speeds)
    return rows


def test_the_first_standstill_counts_unless_it_must_last() -> None:
    trace = trace_of([0.4, 0.4, 0.2, 0.0, 0.1, 0.0, 0.0, 0.4])
    assert stop_time(trace, 1.0) == 2.0
    assert stop_time(trace, 1.0, until_s=7.0) == 4.0
    assert stop_time(trace, 1.0, until_s=5.0) == math.inf
    assert stop_time(trace[:3], 1.0) == math.inf


def test_a_turning_body_does_not_stand() -> None:
    trace = trace_of([0.4, 0.0, 0.0])
    trace[1, 5] = 0.3
    assert stop_time(trace, 0.0) == 2.0


def test_speed_and_way_after_a_time() -> None:
    trace = trace_of([0.4, 0.2, 0.0, 0.5])
    assert speed_at(trace, 0.5) == pytest.approx(0.3)
    assert moves_after(trace, 1.0) == pytest.approx(0.5)
