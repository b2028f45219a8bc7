"""Real models on real photographs."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from shared_data import shared_data, shared_model
from toponav.errors import InputError
from toponav.perception import DetectorContext, PerceptionConfig, make_detector
from toponav.perception.boxes import Boxes, filled_boxes
from toponav.perception.config import perception_preset

DEIM = "deimv2_hgnetv2_femto_coco.onnx"
VOCABULARY = ("bed", "chair", "sofa", "plant", "tv_monitor", "table", "toilet")


def detector(model: Path):
    pytest.importorskip("onnxruntime", reason="needs the extra onnx")
    return make_detector(f"onnx:{model}", DetectorContext(PerceptionConfig()))


@pytest.mark.parametrize("model", [DEIM, "picodet_s_416_coco.onnx", "yolox_nano.onnx"])
def test_furniture_in_photographs_is_found(model: str) -> None:
    finder, found = detector(shared_model(model)), []
    for photo in sorted(shared_data("photos").glob("*.jpg")):
        rgb = np.asarray(Image.open(photo).convert("RGB"))
        seen = finder.detect(rgb, VOCABULARY)
        assert seen.masks_are_boxes
        assert seen.masks.shape[1:] == rgb.shape[:2]
        found += seen.labels
    assert len(set(found)) >= 2


def test_boxes_are_filled_and_kept_within_the_image() -> None:
    boxes = Boxes(np.array([[2.4, 1.0, 5.2, 3.0]]), np.zeros(1, np.int64), np.array([0.5]))
    seen = filled_boxes(["bed"], boxes, 4, 8)
    assert np.argwhere(seen.masks[0]).min(axis=0).tolist() == [1, 2]
    assert np.argwhere(seen.masks[0]).max(axis=0).tolist() == [2, 5]
    assert seen.where(np.array([True])).masks_are_boxes


def test_names_of_no_file_and_of_no_detector_are_said(tmp_path: Path) -> None:
    pytest.importorskip("onnxruntime", reason="needs the extra onnx")
    with pytest.raises(InputError, match="no such model"):
        detector(tmp_path / "missing.onnx")
    with pytest.raises(InputError, match="unknown detector"):
        make_detector("onyx:model.onnx", DetectorContext(PerceptionConfig()))


def test_who_takes_detections_for_true_asks_for_more() -> None:
    thresholds = [perception_preset(name).onnx.threshold for name in ("paper", "default")]
    assert thresholds == [0.5, PerceptionConfig().onnx.threshold]
