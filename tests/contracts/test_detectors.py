"""What every registered detector owes its caller."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from shared_data import shared_model
from small_house import small_runner
from toponav.categories import DEFAULT_VOCABULARY
from toponav.envs.simulator import HouseEnv
from toponav.perception import (
    Detector,
    DetectorContext,
    PerceptionConfig,
    detectors,
    make_detector,
)
from toponav.types import Action, Detections, SemanticSource
from true_frames import Truth, true_frame

MODELS = ("deimv2_hgnetv2_femto_coco.onnx", "picodet_s_416_coco.onnx", "yolox_nano.onnx")
SPECS = [name for name in detectors.names() if name != "onnx"] + [f"onnx:{m}" for m in MODELS]
every_detector = pytest.mark.parametrize("name", SPECS)


@cache
def env() -> HouseEnv:
    return small_runner().env


def build(name: str, source: SemanticSource | None = None) -> Detector:
    """A detector by name; a model's is a file beside the shared data."""
    kind, _, model = name.partition(":")
    if kind == "onnx":
        pytest.importorskip("onnxruntime", reason="needs the extra onnx")
        name = f"onnx:{shared_model(model)}"
    return make_detector(name, DetectorContext(PerceptionConfig(), source or env().oracle, 3))


def look_around(detector: Detector, vocabulary: tuple[str, ...]) -> list[Detections]:
    """Detections of a full turn at the start of the scene's first episode."""
    env().reset(seed=0, options={"target": "toilet"})
    seen = []
    for _ in range(12):
        seen.append(detector.detect(env().observe().rgb, vocabulary))
        env().step(int(Action.TURN_LEFT))
    return seen


@every_detector
def test_detections_keep_the_contract(name: str) -> None:
    seen = look_around(build(name), DEFAULT_VOCABULARY)
    height, width = env().intrinsics.height, env().intrinsics.width
    assert sum(len(detections) for detections in seen) > 0 or name.startswith("onnx")
    for detections in seen:
        assert set(detections.labels) <= set(DEFAULT_VOCABULARY)
        assert detections.scores.dtype == np.float32
        assert ((detections.scores >= 0.0) & (detections.scores <= 1.0)).all()
        assert detections.masks.dtype == np.bool_
        assert detections.masks.shape[1:] == (height, width)
        assert detections.boxes.dtype == np.float32
        x_min, y_min, x_max, y_max = detections.boxes.T
        assert ((x_min >= 0) & (x_min < x_max) & (x_max <= width)).all()
        assert ((y_min >= 0) & (y_min < y_max) & (y_max <= height)).all()


@every_detector
def test_the_same_images_give_the_same_detections(name: str) -> None:
    first = look_around(build(name), DEFAULT_VOCABULARY)
    for a, b in zip(first, look_around(build(name), DEFAULT_VOCABULARY), strict=True):
        assert a.labels == b.labels
        np.testing.assert_array_equal(a.scores, b.scores)
        np.testing.assert_array_equal(a.boxes, b.boxes)
        np.testing.assert_array_equal(a.masks, b.masks)


@every_detector
@pytest.mark.parametrize("vocabulary", [(), ("unicorn",), ("unicorn", "dragon")])
def test_what_is_not_there_is_never_found(name: str, vocabulary: tuple[str, ...]) -> None:
    assert all(not len(detections) for detections in look_around(build(name), vocabulary))


@every_detector
def test_labels_are_spelled_as_they_were_asked_for(name: str) -> None:
    asked = ("TV monitor", "Sofa", "potted plant", "shoe rack", "Picture")
    labels = {label for seen in look_around(build(name), asked) for label in seen.labels}
    assert labels or name.startswith("onnx")  # it is not sure to know such drawn furniture
    assert labels <= set(asked)


@every_detector
def test_an_image_of_one_pixel_will_do(name: str) -> None:
    chair = Truth(true_frame([[0]], ["chair"]))
    detector = build(name, chair)
    detections = detector.detect(np.zeros((1, 1, 3), np.uint8), ("chair",))
    assert detections.masks.shape[1:] == (1, 1)
