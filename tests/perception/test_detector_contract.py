"""The contract of a detector, held against every one that is registered."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

from shared_data import shared_model
from toponav.errors import InputError, MissingExtraError, TopoNavError
from toponav.geometry import Pose
from toponav.perception import (
    DetectorContext,
    PerceptionConfig,
    detect_all,
    detectors,
    make_detector,
)
from toponav.perception.boxes import Boxes, filled_boxes
from toponav.perception.object_masks import object_masks
from toponav.types import Observation
from true_frames import Truth, true_frame

VOCABULARY = ("chair", "couch", "tv_monitor", "bed")
MODELS = {
    "deimv2": "deimv2_hgnetv2_femto_coco.onnx",
    "picodet": "picodet_s_416_coco.onnx",
    "yolox": "yolox_nano.onnx",
}
CONFIG = PerceptionConfig.model_validate({"huggingface": {"threshold": 0.0}})
"""Untrained models score low; so they still detect."""


def labels(ids: np.ndarray, *categories: str) -> Truth:
    return Truth(true_frame(ids, categories))


def blank(height: int, width: int) -> Truth:
    return labels(np.full((height, width), -1, np.int32), "wall")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("models")


def spec_of(name: str, folder: Path) -> str:
    """What `--detector` would say; skips without the model or the extra."""
    if name in MODELS:
        pytest.importorskip("onnxruntime", reason="needs the extra onnx")
        return f"onnx:{shared_model(MODELS[name])}"
    if name in ("grounding_dino", "owlv2"):
        pytest.importorskip("torch", reason="needs the extra huggingface")
        pytest.importorskip("transformers", reason="needs the extra huggingface")
        import tiny_models

        if not (folder / name).exists():
            (folder / name).mkdir()
            getattr(tiny_models, f"save_{name}")(folder / name)
        return f"huggingface:{folder / name}"
    return name


CASES = ("oracle", "noisy", *MODELS, "grounding_dino", "owlv2")


@pytest.fixture(params=CASES)
def build(request: pytest.FixtureRequest, folder: Path):
    """Makes the detector for a frame."""
    spec = spec_of(request.param, folder)

    def made(source: Truth):
        return make_detector(spec, DetectorContext(CONFIG, source, seed=3))

    return made


def test_every_registered_detector_is_held_to_it() -> None:
    told_elsewhere = {"glee"}  # needs its authors' code: test_glee.py
    held = {"onnx", "huggingface", *CASES} - {*MODELS, "grounding_dino", "owlv2"}
    assert set(detectors.names()) == held | told_elsewhere


def check(seen, rgb: np.ndarray, vocabulary: tuple[str, ...]) -> None:
    count, (height, width) = len(seen), rgb.shape[:2]
    assert set(seen.labels) <= set(vocabulary)
    assert (seen.scores.dtype, seen.boxes.dtype) == (np.float32, np.float32)
    assert seen.masks.shape == (count, height, width)
    assert ((seen.scores >= 0.0) & (seen.scores <= 1.0)).all()
    assert (seen.boxes >= 0.0).all()
    assert (seen.boxes <= [width, height, width, height]).all()
    assert (seen.boxes[:, :2] < seen.boxes[:, 2:]).all()


@pytest.mark.parametrize("shade", [0, 255])
def test_an_image_of_nothing(build, shade: int) -> None:
    rgb = np.full((48, 64, 3), shade, np.uint8)
    check(build(blank(48, 64)).detect(rgb, VOCABULARY), rgb, VOCABULARY)


@pytest.mark.parametrize("size", [(1, 1), (1, 9), (9, 1)])
def test_an_image_of_a_pixel_or_a_line(build, size: tuple[int, int]) -> None:
    rgb = np.full((*size, 3), 127, np.uint8)
    check(build(blank(*size)).detect(rgb, VOCABULARY), rgb, VOCABULARY)


def test_an_image_of_something_twice(build) -> None:
    ids = np.zeros((48, 64), np.int32)
    ids[10:40, 10:30] = 1
    rgb = np.random.default_rng(1).integers(0, 255, (48, 64, 3)).astype(np.uint8)
    detector = build(labels(ids, "wall", "chair"))
    first, second = (detector.detect(rgb, VOCABULARY) for _ in range(2))
    check(first, rgb, VOCABULARY)
    assert first.labels == second.labels
    np.testing.assert_array_equal(first.scores, second.scores)
    np.testing.assert_array_equal(first.masks, second.masks)
    together = detect_all(detector, [rgb, rgb], VOCABULARY)
    assert [seen.labels for seen in together] == [first.labels] * 2


@pytest.mark.parametrize("vocabulary", [(), ("zyzzyva",), ("an object nobody has named yet",)])
def test_vocabularies_that_it_does_not_know(build, vocabulary: tuple[str, ...]) -> None:
    rgb = np.random.default_rng(2).integers(0, 255, (48, 64, 3)).astype(np.uint8)
    check(build(blank(48, 64)).detect(rgb, vocabulary), rgb, vocabulary)


def test_three_hundred_detections(build) -> None:
    """As many things as that in one image, and what is made of them afterwards."""
    ids = np.arange(300, dtype=np.int32).reshape(15, 20).repeat(8, axis=0).repeat(8, axis=1)
    rgb = np.random.default_rng(4).integers(0, 255, (*ids.shape, 3)).astype(np.uint8)
    seen = build(labels(ids, *("chair",) * 300)).detect(rgb, VOCABULARY)
    check(seen, rgb, VOCABULARY)


def test_three_hundred_boxes_become_objects() -> None:
    corners = [[x, y, x + 8, y + 8] for y in range(0, 120, 8) for x in range(0, 160, 8)]
    boxes = Boxes(np.array(corners, float), np.zeros(300, np.int64), np.ones(300))
    frame = labels(np.zeros((120, 160), np.int32), "chair").frame
    observation = Observation(
        np.zeros((120, 160, 3), np.uint8),
        frame.depth,
        frame.world_from_camera,
        Pose.identity(),
        frame.intrinsics,
    )
    seen = object_masks(observation, filled_boxes(["chair"] * 300, boxes, 120, 160))
    assert len(seen) == 300
    assert seen.masks.any(axis=(1, 2)).sum() > 100


@pytest.mark.parametrize("spec", ["onnx", "huggingface", "glee"])
def test_a_missing_argument_is_asked_for(spec: str) -> None:
    with pytest.raises(InputError, match=f"--detector {spec}:"):
        make_detector(spec, DetectorContext(PerceptionConfig()))


@pytest.mark.parametrize("spec", ["oracle", "noisy"])
def test_detectors_of_the_truth_need_a_simulator(spec: str) -> None:
    with pytest.raises(InputError, match="simulator"):
        make_detector(spec, DetectorContext(PerceptionConfig()))


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("model.onnx", b""),
        ("model.onnx", b"\x08\x07 this is no model"),
        ("model.onnx", b"<html>not found</html>"),
    ],
)
def test_corrupt_onnx_files_are_one_line(tmp_path: Path, name: str, content: bytes) -> None:
    pytest.importorskip("onnxruntime", reason="needs the extra onnx")
    (tmp_path / name).write_bytes(content)
    said_of(f"onnx:{tmp_path / name}", name)


def test_a_model_cut_short_is_one_line(tmp_path: Path) -> None:
    pytest.importorskip("onnxruntime", reason="needs the extra onnx")
    whole = shared_model(MODELS["yolox"]).read_bytes()
    (tmp_path / "half.onnx").write_bytes(whole[: len(whole) // 2])
    said_of(f"onnx:{tmp_path / 'half.onnx'}", "half.onnx")


@pytest.mark.parametrize("content", [None, "{}", "no json", '{"model_type": "bert"}'])
def test_wrong_model_folders_are_one_line(tmp_path: Path, content: str | None) -> None:
    pytest.importorskip("torch", reason="needs the extra huggingface")
    pytest.importorskip("transformers", reason="needs the extra huggingface")
    if content is not None:
        (tmp_path / "config.json").write_text(content, encoding="utf-8")
    said_of(f"huggingface:{tmp_path}", str(tmp_path))


def said_of(spec: str, name: str) -> None:
    """The detector cannot be made, and one line names the file."""
    with pytest.raises(TopoNavError) as caught:
        make_detector(spec, DetectorContext(PerceptionConfig()))
    assert name in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("module", "spec", "extra"),
    [
        ("onnxruntime", "onnx:model.onnx", r"toponav\[onnx\]"),
        ("torch", "huggingface:some/model", r"toponav\[huggingface\]"),
        ("transformers", "huggingface:some/model", r"toponav\[huggingface\]"),
    ],
)
def test_a_missing_extra_is_named(
    monkeypatch: pytest.MonkeyPatch, module: str, spec: str, extra: str
) -> None:
    monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(MissingExtraError, match=extra):
        make_detector(spec, DetectorContext(PerceptionConfig()))
