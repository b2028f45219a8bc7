"""ESC's scores, worked out by hand, and its rules for choosing, arriving and believing."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from searches import Blind, Log, named, search, walked_early
from words import Words

from drawn_map import clusters_from, detections_of, drawn_map, observation_at, reach_from
from small_house import small_config
from toponav.baselines.esc import (
    NEAREST_M,
    ROOMS,
    EscAgent,
    min_max,
    nearness,
    room_confidence,
    soft_rule,
    soft_score,
)
from toponav.reasoning.affinity import ROOM_TYPES, room_belief
from toponav.types import Action

HALL = drawn_map(
    "##############",
    "#............#",
    " ............ ",
    "#............#",
    "##############",
    enlarged=5,
)
"""A hall of 6 m with a way out at either end."""


def agent(words: dict[str, float] | None = None, goal: str = "sofa") -> EscAgent:
    made = EscAgent(Blind(), Words(words or {}), small_config().navigator, Log())
    made.reset(goal)
    return made


@pytest.mark.parametrize(
    ("affinity", "confidence", "truth"),
    [(0.9, 0.8, 0.7), (0.3, 0.8, -0.4), (0.5, 1.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.6, -0.6)],
)
def test_soft_rules_by_hand(affinity: float, confidence: float, truth: float) -> None:
    assert soft_rule(np.array([affinity]), np.array([[confidence]])) == pytest.approx(truth)


@given(st.floats(0.0, 1.0), st.floats(0.0, 1.0))
def test_a_sure_object_counts_for_twice_its_affinity_less_one(p: float, n: float) -> None:
    assert soft_rule(np.array([p]), np.array([[1.0]]))[0, 0] == pytest.approx(2.0 * p - 1.0)
    assert -1.0 <= soft_rule(np.array([p]), np.array([[n]]))[0, 0] <= 1.0


def test_nearness_falls_from_one_to_nothing_over_ten_metres() -> None:
    distance = np.array([0.0, 1.6, 6.6, 11.6, 30.0])
    np.testing.assert_allclose(nearness(distance), [1.0, 1.0, 0.5, 0.0, 0.0], atol=1e-12)


def test_the_score_adds_all_rules_and_twice_the_nearness() -> None:
    by_object = np.array([[0.5, -0.25], [0.0, 0.0]])
    by_room = np.array([[0.1], [0.3]])
    score = soft_score(by_object, by_room, np.array([6.6, 1.6]))
    np.testing.assert_allclose(score, [0.5 - 0.25 + 0.1 + 1.0, 0.3 + 2.0])


def test_normalising() -> None:
    np.testing.assert_allclose(min_max(np.array([0.2, 0.4, 0.3])), [0.0, 1.0, 0.5])
    np.testing.assert_array_equal(min_max(np.array([0.3, 0.3])), [0.5, 0.5])


def test_rooms_are_as_sure_as_the_objects_around_make_them() -> None:
    seen = np.array([[0.0, 0.0], [1.0, 0.5], [0.0, 0.0], [0.0, 1.0]])
    confidence = room_confidence(("oven", "bed"), seen)
    np.testing.assert_array_equal(confidence[[0, 2]], 0.0)
    belief = room_belief({"oven": 1.0, "bed": 0.5})[[ROOM_TYPES.index(room) for room in ROOMS]]
    np.testing.assert_allclose(confidence[1], belief / belief.sum())
    assert ROOMS[int(confidence[3].argmax())] == "bedroom"


def test_an_object_that_goes_with_the_target_outweighs_a_shorter_way() -> None:
    here = (3.0, 1.25)  # the left end is nearer
    clusters, reach = clusters_from(HALL, here), reach_from(HALL, here)
    box = detections_of({"rug": (18, 13, 22, 17)}, [1.0])

    def chosen(affinity: float) -> float:
        searching = agent({"rug": affinity, "toilet": 0.0})
        seen = observation_at(4.0, 1.25)  # the rug lies at (6, 1.25)
        searching._perceive(seen, box, HALL)
        return float(searching._choose(clusters, reach, observation_at(*here), HALL)[0])

    assert chosen(0.9) > 6.0
    assert chosen(0.0) < 1.0


def test_frontiers_within_a_stride_are_left_out_unless_there_are_no_others() -> None:
    here = (1.5, 1.25)  # 1 m from the left end
    clusters, reach = clusters_from(HALL, here), reach_from(HALL, here)
    assert agent()._choose(clusters, reach, observation_at(*here), HALL)[0] > 6.0
    left = clusters[:1]
    assert agent()._choose(left, reach, observation_at(*here), HALL)[0] < 1.0
    distance = agent()._distances(reach).at(left[0].cells[left[0].reachable])
    assert distance.max() < NEAREST_M


def test_it_scores_anew_only_on_arrival() -> None:
    log = search(named("esc"), goal="piano")
    assert log.actions[:12] == [Action.TURN_LEFT] * 12
    pairs = walked_early(log)
    window = small_config().navigator.locomotion.recovery.window_steps
    assert len(pairs) > 2
    assert all(
        away <= EscAgent.exploring_arrival_m or second.step - first.step >= window
        for first, second, away in pairs
    )
    assert any(away > 0.2 for *_, away in pairs)
