"""Evidence: sides instead of frames, misses, other labels, masks that bleed, verdicts."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ball_frames import Ball, frame, said
from toponav.policy.candidate import EvidenceConfig, Look
from toponav.policy.evidence import TargetEvidence

CONFIG = EvidenceConfig()
BALL = Ball(0.0, 0.0)
ORIGIN = np.zeros(2)
EAST, NORTH_EAST, NORTH, WEST = (1.8, 0.0), (1.3, 1.3), (0.0, 1.8), (-1.8, 0.0)


def watched(
    *frames: tuple[tuple[float, float], str | None, float],
    config: EvidenceConfig = CONFIG,
    target: str = "plant",
) -> TargetEvidence:
    """The evidence on a target after a ball was seen from these places and taken for these."""
    evidence = TargetEvidence(config, target)
    for eye, label, score in frames:
        observation, [mask] = frame([BALL], *eye)
        evidence.observe(observation, said((label, score, mask)) if label else said())
    return evidence


def odds(evidence: TargetEvidence) -> float:
    [candidate] = evidence.candidates
    return candidate.log_odds(CONFIG)


def test_what_was_never_detected_is_no_candidate() -> None:
    assert watched((EAST, None, 0.0), (EAST, "chair", 0.9)).candidates == ()


def test_a_first_sighting_is_a_lead_and_no_more() -> None:
    evidence = watched((EAST, "plant", 0.62))
    assert evidence.leads(ORIGIN) == list(evidence.candidates)
    assert CONFIG.lead < odds(evidence) < CONFIG.accept


def test_many_frames_from_one_side_say_little_more_than_a_few() -> None:
    few, many = (odds(watched(*[(EAST, "plant", 0.55)] * n)) for n in (4, 40))
    assert few < many < few * 1.25
    assert many < CONFIG.accept


def test_another_side_says_as_much_again() -> None:
    one = odds(watched(*[(EAST, "plant", 0.62)] * 5))
    two = odds(watched(*[(EAST, "plant", 0.62)] * 5, *[(NORTH, "plant", 0.62)] * 5))
    assert two == pytest.approx(2.0 * one)
    assert two > CONFIG.accept


def test_surer_detections_say_more_and_far_ones_less() -> None:
    unsure, sure = (odds(watched(*[(EAST, "plant", s)] * 3)) for s in (0.42, 0.62))
    assert unsure < sure
    far = odds(watched(*[((4.5, 0.0), "plant", 0.62)] * 3))
    assert far == pytest.approx(CONFIG.far_weight * sure)


def test_being_missed_and_being_called_something_else_speak_against() -> None:
    seen = [(EAST, "plant", 0.55)] * 3
    plain = odds(watched(*seen))
    missed = odds(watched(*seen, *[(NORTH_EAST, None, 0.0)] * 3))
    other = odds(watched(*seen, *[(NORTH_EAST, "chair", 0.9)] * 3))
    assert other < missed < plain
    assert not watched(*seen, *[(NORTH_EAST, "chair", 0.9)] * 9).leads(ORIGIN)


def test_sure_detections_from_all_sides_do_not_outweigh_an_impossible_shape() -> None:
    evidence = TargetEvidence(CONFIG, "bed")
    for eye in (EAST, NORTH, WEST) * 3:
        observation, [mask] = frame([BALL], *eye)
        evidence.observe(observation, said(("bed", 0.9, mask)))
    assert odds(evidence) == pytest.approx(CONFIG.implausible_most)
    assert CONFIG.lead < CONFIG.implausible_most < CONFIG.probable


def test_a_doubtful_shape_stays_doubtful_in_frames_that_show_little_of_it() -> None:
    evidence = watched(*[(EAST, "bed", 0.9)] * 3, target="bed")
    [candidate] = evidence.candidates
    assert candidate.implausible
    observation, [mask] = frame([BALL], 1.8, 0.0, at=(0.0, 1.7))  # cut off by the image's border
    assert mask.any()
    evidence.observe(observation, said(("bed", 0.9, mask)))
    assert candidate.implausible


def test_being_called_what_its_shape_rules_out_tells_nothing() -> None:
    seen = [(EAST, "plant", 0.55)] * 3
    as_bed = [*seen, *[(NORTH_EAST, "bed", 0.9)] * 3]  # a ball of 0.6 m is no bed
    assert odds(watched(*as_bed)) == pytest.approx(odds(watched(*seen)))
    heedless = CONFIG.model_copy(update={"impossible_names": False})
    as_chair = [*seen, *[(NORTH_EAST, "chair", 0.9)] * 3]
    assert odds(watched(*as_bed, config=heedless)) == pytest.approx(odds(watched(*as_chair)))


@pytest.mark.parametrize(("better", "leading"), [(1.0, 1), (None, -1)])
def test_what_was_settled_on_is_given_up_for_something_likelier(
    better: float | None, leading: int
) -> None:
    balls = [Ball(0.0, -1.0), Ball(0.0, 1.0)]
    evidence = TargetEvidence(CONFIG.model_copy(update={"better": better}), "plant")
    observation, [left, right] = frame(balls, 2.6, 0.0)
    evidence.observe(observation, said(("plant", 0.4, left)))
    [poor] = evidence.candidates
    evidence.settle(poor)
    evidence.observe(observation, said(("plant", 0.4, left), ("plant", 0.41, right)))
    assert evidence.leads(ORIGIN)[0] is poor  # not likelier by enough
    for _ in range(2):
        evidence.observe(observation, said(("plant", 0.4, left), ("plant", 0.7, right)))
    assert round(float(evidence.leads(ORIGIN)[0].center[1])) == leading


def test_what_is_hidden_is_not_missed() -> None:
    evidence = watched(*[(EAST, "plant", 0.62)] * 3)
    before = odds(evidence)
    for _ in range(5):
        observation, _ = frame([BALL, Ball(-0.9, 0.0, 0.5)], -2.5, 0.0)
        evidence.observe(observation, said())
        observation, _ = frame([BALL], 1.8, 0.0, at=(9.0, 0.0))
        evidence.observe(observation, said())
    assert odds(evidence) == before


def test_a_mask_that_bleeds_onto_another_object_is_cut_where_they_part() -> None:
    other = Ball(0.2, -0.75, 0.12)
    evidence = TargetEvidence(CONFIG, "plant")
    observation, [mask, bled] = frame([BALL, other], *EAST)
    assert bled.any()
    evidence.observe(observation, said(("plant", 0.7, mask | bled)))
    [candidate] = evidence.candidates
    assert np.hypot(*(candidate.points[:, :2]).T).max() <= BALL.radius + 0.05


def test_points_that_later_masks_leave_out_are_dropped() -> None:
    neighbour = Ball(0.05, -0.5, 0.22)
    evidence = TargetEvidence(CONFIG, "plant")
    observation, [mask, bled] = frame([BALL, neighbour], *EAST)
    evidence.observe(observation, said(("plant", 0.7, mask | bled)))
    [candidate] = evidence.candidates
    behind = candidate.own_points(CONFIG)[:, 1] < -0.32
    assert behind.any()
    for _ in range(4):
        evidence.observe(observation, said(("plant", 0.7, mask)))
    assert not (candidate.own_points(CONFIG)[:, 1] < -0.32).any()


def test_two_things_are_two_candidates_and_the_likelier_leads() -> None:
    balls = [Ball(0.0, -1.0), Ball(0.0, 1.0)]
    evidence = TargetEvidence(CONFIG, "plant")
    for _ in range(3):
        observation, [left, right] = frame(balls, 2.6, 0.0)
        evidence.observe(observation, said(("plant", 0.5, left), ("plant", 0.7, right)))
    assert [round(float(c.center[1])) for c in evidence.leads(ORIGIN)] == [1, -1]


def test_of_two_that_are_as_likely_the_nearer_leads() -> None:
    balls = [Ball(0.0, -1.0), Ball(0.0, 1.0)]
    evidence = TargetEvidence(CONFIG, "plant")
    observation, masks = frame(balls, 2.6, 0.0)
    evidence.observe(observation, said(*(("plant", 0.7, mask) for mask in masks)))
    for y in (-1, 1):
        assert round(float(evidence.leads(np.array([0.0, 3.0 * y]))[0].center[1])) == y


def test_verdicts_hold_until_much_speaks_against_them() -> None:
    evidence = watched(*[(EAST, "plant", 0.5)] * 3)
    [candidate] = evidence.candidates
    evidence.accept(candidate)
    assert odds(evidence) == pytest.approx(CONFIG.accept)
    evidence = watched(*[(EAST, "plant", 0.5)] * 3)
    [candidate] = evidence.candidates
    evidence.reject(candidate)
    assert evidence.leads(ORIGIN) == []
    for eye in (NORTH, WEST):
        for _ in range(5):
            observation, [mask] = frame([BALL], *eye)
            evidence.observe(observation, said(("plant", 0.75, mask)))
    assert evidence.leads(ORIGIN) == [candidate]


@given(st.floats(-math.pi, math.pi), st.floats(0.5, 5.0))
def test_sides_go_round_a_candidate(bearing: float, distance: float) -> None:
    evidence = watched((EAST, "plant", 0.7))
    [candidate] = evidence.candidates
    step = np.array([math.cos(bearing), math.sin(bearing)])
    side = evidence.side_of(candidate, candidate.center[:2] + distance * step)
    assert side in range(CONFIG.sides)
    opposite = evidence.side_of(candidate, candidate.center[:2] - distance * step)
    turned = (opposite - side) % CONFIG.sides
    assert abs(turned - CONFIG.sides / 2) <= 1


@given(st.integers(1, 50), st.data())
def test_no_look_says_more_than_its_bound(frames: int, data: st.DataObject) -> None:
    hits = data.draw(st.integers(0, frames))
    others = data.draw(st.integers(0, frames - hits))
    score = hits * data.draw(st.floats(0.0, 1.0))
    look = Look(1.0, frames, hits, others, score)
    assert abs(look.log_odds(CONFIG)) <= CONFIG.most_per_side
