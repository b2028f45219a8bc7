"""The oracle detector against masks that are counted by hand."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from toponav.errors import InputError
from toponav.perception import DetectorContext, OracleDetector, PerceptionConfig, detectors
from toponav.perception.oracle import OracleConfig
from toponav.types import SemanticFrame
from true_frames import true_frame

CATEGORIES = ("wall", "sofa", "chair", "chair", "stairs")
EVERYTHING = OracleConfig(min_pixels_per_megapixel=0.0)


class Labels:
    """A source of one fixed frame."""

    def __init__(self, ids: np.ndarray) -> None:
        self._frame = true_frame(ids, CATEGORIES)

    def semantic_frame(self) -> SemanticFrame:
        return self._frame


def image(ids: np.ndarray) -> np.ndarray:
    return np.zeros((*np.shape(ids), 3), np.uint8)


def test_masks_and_boxes_are_those_of_the_instances() -> None:
    ids = np.zeros((6, 8), np.int32)
    ids[1:3, 2:5] = 2
    ids[4, 6:8] = 3
    ids[0, 0] = -1
    seen = OracleDetector(Labels(ids), EVERYTHING).detect(image(ids), ["chair", "sofa"])
    assert seen.labels == ("chair", "chair")
    assert seen.boxes.tolist() == [[2, 1, 5, 3], [6, 4, 8, 5]]
    assert seen.scores.tolist() == [1.0, 1.0]
    np.testing.assert_array_equal(seen.masks, [ids == 2, ids == 3])


@given(st.integers(0, 2**32 - 1), st.sets(st.sampled_from(["sofa", "chair", "stairs", "bed"])))
def test_random_frames_agree_with_a_loop_over_instances(seed: int, vocabulary: set[str]) -> None:
    ids = np.random.default_rng(seed).integers(-1, len(CATEGORIES), (5, 7)).astype(np.int32)
    seen = OracleDetector(Labels(ids), EVERYTHING).detect(image(ids), sorted(vocabulary))
    instances = true_frame(ids, CATEGORIES).instances
    expected = [i for i in instances if i.category in vocabulary and (ids == i.id).any()]
    assert seen.labels == tuple(i.category for i in expected)
    assert seen.masks.shape == (len(expected), 5, 7)
    for mask, box, instance in zip(seen.masks, seen.boxes, expected, strict=True):
        np.testing.assert_array_equal(mask, ids == instance.id)
        rows, columns = np.nonzero(mask)
        extent = [columns.min(), rows.min(), columns.max() + 1, rows.max() + 1]
        assert box.tolist() == extent


def test_a_mask_of_25_pixels_is_seen_at_640_by_480_and_one_of_24_is_not() -> None:
    ids = np.zeros((480, 640), np.int32)
    ids[0, :24] = 1
    ids[5, :25] = 2
    seen = OracleDetector(Labels(ids)).detect(image(ids), ["sofa", "chair"])
    assert seen.labels == ("chair",)


def test_the_threshold_scales_with_the_image() -> None:
    ids = np.zeros((120, 160), np.int32)  # a sixteenth of the pixels: 1.6 of them are enough
    ids[0, 0] = 1
    ids[5, :2] = 2
    seen = OracleDetector(Labels(ids)).detect(image(ids), ["sofa", "chair"])
    assert seen.labels == ("chair",)


def test_labels_are_spelled_as_in_the_vocabulary() -> None:
    ids = np.full((4, 4), 1, np.int32)
    detector = OracleDetector(Labels(ids))
    assert detector.detect(image(ids), ["couch", "bed"]).labels == ("couch",)
    assert detector.detect(image(ids), ["Sofa"]).labels == ("Sofa",)


@pytest.mark.parametrize("size", [(1, 1), (3, 2)])
def test_nothing_wanted_or_nothing_hit_is_an_empty_answer(size: tuple[int, int]) -> None:
    sofa, sky = np.full(size, 1, np.int32), np.full(size, -1, np.int32)
    for ids, vocabulary in ((sofa, []), (sofa, ["bed"]), (sky, ["sofa"])):
        seen = OracleDetector(Labels(ids)).detect(image(ids), vocabulary)
        assert len(seen) == 0
        assert seen.masks.shape == (0, *size)


def test_labels_of_another_image_are_refused() -> None:
    with pytest.raises(InputError, match="last observed"):
        OracleDetector(Labels(np.zeros((4, 4)))).detect(np.zeros((4, 5, 3), np.uint8), ["sofa"])


def test_the_registered_oracle_needs_a_source() -> None:
    ids = np.full((4, 4), 1, np.int32)
    detector = detectors.get("oracle")(DetectorContext(PerceptionConfig(), Labels(ids)))
    assert detector.detect(image(ids), ["sofa"]).labels == ("sofa",)
    with pytest.raises(InputError, match="needs a simulator"):
        detectors.get("oracle")(DetectorContext(PerceptionConfig()))
