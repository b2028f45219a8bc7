"""The protocol's metrics against cases worked by hand."""

from __future__ import annotations

import math

import pytest

from toponav.evaluation.metrics import finite_mean, soft_spl, spl, success, wilson_interval


@pytest.mark.parametrize(
    ("stop", "dtg", "radius", "expected"),
    [
        (True, 0.0999, 0.1, True),
        (True, 0.1, 0.1, False),  # strictly less
        (False, 0.0, 0.1, False),  # never without stop
        (True, math.inf, 1.0, False),
        (True, 0.5, 1.0, True),
    ],
)
def test_success(stop: bool, dtg: float, radius: float, expected: bool) -> None:
    assert success(stop, dtg, radius) is expected


@pytest.mark.parametrize(
    ("succeeded", "shortest", "path", "expected"),
    [
        (True, 5.0, 5.0, 1.0),
        (True, 5.0, 10.0, 0.5),
        (True, 5.0, 4.0, 1.0),  # shorter than the shortest: rounding on a grid, capped at 1
        (False, 5.0, 5.0, 0.0),
        (True, 0.0, 0.0, 1.0),  # started at the goal and stopped at once
        (True, 0.0, 2.0, 0.0),
        (True, math.inf, 2.0, 0.0),
    ],
)
def test_spl(succeeded: bool, shortest: float, path: float, expected: float) -> None:
    assert spl(succeeded, shortest, path) == pytest.approx(expected)


@pytest.mark.parametrize(
    ("dtg", "shortest", "path", "expected"),
    [
        (0.0, 5.0, 5.0, 1.0),
        (2.5, 5.0, 5.0, 0.5),
        (2.5, 5.0, 10.0, 0.25),
        (7.0, 5.0, 5.0, 0.0),  # farther away than at the start
        (0.0, 0.0, 0.0, 1.0),
        (1.0, 0.0, 1.0, 0.0),
        (math.inf, 5.0, 5.0, 0.0),
        (math.inf, math.inf, 5.0, 0.0),
    ],
)
def test_soft_spl(dtg: float, shortest: float, path: float, expected: float) -> None:
    assert soft_spl(dtg, shortest, path) == pytest.approx(expected)


def test_wilson_interval_of_a_known_case() -> None:
    # 8 of 10: the textbook interval is (0.4902, 0.9433).
    assert wilson_interval(8, 10) == pytest.approx((0.4902, 0.9433), abs=1e-4)
    assert wilson_interval(0, 0) == (0.0, 1.0)
    low, high = wilson_interval(10, 10)
    assert low == pytest.approx(0.7225, abs=1e-4)
    assert high == pytest.approx(1.0)


def test_unreachable_episodes_are_counted_and_kept_out_of_the_mean() -> None:
    assert finite_mean([1.0, 3.0, math.inf]) == (2.0, 1)
    assert finite_mean([math.inf]) == (None, 1)
