"""Glimpses: where the target was seen too far off to be measured, and when that is forgotten."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from ball_frames import EYE_M, Ball, frame, said
from toponav.policy.glimpses import GlimpseConfig, Glimpses
from toponav.types import Detections, Observation

CONFIG = GlimpseConfig()
FAR = Ball(5.5, 0.0)
NOWHERE = (20.0, 0.0)


def unmeasured(
    ball: Ball, x: float = 0.0, y: float = 0.0, at: tuple[float, float] = (5.5, 0.0)
) -> tuple[Observation, NDArray[np.bool_]]:
    """The ball in front of a background that is beyond the depth camera's range, as it is."""
    observation, [mask] = frame([replace(ball, radius=0.6)], x, y, at)
    return replace(observation, depth=np.zeros_like(observation.depth)), mask


def seen(observation: Observation, mask: NDArray[np.bool_], score: float = 0.7) -> Detections:
    return said(("sofa", score, mask))


def test_a_glimpse_lies_in_the_direction_in_which_it_was_seen() -> None:
    glimpses = Glimpses(CONFIG, "sofa")
    glimpses.observe(*_pair(unmeasured(FAR, x=0.0, y=2.0, at=(5.5, 0.0))))
    assert glimpses.fresh
    [glimpse] = glimpses.pursue(0.0)
    towards = (FAR.x, FAR.y - 2.0)
    offset = glimpse.place - (0.0, 2.0)
    assert offset / np.hypot(*offset) == pytest.approx(towards / np.hypot(*towards), abs=0.03)
    assert CONFIG.range_m[0] <= np.hypot(*offset) <= CONFIG.range_m[1]


def test_what_stands_on_the_floor_is_as_far_as_its_lower_edge_says() -> None:
    observation, _ = unmeasured(FAR)
    mask = np.zeros(observation.depth.shape, np.bool_)
    camera = observation.intrinsics
    row = camera.cy + camera.fy * EYE_M / 7.0  # of the floor, 7 m ahead
    mask[round(row) - 8 : round(row) + 1, round(camera.cx) - 3 : round(camera.cx) + 4] = True
    glimpses = Glimpses(CONFIG, "sofa")
    glimpses.observe(observation, seen(observation, mask))
    [glimpse] = glimpses.pursue(0.0)
    assert glimpse.place[0] == pytest.approx(7.0, rel=0.12)


def test_a_second_look_renews_it_and_another_thing_or_storey_makes_none() -> None:
    glimpses = Glimpses(CONFIG, "sofa")
    glimpses.observe(*_pair(unmeasured(FAR)))
    glimpses.observe(*_pair(unmeasured(FAR, x=1.0)))
    assert not glimpses.fresh
    assert len(glimpses.pursue(0.0)) == 1
    observation, mask = unmeasured(Ball(3.0, 4.0), at=(3.0, 4.0))
    glimpses.observe(observation, said(("chair", 0.9, mask)))
    assert len(glimpses.pursue(0.0)) == 1
    assert glimpses.pursue(3.0) == ()


def test_what_is_measured_is_no_glimpse_and_ends_one() -> None:
    glimpses = Glimpses(CONFIG, "sofa")
    glimpses.observe(*_pair(unmeasured(FAR)))
    observation, [mask] = frame([FAR], 2.0, 0.0, (5.5, 0.0))
    glimpses.observe(observation, seen(observation, mask))
    assert glimpses.pursue(0.0) == ()


def test_looks_in_vain_end_it() -> None:
    glimpses = Glimpses(CONFIG, "sofa")
    glimpses.observe(*_pair(unmeasured(FAR)))
    [glimpse] = glimpses.pursue(0.0)
    x = float(glimpse.place[0]) - 2.0
    for _ in range(CONFIG.looks):
        assert glimpses.pursue(0.0) != ()
        observation, _ = frame([], x, 0.0, NOWHERE)
        glimpses.observe(observation, said())
    assert glimpses.pursue(0.0) == ()


def test_it_is_not_followed_for_ever() -> None:
    glimpses = Glimpses(CONFIG, "sofa")
    glimpses.observe(*_pair(unmeasured(FAR)))
    followed = 0
    while glimpses.pursue(0.0):
        followed += 1
    assert followed == CONFIG.decisions


def _pair(
    shown: tuple[Observation, NDArray[np.bool_]],
) -> tuple[Observation, Detections]:
    observation, mask = shown
    return observation, seen(observation, mask)
