"""Goal confirmation with a model's errors of sight."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from toponav.memory.graph import TopologicalMemory
from toponav.memory.snapshot import MemorySnapshot
from toponav.memory.text import TextBudget, describe
from toponav.perception.eyesight import FAULTLESS, Eyesight
from toponav.perception.lookalikes import LOOKALIKES
from toponav.perception.sightings import SightLog
from toponav.reasoning import (
    NoisyReasoner,
    NoisyReasonerConfig,
    PanoramaView,
    PriorReasoner,
    Query,
    SeenObject,
)
from true_frames import Truth, true_frame

SHARP = NoisyReasonerConfig(sight=FAULTLESS, confusion=0.0, imagination=0.0, room_error=0.0)
DETECTED = SeenObject("sofa", 1.0, 2.0)
BED = SeenObject("bed", 1.0, 1.0)


def memory() -> MemorySnapshot:
    graph = TopologicalMemory()
    node = graph.add_node((0.0, 0.0), 0)
    text = describe(graph.nodes, graph.edges, node.id, (node.id,), TextBudget())
    return MemorySnapshot(graph.nodes, graph.edges, node.id, (node.id,), text)


def asked(
    reasoner_config: NoisyReasonerConfig,
    categories: tuple[str, ...],
    seen: tuple[SeenObject, ...] = (),
    size: int = 40,
    seed: int = 0,
) -> tuple[NoisyReasoner, Query]:
    """A reasoner and a panorama of one view for each category, which fills part of that view."""
    truth = Truth(true_frame([[0]], ["wall"]))
    log = SightLog(truth)
    reasoner = NoisyReasoner(PriorReasoner(), log, seed, reasoner_config)
    views = []
    for k in range(len(categories)):
        ids = np.zeros((120, 160), np.int32)
        ids[40 : 40 + size, 40 : 40 + size] = k + 1
        yaw = np.radians(30.0 * k)
        truth.frame = true_frame(ids, ("wall", *categories), yaw=yaw)
        image = np.zeros((120, 160, 3), np.uint8)
        log.look(image)
        views.append(PanoramaView(image, yaw, seen, 4.0, 10))
    return reasoner, Query("sofa", memory(), tuple(views))


def test_sharp_eyes_see_what_is_there_whatever_the_detector_says() -> None:
    reasoner, query = asked(SHARP, ("bed", "chair", "sofa"))
    guidance = reasoner.decide(query)
    assert guidance.target_found
    assert guidance.direction == 2
    reasoner, query = asked(SHARP, ("bed", "chair"), seen=(DETECTED,))
    assert PriorReasoner().decide(query).target_found
    assert not reasoner.decide(query).target_found


def test_what_does_not_concern_the_target_is_left_to_the_other_reasoner() -> None:
    reasoner, query = asked(SHARP, ("chair", "bed"), seen=(BED,))
    prior = PriorReasoner()
    assert reasoner.decide(query) == prior.decide(query)
    np.testing.assert_array_equal(
        reasoner.room_affinity("bed", ["kitchen"]), prior.room_affinity("bed", ["kitchen"])
    )
    np.testing.assert_array_equal(
        reasoner.object_affinity("bed", ["sofa"]), prior.object_affinity("bed", ["sofa"])
    )


def found_rate(config: NoisyReasonerConfig, categories: tuple[str, ...], size: int = 40) -> float:
    answers = []
    for seed in range(600):
        reasoner, query = asked(config, categories, size=size, seed=seed)
        answers.append(reasoner.decide(query).target_found)
    return float(np.mean(answers))


@pytest.mark.parametrize("size", [6, 12, 40])
def test_far_and_small_targets_are_overlooked(size: int) -> None:
    sight = Eyesight()
    config = SHARP.model_copy(update={"sight": sight})
    expected = sight.recall(size / np.sqrt(120 * 160), 2.0)
    assert found_rate(config, ("sofa",), size) == pytest.approx(expected, abs=0.07)


def test_lookalikes_and_imagination_are_as_frequent_as_configured() -> None:
    mistaken = SHARP.model_copy(update={"confusion": 4.0})
    expected = 4.0 * LOOKALIKES["bed"]["sofa"]
    assert found_rate(mistaken, ("bed",)) == pytest.approx(expected, abs=0.06)
    assert found_rate(mistaken, ("toilet",)) == 0.0
    imagining = SHARP.model_copy(update={"imagination": 0.1})
    assert found_rate(imagining, ("toilet",)) == pytest.approx(0.1, abs=0.04)


def test_rooms_are_mistaken_at_their_rate_and_unknown_ones_stay_unknown() -> None:
    config = SHARP.model_copy(update={"room_error": 0.3})
    right = 0
    for seed in range(400):
        reasoner, query = asked(config, ("chair",), seen=(BED,), seed=seed)
        right += reasoner.decide(query).room_type == PriorReasoner().decide(query).room_type
        reasoner, query = asked(config, ("chair",), seed=seed)
        assert reasoner.decide(query).room_type == "unknown"
    assert right / 400 == pytest.approx(0.7, abs=0.07)


def test_the_same_question_has_the_same_answer_and_an_unknown_image_shows_nothing() -> None:
    reasoner, query = asked(NoisyReasonerConfig(), ("sofa", "bed", "chair"), size=10)
    assert reasoner.decide(query) == reasoner.decide(query)
    unknown = tuple(replace(view, image=view.image.copy()) for view in query.panorama)
    assert not reasoner.decide(replace(query, panorama=unknown)).target_found
