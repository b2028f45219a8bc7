"""What every registered detector owes its caller, held against each of them.

Those that need a model get one: `onnx` the three small ones beside the shared data, `huggingface`
tiny untrained ones of the real classes. `glee` needs its authors' code and checkpoint; where the
environment variable TOPONAV_GLEE names the folder it is held to the contract as well.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from shared_data import shared_model
from small_house import small_runner
from toponav.categories import DEFAULT_VOCABULARY
from toponav.envs.simulator import HouseEnv
from toponav.errors import InputError, MissingExtraError, TopoNavError
from toponav.geometry import Pose
from toponav.perception import (
    Detector,
    DetectorContext,
    PerceptionConfig,
    detect_all,
    detectors,
    make_detector,
)
from toponav.perception.boxes import Boxes, filled_boxes
from toponav.perception.object_masks import object_masks
from toponav.types import Action, Detections, Observation, SemanticSource
from true_frames import Truth, true_frame

VOCABULARY = ("chair", "couch", "tv_monitor", "bed")
ONNX_MODELS = {
    "deimv2": "deimv2_hgnetv2_femto_coco.onnx",
    "picodet": "picodet_s_416_coco.onnx",
    "yolox": "yolox_nano.onnx",
}
TINY_MODELS = ("grounding_dino", "owlv2")
SPECS = (
    *(name for name in detectors.names() if name not in ("onnx", "huggingface")),
    *(f"onnx:{name}" for name in ONNX_MODELS),
    *(f"huggingface:{name}" for name in TINY_MODELS),
)
CONFIG = PerceptionConfig.model_validate({"huggingface": {"threshold": 0.0}})
"""Untrained models score low; so they still detect."""

Build = Callable[[SemanticSource], Detector]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("models")


@pytest.fixture(params=SPECS)
def spec(request: pytest.FixtureRequest, folder: Path) -> str:
    """What `--detector` would say; skips without the model or the extra."""
    kind, _, model = request.param.partition(":")
    if kind == "onnx":
        pytest.importorskip("onnxruntime", reason="needs the extra onnx")
        return f"onnx:{shared_model(ONNX_MODELS[model])}"
    if kind == "huggingface":
        need_transformers()
        import tiny_models

        if not (folder / model).exists():
            (folder / model).mkdir()
            getattr(tiny_models, f"save_{model}")(folder / model)
        return f"huggingface:{folder / model}"
    if kind == "glee":
        if "TOPONAV_GLEE" not in os.environ:
            pytest.skip("TOPONAV_GLEE names no folder with GLEE's code and checkpoint")
        return f"glee:{os.environ['TOPONAV_GLEE']}"
    return kind


def need_transformers() -> None:
    for module in ("torch", "transformers"):
        pytest.importorskip(module, reason="needs the extra huggingface")


@pytest.fixture
def build(spec: str) -> Build:
    """Makes the detector, over a truth where it reads one."""
    return lambda source: make_detector(spec, DetectorContext(CONFIG, source, seed=3))


def test_every_registered_detector_is_held_to_it() -> None:
    assert {spec.partition(":")[0] for spec in SPECS} == set(detectors.names())


def check(seen: Detections, rgb: np.ndarray, vocabulary: tuple[str, ...]) -> None:
    count, (height, width) = len(seen), rgb.shape[:2]
    assert set(seen.labels) <= set(vocabulary)
    assert (seen.scores.dtype, seen.boxes.dtype) == (np.float32, np.float32)
    assert seen.masks.dtype == np.bool_
    assert seen.masks.shape == (count, height, width)
    assert ((seen.scores >= 0.0) & (seen.scores <= 1.0)).all()
    assert (seen.boxes >= 0.0).all()
    assert (seen.boxes <= [width, height, width, height]).all()
    assert (seen.boxes[:, :2] < seen.boxes[:, 2:]).all()


def assert_equal(one: Detections, other: Detections) -> None:
    assert one.labels == other.labels
    np.testing.assert_array_equal(one.scores, other.scores)
    np.testing.assert_array_equal(one.boxes, other.boxes)
    np.testing.assert_array_equal(one.masks, other.masks)


def labels(ids: np.ndarray, *categories: str) -> Truth:
    return Truth(true_frame(ids, categories))


def blank(height: int, width: int) -> Truth:
    return labels(np.full((height, width), -1, np.int32), "wall")


@cache
def env() -> HouseEnv:
    return small_runner().env


def look_around(detector: Detector, vocabulary: tuple[str, ...]) -> list[Detections]:
    """Detections in four directions where the scene's first episode starts, each one checked."""
    env().reset(seed=0, options={"target": "toilet"})
    seen = []
    for _ in range(4):
        rgb = env().observe().rgb
        seen.append(detector.detect(rgb, vocabulary))
        check(seen[-1], rgb, vocabulary)
        for _ in range(3):
            env().step(int(Action.TURN_LEFT))
    return seen


def sees_drawn_furniture(spec: str) -> bool:
    """Models trained on photographs are not sure to."""
    return not spec.startswith("onnx:")


def test_a_panorama_twice(build: Build, spec: str) -> None:
    first, second = (look_around(build(env().oracle), DEFAULT_VOCABULARY) for _ in range(2))
    assert any(len(seen) for seen in first) or not sees_drawn_furniture(spec)
    for one, other in zip(first, second, strict=True):
        assert_equal(one, other)


def test_labels_are_spelled_as_they_were_asked_for(build: Build, spec: str) -> None:
    asked = ("TV monitor", "Sofa", "potted plant", "shoe rack", "Picture")
    seen = look_around(build(env().oracle), asked)  # which checks that labels are among these
    assert any(len(detections) for detections in seen) or not sees_drawn_furniture(spec)


@pytest.mark.parametrize("vocabulary", [(), ("unicorn",), ("zyzzyva", "nobody's name for it")])
def test_words_that_nobody_knows(build: Build, spec: str, vocabulary: tuple[str, ...]) -> None:
    seen = look_around(build(env().oracle), vocabulary)
    if not vocabulary or not spec.startswith(("huggingface:", "glee:")):
        assert not any(len(detections) for detections in seen)  # any words mean something to those


@pytest.mark.parametrize("shade", [0, 255])
def test_an_image_of_nothing(build: Build, shade: int) -> None:
    rgb = np.full((48, 64, 3), shade, np.uint8)
    check(build(blank(48, 64)).detect(rgb, VOCABULARY), rgb, VOCABULARY)


@pytest.mark.parametrize("size", [(1, 1), (1, 9), (9, 1)])
def test_an_image_of_a_pixel_or_a_line(build: Build, size: tuple[int, int]) -> None:
    rgb = np.full((*size, 3), 127, np.uint8)
    check(build(blank(*size)).detect(rgb, VOCABULARY), rgb, VOCABULARY)


def test_an_image_of_something_twice(build: Build) -> None:
    ids = np.zeros((48, 64), np.int32)
    ids[10:40, 10:30] = 1
    rgb = np.random.default_rng(1).integers(0, 255, (48, 64, 3)).astype(np.uint8)
    detector = build(labels(ids, "wall", "chair"))
    first, second = (detector.detect(rgb, VOCABULARY) for _ in range(2))
    check(first, rgb, VOCABULARY)
    assert_equal(first, second)
    together = detect_all(detector, [rgb, rgb], VOCABULARY)
    assert [seen.labels for seen in together] == [first.labels] * 2


def test_three_hundred_detections(build: Build) -> None:
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


@pytest.mark.parametrize("content", [b"", b"\x08\x07 this is no model", b"<html>not found</html>"])
def test_corrupt_onnx_files_are_one_line(tmp_path: Path, content: bytes) -> None:
    pytest.importorskip("onnxruntime", reason="needs the extra onnx")
    (tmp_path / "model.onnx").write_bytes(content)
    said_of(f"onnx:{tmp_path / 'model.onnx'}", "model.onnx")


def test_a_model_cut_short_is_one_line(tmp_path: Path) -> None:
    pytest.importorskip("onnxruntime", reason="needs the extra onnx")
    whole = shared_model(ONNX_MODELS["yolox"]).read_bytes()
    (tmp_path / "half.onnx").write_bytes(whole[: len(whole) // 2])
    said_of(f"onnx:{tmp_path / 'half.onnx'}", "half.onnx")


@pytest.mark.parametrize("content", [None, "{}", "no json", '{"model_type": "bert"}'])
def test_wrong_model_folders_are_one_line(tmp_path: Path, content: str | None) -> None:
    need_transformers()
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
