"""The stand-ins for models: affinities asked once, and an image by its best object."""

from __future__ import annotations

import numpy as np
import pytest
from words import Words

from drawn_map import detections_of
from toponav.baselines.relevance import Relevance


def test_every_name_is_asked_once() -> None:
    words = Words({"chair": 0.5, "bed": 0.2, "rug": 0.4})
    relevance = Relevance(words, "sofa")
    np.testing.assert_array_equal(relevance.of_objects(["bed", "chair", "bed"]), [0.2, 0.5, 0.2])
    np.testing.assert_array_equal(relevance.of_objects(["rug", "bed"]), [0.4, 0.2])
    assert words.asked == ["bed", "chair", "rug"]
    assert relevance.of_objects([]).shape == (0,)
    assert len(words.asked) == 3


def test_rooms_are_asked_apart_from_objects() -> None:
    words = Words({"kitchen": 0.5})
    relevance = Relevance(words, "sofa")
    relevance.of_objects(["kitchen"])
    np.testing.assert_array_equal(relevance.of_rooms(["kitchen", "kitchen"]), [0.5, 0.5])
    assert words.asked == ["kitchen", "kitchen"]


def test_an_image_is_worth_its_best_object_times_its_score() -> None:
    relevance = Relevance(Words({"chair": 0.5, "bed": 0.2}), "sofa")
    box = (0, 0, 4, 4)
    seen = detections_of({"chair": box, "bed": box}, [0.3, 0.9])
    assert relevance.of_image(seen) == pytest.approx(0.18)
    assert relevance.of_image(detections_of({}, [])) == 0.0
