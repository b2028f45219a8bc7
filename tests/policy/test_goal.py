"""When a target counts as mapped, what is in sight, and when to stop."""

from __future__ import annotations

import numpy as np
import pytest
from policy_maps import block, make_view

from ball_frames import Ball, frame, said
from toponav.geometry import Pose
from toponav.mapping.view import MapView
from toponav.policy.candidate import EvidenceConfig
from toponav.policy.goal import GoalConfig, GoalTracker
from toponav.policy.sight import SightConfig, TargetSight

EYE_M = 0.88
CHAIR = block((1.0, -0.2, 0.1), (1.4, 0.2, 0.8))
FLOOR = block((-2.0, -2.0, 0.0), (2.0, 2.0, 0.0))


def camera(x: float, y: float, z: float = EYE_M) -> Pose:
    return Pose.from_yaw(0.0, (x, y, z))


def furnished(target: np.ndarray, *others: np.ndarray, floor_z: float = 0.0) -> MapView:
    return make_view(
        objects={"chair": target}, scene=np.concatenate([FLOOR, target, *others]), floor_z=floor_z
    )


TRACKER = GoalTracker(GoalConfig())


def test_a_target_that_was_never_seen_is_not_there() -> None:
    view = make_view(scene=FLOOR)
    assert TRACKER.points(view, "chair").shape == (0, 3)
    assert not TRACKER.is_mapped(view, "chair")
    assert not TRACKER.reached(camera(0.0, 0.0), view, "chair")


@pytest.mark.parametrize(("x", "stops"), [(0.1, False), (0.19, False), (0.21, True), (0.6, True)])
def test_it_stops_at_the_stop_distance(x: float, stops: bool) -> None:
    """The chair's front is at x = 1, the stop distance 0.8 m."""
    assert TRACKER.reached(camera(x, 0.0), furnished(CHAIR), "chair") is stops


@pytest.mark.parametrize(("x", "stops"), [(-0.05, False), (0.05, True)])
def test_where_the_walk_ended_a_metre_is_enough(x: float, stops: bool) -> None:
    assert TRACKER.reached(camera(x, 0.0), furnished(CHAIR), "chair", walk_ended=True) is stops


def test_stray_points_are_no_target() -> None:
    strays = np.array([[-1.0, 0.0, 0.5], [-1.0, 1.5, 0.5], [-1.5, -1.0, 0.5], [0.0, 1.0, 0.7]])
    view = furnished(strays)
    assert not TRACKER.is_mapped(view, "chair")
    assert not TRACKER.reached(camera(-1.0, 0.0), view, "chair")
    keeping = GoalTracker(GoalConfig(dense_neighbors=0))
    assert keeping.is_mapped(view, "chair")


def test_stray_points_do_not_pull_the_stop_forward() -> None:
    view = furnished(np.concatenate([CHAIR, [[-0.5, 0.0, 0.5]]]))
    assert len(TRACKER.points(view, "chair")) == len(CHAIR)
    assert not TRACKER.reached(camera(-1.0, 0.0), view, "chair")


def test_floor_in_the_mask_is_dropped_but_a_rug_is_a_target() -> None:
    bled = block((0.2, -0.2, 0.0), (0.9, 0.2, 0.0))
    assert len(TRACKER.points(furnished(np.concatenate([bled, CHAIR])), "chair")) == len(CHAIR)
    rug = furnished(bled)
    assert len(TRACKER.points(rug, "chair")) == len(bled)
    assert TRACKER.reached(camera(0.0, 0.0), rug, "chair")


@pytest.mark.parametrize("floor_z", [-3.0, 3.0])
def test_targets_of_other_storeys_do_not_count(floor_z: float) -> None:
    assert not TRACKER.is_mapped(furnished(CHAIR, floor_z=floor_z), "chair")


def test_a_wall_between_hides_the_target() -> None:
    wall = block((0.7, -2.0, 0.0), (0.8, 2.0, 2.5))
    assert not TRACKER.reached(camera(0.4, 0.0), furnished(CHAIR, wall), "chair")
    assert TRACKER.reached(camera(0.9, 0.0), furnished(CHAIR, wall), "chair")


def test_a_picture_is_hidden_by_the_wall_that_it_hangs_on() -> None:
    wall = block((0.7, -2.0, 0.0), (0.85, 2.0, 2.5))
    picture = block((0.9, -0.3, 1.2), (0.9, 0.3, 1.6))
    view = furnished(picture, wall)
    assert not TRACKER.reached(camera(0.4, 0.0), view, "chair")
    assert TRACKER.reached(camera(1.4, 0.0), view, "chair")


def test_a_bowl_on_a_table_is_in_sight_across_the_top() -> None:
    table = block((0.3, -0.5, 0.75), (1.5, 0.5, 0.75))
    bowl = block((0.9, -0.1, 0.8), (1.1, 0.1, 0.85))
    assert TRACKER.reached(camera(0.15, 0.0), furnished(bowl, table), "chair")


def test_low_furniture_does_not_hide_what_is_higher() -> None:
    bench = block((0.6, -1.0, 0.0), (0.8, 1.0, 0.4))
    assert TRACKER.reached(camera(0.3, 0.0), furnished(CHAIR, bench), "chair")


def test_a_target_half_hidden_is_seen() -> None:
    half_wall = block((0.6, 0.0, 0.0), (0.7, 2.0, 2.5))
    assert TRACKER.reached(camera(0.3, 0.0), furnished(CHAIR, half_wall), "chair")


def test_sight_agrees_with_a_dense_search_along_the_segment() -> None:
    """A single target point and random clutter: hidden exactly if clutter is near the line."""
    rng = np.random.default_rng(4)
    target, eye = np.array([[0.9, 0.0, 0.7]]), np.array([0.0, 0.0, EYE_M])
    config = SightConfig()
    line = eye + np.linspace(0.0, 1.0, 2001)[:, None] * (target - eye)
    outcomes = []
    for _ in range(300):
        clutter = rng.uniform((0.0, -0.15, 0.6), (0.9, 0.15, 1.0), (3, 3))
        others = clutter[np.linalg.norm(clutter - target, axis=1) > config.own_radius_m]
        gap = np.linalg.norm(others[:, None] - line, axis=-1).min(initial=np.inf)
        if abs(gap - config.radius_m) < 0.005:  # the sampled line is half a radius apart
            continue
        seen = TargetSight(target, clutter, 1.0, config).within_reach(eye, 1.0)
        assert seen is bool(gap > config.radius_m)
        outcomes.append(seen)
    assert {True, False} == set(outcomes)


def test_nothing_is_in_reach_of_an_empty_target() -> None:
    sight = TargetSight(np.zeros((0, 3)), FLOOR, 1.0, SightConfig())
    assert not sight.within_reach((0.0, 0.0, EYE_M), 1.0)


def test_who_recognises_the_target() -> None:
    seen, unseen = furnished(CHAIR), furnished(np.zeros((0, 3)))
    both, detector = (GoalTracker(GoalConfig(recognition=who)) for who in ("both", "detector"))
    assert both.recognised(True, seen, "chair")
    assert not both.recognised(False, seen, "chair")
    assert not both.recognised(True, unseen, "chair")
    assert detector.recognised(False, seen, "chair")
    assert not detector.recognised(True, unseen, "chair")


def test_without_a_detector_the_target_is_what_stands_nearest_in_the_chosen_view() -> None:
    ahead = block((1.5, -0.1, 0.2), (1.7, 0.1, 0.6))
    behind_it = block((3.0, -0.1, 0.2), (3.2, 0.1, 0.6))
    aside = block((0.0, 1.0, 0.2), (0.2, 1.2, 0.6))
    view = make_view(obstacles=np.concatenate([ahead, behind_it, aside]), scene=FLOOR)
    tracker = GoalTracker(GoalConfig(recognition="reasoner"))
    assert not tracker.recognised(True, view, "chair")  # nothing was pointed at yet
    tracker.point(view, camera(0.0, 0.0), bearing=0.0)
    np.testing.assert_allclose(tracker.points(view, "chair"), ahead, atol=1e-6)
    assert tracker.recognised(True, view, "chair")
    assert not tracker.recognised(False, view, "chair")
    tracker.point(view, camera(0.0, 0.0), bearing=np.pi)  # nothing stands there
    assert not tracker.recognised(True, view, "chair")


def test_with_a_detector_pointing_changes_nothing() -> None:
    view = make_view(obstacles=CHAIR, scene=FLOOR)
    tracker = GoalTracker(GoalConfig())
    tracker.point(view, camera(0.0, 0.0), bearing=0.0)
    assert not tracker.is_mapped(view, "chair")


def doubted(frames: int) -> GoalTracker:
    """A ball was once taken for a plant, and then for nothing in so many frames from each side."""
    tracker = GoalTracker(GoalConfig(evidence=EvidenceConfig()))
    for eye in ((1.8, 0.0), (0.0, 1.8), (-1.8, 0.0)):
        observation, [mask] = frame([Ball(0.0, 0.0)], *eye)
        tracker.observe(observation, said(("plant", 0.5, mask)), "plant")
        for _ in range(frames):
            tracker.observe(observation, said(), "plant")
    return tracker


def test_the_last_resort_is_the_likeliest_candidate_whatever_is_said_of_it_later() -> None:
    view, tracker = make_view(scene=FLOOR), doubted(frames=3)
    assert not tracker.is_mapped(view, "plant")
    assert tracker.settle(view)
    assert tracker.is_mapped(view, "plant")
    assert tracker.accepted
    observation, _ = frame([Ball(0.0, 0.0)], 1.3, 1.3)
    for _ in range(20):
        tracker.observe(observation, said(), "plant")
    assert tracker.is_mapped(view, "plant")
    assert tracker.accepted
    assert not tracker.settle(view)  # a verdict is given once


def test_the_last_resort_may_be_what_was_turned_away_from() -> None:
    view, tracker = make_view(scene=FLOOR), doubted(frames=1)
    assert tracker.is_mapped(view, "plant")  # it is gone to
    assert not tracker.judge()
    observation, [mask] = frame([Ball(0.0, 9.0)], 1.8, 9.0)
    tracker.observe(observation, said(("plant", 0.5, mask)), "plant")
    for _ in range(9):
        tracker.observe(observation, said(), "plant")
    assert not tracker.is_mapped(view, "plant")
    assert tracker.settle(view)
    assert np.abs(tracker.points(view, "plant")[:, 1]).max() < 1.0


def test_what_much_speaks_against_is_no_last_resort() -> None:
    view = make_view(scene=FLOOR)
    strict = GoalConfig(evidence=EvidenceConfig(last_resort=0.0))
    tracker = doubted(frames=3)
    tracker.config = strict
    assert not tracker.settle(view)
    assert not GoalTracker(strict).settle(view)  # nothing was ever taken for it
    assert not GoalTracker(GoalConfig()).settle(view)  # as in the paper
