"""Stairs by their shape: what is a flight, what is not, and what of it ends up in the map."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from toponav.mapping.flight_finder import FlightFinder

RISER_M, TREAD_M, WIDTH_M, VOXEL_M = 0.175, 0.27, 1.0, 0.05


def surface(
    steps: int = 10, *, rise: float = RISER_M, run: float = TREAD_M, yaw: float = 0.0
) -> NDArray[np.float32]:
    """(N, 3) voxels of treads that climb from the origin along a heading, and the floor before."""
    along = np.arange(-1.0, steps * run, VOXEL_M)
    across = np.arange(-0.5 * WIDTH_M, 0.5 * WIDTH_M, VOXEL_M)
    x, y = (part.ravel() for part in np.meshgrid(along, across, indexing="ij"))
    z = np.maximum(np.floor(x / run + 1e-9) + 1.0, 0.0) * rise
    ahead, left = np.array([np.cos(yaw), np.sin(yaw)]), np.array([-np.sin(yaw), np.cos(yaw)])
    return np.column_stack([x[:, None] * ahead + y[:, None] * left, z]).astype(np.float32)


def box(low: tuple[float, float], high: tuple[float, float], top: float) -> NDArray[np.float32]:
    """(N, 3) voxels of the top of a box."""
    x, y = np.meshgrid(
        np.arange(low[0], high[0], VOXEL_M), np.arange(low[1], high[1], VOXEL_M), indexing="ij"
    )
    return np.column_stack([x.ravel(), y.ravel(), np.full(x.size, top)]).astype(np.float32)


def ramp() -> NDArray[np.float32]:
    """(N, 3) voxels that rise like a flight, without steps."""
    points = surface()
    points[:, 2] = np.maximum(points[:, 0], 0.0) * RISER_M / TREAD_M
    return points


@pytest.mark.parametrize("yaw", [0.0, 0.6, 2.2])
def test_a_flight_is_found_whatever_its_heading(yaw: float) -> None:
    finder, points = FlightFinder(), surface(yaw=yaw)
    assert finder.look(0, 0.0, points)
    inside = finder.inside(points)
    treads = points[:, 2] > 0.1
    assert inside[treads & (points[:, 2] < 1.6)].mean() > 0.9
    before = points[:, :2] @ (np.cos(yaw), np.sin(yaw)) < -0.4
    assert not inside[before].any(), "floor before the flight is floor"


def test_a_flight_down_is_found_from_above() -> None:
    finder, points = FlightFinder(), surface()
    assert finder.look(0, 10 * RISER_M, points)


def test_noise_of_a_depth_camera_does_not_hide_a_flight() -> None:
    rng = np.random.default_rng(0)
    points = surface()
    points[:, 2] += rng.normal(0.0, 0.015, len(points)).astype(np.float32)
    assert FlightFinder().look(0, 0.0, points)


@pytest.mark.parametrize(
    "points",
    [
        surface(rise=0.0),
        surface(rise=0.35),
        surface(steps=2),
        np.vstack([box((0.0, 0.0), (0.9, 2.0), 0.42), box((0.7, 0.0), (0.9, 2.0), 0.85)]),
        np.vstack([box((0.25 * k, 0.0), (0.25 * k + 0.25, 0.4), 0.18 * k) for k in range(1, 9)]),
        surface(run=0.15),
        ramp(),
    ],
    ids=["floor", "benches", "two steps", "a sofa", "a narrow rack", "a ladder", "a ramp"],
)
def test_other_things_are_no_flights(points: NDArray[np.float32]) -> None:
    finder = FlightFinder()
    assert not finder.look(0, 0.0, points)
    assert not finder.inside(points).any()


def test_a_known_flight_grows_by_the_treads_that_are_seen_later() -> None:
    finder, points = FlightFinder(), surface(steps=12)
    near = points[:, 0] < 6 * TREAD_M
    assert finder.look(0, 0.0, points[near])
    known = finder.inside(points).sum()
    for _ in range(8):
        finder.grow(points[~near])
    assert finder.inside(points).sum() > known + 50


def test_parts_of_a_flight_that_overlap_are_one() -> None:
    finder, points = FlightFinder(), surface(steps=9)
    assert finder.look(0, 0.0, points[points[:, 0] < 6 * TREAD_M])
    half = finder.inside(points).sum()
    assert finder.look(0, 0.0, points)
    whole = finder.inside(points)
    assert whole.sum() > half + 100
    assert not finder.look(1, 0.0, points), "from another floor it is the same flight"


def test_a_wall_or_a_floor_beyond_its_end_is_no_tread() -> None:
    finder, points = FlightFinder(), surface(steps=6)
    assert finder.look(0, 0.0, points)
    top, end = 6 * RISER_M, 6 * TREAD_M
    floor = box((end, -0.5), (end + 1.5, 0.5), top)
    for _ in range(4):
        finder.grow(floor)
    assert not finder.inside(floor[floor[:, 0] > end + 0.6]).any()
