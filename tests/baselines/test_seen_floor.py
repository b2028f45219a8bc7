"""The floor that an image shows: before the camera, on the current floor alone."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from drawn_map import drawn_map, observation_at
from toponav.baselines.seen_floor import seen_floor

ROOM = drawn_map("####", "#..#", "####", enlarged=5)


def test_it_lies_before_the_camera() -> None:
    points = seen_floor(observation_at(1.0, 1.5, depth_m=2.0), ROOM)
    assert len(points)
    np.testing.assert_allclose(points[:, 0], 3.0, atol=1e-6)


def test_a_wall_that_is_too_near_for_its_foot_to_be_in_sight_shows_none() -> None:
    assert len(seen_floor(observation_at(1.0, 1.5, depth_m=0.3), ROOM)) == 0


def test_another_floor_is_not_seen() -> None:
    above = replace(ROOM, floor_z=3.0)
    assert len(seen_floor(observation_at(1.0, 1.5, depth_m=2.0), above)) == 0
