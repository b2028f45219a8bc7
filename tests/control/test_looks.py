"""Looks: the nearest that showed a place; none through a wall, nor from another storey."""

from __future__ import annotations

import math

import numpy as np
import pytest

from drawn_map import drawn_map
from toponav.control.looks import Looks
from toponav.geometry import Pose

ROOMS = drawn_map("##########", "#........#", "#####....#", "#........#", "##########", enlarged=5)
"""Two corridors with a wall between their left halves: cells of 0.1 m, 5 m x 2.5 m."""
PLACE = np.array([2.0, 0.75])


def looks_from(*poses: tuple[float, float, float, float]) -> Looks:
    looks = Looks()
    for x, y, z, yaw_deg in poses:
        looks.add(Pose.from_yaw(math.radians(yaw_deg), (x, y, z)))
    return looks


def nearest(*poses: tuple[float, float, float, float], within_m: float = 5.0) -> float:
    (metres,) = looks_from(*poses).nearest_m(PLACE[None], ROOMS, within_m)
    return float(metres)


def test_the_nearest_look_counts() -> None:
    assert nearest((1.0, 0.75, 0.0, 0.0), (1.5, 0.75, 0.0, 20.0)) == pytest.approx(0.5)


@pytest.mark.parametrize(
    "pose",
    [
        (1.5, 0.75, 0.0, 90.0),  # looks elsewhere
        (1.5, 0.75, 0.0, 180.0),  # stands with its back to it
        (1.5, 0.75, 2.8, 0.0),  # on another storey
        (2.0, 1.75, 0.0, -90.0),  # behind a wall
    ],
)
def test_what_did_not_show_the_place_is_no_look_at_it(pose) -> None:
    assert nearest(pose) == math.inf


def test_looks_from_afar_do_not_matter() -> None:
    assert nearest((0.75, 0.75, 0.0, 0.0), within_m=1.0) == math.inf
    assert looks_from().nearest_m(PLACE[None], ROOMS, 1.0).tolist() == [math.inf]


def test_each_place_has_its_own_looks() -> None:
    here = (1.5, 0.75, 0.0, 0.0)
    places = np.array([PLACE, (2.0, 1.75), (2.25, 0.75)])  # the second behind the wall
    assert looks_from(here).nearest_m(places, ROOMS, 5.0) == pytest.approx([0.5, math.inf, 0.75])
