"""Where the floor at the end of a flight may be."""

from __future__ import annotations

import numpy as np

from toponav.mapping.ground import FLIGHT_M, heights_ahead, level_area_m2, points_near

FOOT = np.array([0.0, 0.0, 0.7])


def level(z: float, low: float, high: float) -> np.ndarray:
    """Points 5 cm apart on a square of floor."""
    side = np.arange(low, high, 0.05)
    x, y = np.meshgrid(side, side)
    return np.stack([x, y, np.full_like(x, z)], axis=-1).reshape(-1, 3).astype(np.float32)


def flight(lowest: float) -> np.ndarray:
    """Treads every 0.25 m, from the foot down to a lowest point at x = 1."""
    x = np.arange(-1.0, 1.0, 0.05)
    z = np.maximum(lowest, FOOT[2] - 0.17 * np.floor((x + 0.1) / 0.25))
    return np.stack([x, np.zeros_like(x), z], axis=-1).astype(np.float32)


def test_a_floor_is_found_though_the_lowest_riser_reaches_down_to_it() -> None:
    floor = level(0.0, 1.0, 2.5)
    for lowest in (0.17, 0.0):
        found = heights_ahead(FOOT, floor, flight(lowest))
        areas = [level_area_m2(floor, z, 0.05) for z in found if z < FOOT[2]]
        assert max(areas) >= 1.0


def test_what_lies_higher_than_the_treads_is_no_floor_to_go_down_to() -> None:
    found = heights_ahead(FOOT, level(0.0, 1.0, 2.5), flight(0.17))
    assert not any(0.4 < z < FOOT[2] for z in found)


def test_only_what_a_flight_can_reach_is_near() -> None:
    near, far = level(0.0, 0.0, 0.5), level(0.0, FLIGHT_M + 1.0, FLIGHT_M + 1.5)
    np.testing.assert_array_equal(points_near(np.concatenate([near, far]), FOOT), near)
