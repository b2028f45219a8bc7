"""Where to stand for the last metre."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from ball_frames import Ball, frame, said
from toponav.control.locomotion import LocomotionConfig
from toponav.control.planner import CostField, Planner, PlannerConfig
from toponav.control.vantage import LOOK_M, MARGIN_M, further_look, vantage_point
from toponav.geometry import Pose
from toponav.mapping.view import FREE, OCCUPIED, MapView, OccupancyGrid, PointCloud
from toponav.policy.candidate import EvidenceConfig
from toponav.policy.goal import GoalConfig, GoalTracker

EYE_M = 0.88
CONFIG = GoalConfig()
TRACKER = GoalTracker(CONFIG)
AGENT = np.array([0.5, 0.5])


def block(low: tuple[float, ...], high: tuple[float, ...]) -> np.ndarray:
    axes = [np.arange(a, b + 0.025, 0.05) for a, b in zip(low, high, strict=True)]
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)


def cloud(points: np.ndarray) -> PointCloud:
    xyz = np.asarray(points, np.float32).reshape(-1, 3)
    return PointCloud(xyz, np.zeros((len(xyz), 3), np.uint8), np.ones(len(xyz), np.int32))


def room(target: np.ndarray, *others: np.ndarray) -> tuple[MapView, CostField]:
    """A floor of 5 m by 3 m whose obstacles are the given points, and the ways from AGENT."""
    solid = np.concatenate([target, *others])
    grid = OccupancyGrid(np.full((50, 30), FREE, np.int8), (0.0, 0.0), 0.1)
    i, j = grid.index_of(solid + 1e-6).T
    grid.cells[i.clip(0, 49), j.clip(0, 29)] = OCCUPIED
    nothing = np.zeros((0, 3))
    view = MapView(
        scene=cloud(solid),
        objects={"chair": cloud(target)},
        navigable=cloud(nothing),
        obstacles=cloud(solid),
        frontiers=nothing,
        frontier_labels=np.zeros(0, np.int64),
        grid=grid,
        floor_z=0.0,
    )
    planner = Planner(PlannerConfig())
    return view, planner.cost_field(planner.clearance(grid, AGENT), AGENT)


def spot_for(target: np.ndarray, *others: np.ndarray) -> tuple[np.ndarray | None, MapView]:
    view, reach = room(target, *others)
    return vantage_point(TRACKER.points(view, "chair"), TRACKER, view, reach, EYE_M), view


def horizontal_gap(spot: np.ndarray, target: np.ndarray) -> float:
    return float(np.hypot(*(target[:, :2] - spot[:2]).T).min())


CHAIR = block((3.0, 0.4, 0.1), (3.4, 0.8, 0.8))


def test_it_is_the_first_place_on_the_way_from_which_the_agent_stops() -> None:
    spot, view = spot_for(CHAIR)
    assert spot is not None
    assert spot[2] == 0.0
    assert spot[0] < 3.0
    assert horizontal_gap(spot, CHAIR) <= CONFIG.stop_distance_m - MARGIN_M
    assert horizontal_gap(spot, CHAIR) > CONFIG.stop_distance_m - MARGIN_M - 0.15
    assert TRACKER.reached(Pose.from_yaw(0.0, (spot[0], spot[1], EYE_M)), view, "chair")


def test_the_margin_is_the_walks_tolerance() -> None:
    assert LocomotionConfig().arrival_m == MARGIN_M


def test_behind_a_wall_it_goes_round_to_see_the_target() -> None:
    wall = block((2.6, 0.0, 0.0), (2.7, 1.8, 2.5))
    spot, _ = spot_for(CHAIR, wall)
    assert spot is not None
    assert spot[0] > 2.6 or spot[1] > 1.2
    assert horizontal_gap(spot, CHAIR) <= CONFIG.farthest_stop_m


def test_not_through_a_wall_whose_far_side_was_not_mapped() -> None:
    """What is known of the wall behind the chair lies as near to it as its own edges."""
    face = block((2.95, 0.0, 0.0), (2.95, 1.8, 2.5))
    spot, _ = spot_for(CHAIR, face)
    assert spot is not None
    assert spot[0] > 2.95 or spot[1] > 1.2


def test_a_target_that_cannot_be_approached_is_seen_from_as_near_as_one_gets() -> None:
    """A bowl in the middle of a table 1.1 m deep on each side of it, too high to hide it."""
    bowl = block((3.0, 1.4, 0.8), (3.1, 1.5, 0.85))
    table = block((2.45, 0.0, 0.75), (4.9, 2.95, 0.75))
    spot, view = spot_for(bowl, table)
    assert spot is not None
    gap = horizontal_gap(spot, bowl)
    assert CONFIG.stop_distance_m - MARGIN_M < gap <= CONFIG.farthest_stop_m
    eye = Pose.from_yaw(0.0, (spot[0], spot[1], EYE_M))
    assert TRACKER.reached(eye, view, "chair", walk_ended=True)


@pytest.mark.parametrize("closed", [block((1.5, 0.0, 0.0), (1.6, 3.0, 2.5))])
def test_no_spot_beyond_a_closed_wall(closed: np.ndarray) -> None:
    assert spot_for(CHAIR, closed)[0] is None


def test_a_flight_beside_the_target_is_no_place_to_stop() -> None:
    view, reach = room(CHAIR)
    free = vantage_point(CHAIR, TRACKER, view, reach, EYE_M)
    assert free is not None
    heights = np.full(view.grid.cells.shape, np.nan, np.float32)
    heights[:30] = 1.2
    raised = replace(view, grid=replace(view.grid, stairs=heights))
    spot = vantage_point(CHAIR, TRACKER, raised, reach, EYE_M)
    assert spot is not None
    assert free[0] < 3.0 < spot[0]


def test_no_spot_for_a_target_that_is_not_mapped() -> None:
    view, reach = room(CHAIR)
    assert vantage_point(np.zeros((0, 3)), TRACKER, view, reach, EYE_M) is None


def test_spots_that_are_not_allowed_are_left_out() -> None:
    view, reach = room(CHAIR)
    free = vantage_point(CHAIR, TRACKER, view, reach, EYE_M)
    assert free is not None
    beyond = vantage_point(
        CHAIR, TRACKER, view, reach, EYE_M, lambda spots: spots[:, 0] > free[0] + 0.3
    )
    assert beyond is not None
    assert beyond[0] > free[0] + 0.3
    nowhere = vantage_point(CHAIR, TRACKER, view, reach, EYE_M, lambda spots: spots[:, 0] > 99.0)
    assert nowhere is None


def test_another_look_is_taken_from_a_side_not_looked_from_yet() -> None:
    ball, tracker = Ball(2.5, 1.5), GoalTracker(GoalConfig(evidence=EvidenceConfig()))
    looked_from = np.array([0.9, 1.5])
    for _ in range(3):
        observation, [mask] = frame([ball], *looked_from, at=(2.5, 1.5))
        tracker.observe(observation, said(("chair", 0.5, mask)), "chair")
    view, reach = room(block((2.3, 1.3, 0.5), (2.7, 1.7, 1.0)))
    assert tracker.is_mapped(view, "chair")
    assert not tracker.accepted
    assert tracker.looked_from(looked_from)
    spot = further_look(tracker, "chair", view, reach, EYE_M)
    assert spot is not None
    assert not tracker.looked_from(spot)
    gap = horizontal_gap(spot, tracker.points(view, "chair"))
    assert LOOK_M[0] <= gap <= LOOK_M[1]
    earlier, now = (np.arctan2(eye[1] - 1.5, eye[0] - 2.5) for eye in (looked_from, spot))
    apart = np.abs((now - earlier + np.pi) % (2.0 * np.pi) - np.pi)
    assert apart >= np.radians(EvidenceConfig().new_side_deg - 10.0)  # the ball's middle is unseen


def test_a_look_that_showed_nothing_is_not_taken_again() -> None:
    ball, tracker = Ball(2.5, 1.5), GoalTracker(GoalConfig(evidence=EvidenceConfig()))
    observation, [mask] = frame([ball], 0.9, 1.5, at=(2.5, 1.5))
    tracker.observe(observation, said(("chair", 0.5, mask)), "chair")
    view, reach = room(block((2.3, 1.3, 0.5), (2.7, 1.7, 1.0)))
    assert tracker.is_mapped(view, "chair")
    spots = []
    while (spot := further_look(tracker, "chair", view, reach, EYE_M)) is not None:
        tracker.look_again(spot)
        spots.append(spot)
    assert 1 < len(spots) <= 360.0 / EvidenceConfig().new_side_deg


def test_without_evidence_there_is_nothing_to_look_at_again() -> None:
    view, reach = room(CHAIR)
    assert TRACKER.accepted
    assert not TRACKER.wants_another_look()
    assert further_look(TRACKER, "chair", view, reach, EYE_M) is None
