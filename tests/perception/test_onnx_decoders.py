"""Decoders read what was encoded; suppression keeps the surest of the doubles."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from toponav.errors import ConfigError, InputError
from toponav.perception.boxes import Boxes, iou, suppressed
from toponav.perception.onnx.decoders import Reading, decode
from toponav.perception.onnx.model_card import card_beside, card_of_form, coco_names

SIZE, CLASSES = 416, 80
READING = Reading(SIZE, 0.3, CLASSES)
CORNERS = np.array([[40.0, 60.0, 200.0, 180.0], [250.0, 20.0, 330.0, 390.0]])
LABELS, SCORES = [56, 62], [0.9, 0.6]


def centers_and_sizes() -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    return 0.5 * (CORNERS[:, :2] + CORNERS[:, 2:]), CORNERS[:, 2:] - CORNERS[:, :2]


def yolox_output() -> NDArray[np.float32]:
    table = np.zeros((1, 3549, 5 + CLASSES), np.float32)
    for k, (center, size) in enumerate(zip(*centers_and_sizes(), strict=True)):
        column, row = (center // 8).astype(int)
        cell = row * 52 + column
        table[0, cell, :2] = center / 8 - (column, row)
        table[0, cell, 2:4] = np.log(size / 8)
        table[0, cell, 4] = 1.0
        table[0, cell, 5 + LABELS[k]] = SCORES[k]
    return table


def yolo_output() -> NDArray[np.float32]:
    table = np.zeros((1, 4 + CLASSES, 300), np.float32)
    for k, (center, size) in enumerate(zip(*centers_and_sizes(), strict=True)):
        table[0, :4, 7 * k] = (*center, *size)
        table[0, 4 + LABELS[k], 7 * k] = SCORES[k]
    return table


def picodet_outputs() -> list[NDArray[np.float32]]:
    counts = (2704, 676, 169, 49)
    scores = [np.zeros((1, n, CLASSES), np.float32) for n in counts]
    sides = [np.zeros((1, n, 32), np.float32) for n in counts]
    for k, (center, _) in enumerate(zip(*centers_and_sizes(), strict=True)):
        column, row = (center // 64).astype(int)
        cell, middle = row * 7 + column, (np.array([column, row]) + 0.5) * 64
        scores[3][0, cell, LABELS[k]] = SCORES[k]
        distances = np.concatenate([middle - CORNERS[k, :2], CORNERS[k, 2:] - middle]) / 64
        for side, distance in enumerate(distances):
            low = int(distance)
            bins = np.full(8, -50.0)
            bins[low : low + 2] = np.log([1 - distance + low, max(distance - low, 1e-9)])
            sides[3][0, cell, 8 * side : 8 * side + 8] = bins
    return [*scores, *sides]


def detr_outputs() -> list[NDArray[np.float32]]:
    return [np.array([LABELS]), CORNERS[None].astype(np.float32), np.array([SCORES], np.float32)]


@pytest.mark.parametrize(
    ("decoder", "outputs"),
    [
        ("yolox", [yolox_output()]),
        ("yolo", [yolo_output()]),
        ("picodet", picodet_outputs()),
        ("detr", detr_outputs()),
    ],
)
def test_what_was_encoded_is_read(decoder: str, outputs: list[NDArray[np.float32]]) -> None:
    boxes = decode(decoder, outputs, READING)
    assert boxes.classes.tolist() == LABELS
    np.testing.assert_allclose(boxes.scores, SCORES, atol=1e-5)
    np.testing.assert_allclose(boxes.corners, CORNERS, atol=0.1)
    sure = decode(decoder, outputs, Reading(SIZE, 0.7, CLASSES))
    assert sure.classes.tolist() == LABELS[:1]


@pytest.mark.parametrize("decoder", ["yolox", "yolo", "picodet", "detr"])
def test_other_outputs_are_an_error_that_names_the_card(decoder: str) -> None:
    with pytest.raises(InputError, match="card"):
        decode(decoder, [np.zeros((1, 3, 7), np.float32)] * 2, READING)


def test_more_classes_than_names_are_an_error() -> None:
    with pytest.raises(InputError, match="names 60"):
        decode("detr", detr_outputs(), Reading(SIZE, 0.3, 60))


@given(st.integers(0, 2**32 - 1), st.integers(0, 300))
def test_no_two_of_a_class_overlap_and_each_lost_one_overlaps_a_surer(
    seed: int, count: int
) -> None:
    rng = np.random.default_rng(seed)
    low = rng.uniform(0, 100, (count, 2))
    boxes = Boxes(
        np.hstack([low, low + rng.uniform(1, 60, (count, 2))]),
        rng.integers(0, 3, count),
        np.sort(rng.random(count))[::-1],
    )
    kept = suppressed(boxes, 0.5)
    assert (np.diff(kept.scores) <= 0).all()
    for k in range(count):
        same = kept.classes == boxes.classes[k]
        overlap = iou(boxes.corners[k], kept.corners[same])
        survives = (boxes.scores[k] == kept.scores[same]).any()
        if survives:
            assert np.count_nonzero(overlap > 0.5) == 1  # itself
        else:
            assert ((overlap > 0.5) & (kept.scores[same] >= boxes.scores[k])).any()


def test_the_form_of_an_export_tells_its_card() -> None:
    image = {"images": [1, 3, 416, 416]}
    assert card_of_form({**image, "orig_target_sizes": [1, 2]}, [[1], [1], [1]]).decoder == "detr"
    assert card_of_form(image, [[1, 3549, 85]]).decoder == "yolox"
    assert card_of_form({"images": ["N", 3, 640, 640]}, [[1, 84, 8400]]).size == 640
    assert card_of_form(image, [[1, 1000]]) is None
    assert coco_names()[56] == "chair"


def test_a_card_beside_the_model_is_read_and_checked(tmp_path) -> None:
    model = tmp_path / "own.onnx"
    assert card_beside(model) is None
    card = tmp_path / "own.onnx.toml"
    card.write_text('decoder = "yolo"\nsize = 320\nnames = ["chair", "couch"]\n')
    assert card_beside(model).class_names == ("chair", "couch")
    card.write_text('decoder = "yolo"\nsizes = 320\n')
    with pytest.raises(ConfigError, match="sizes"):
        card_beside(model)
    card.write_text("decoder =")
    with pytest.raises(InputError, match="card"):
        card_beside(model)
