"""What of GLEE's adapter runs without its weights: the way in, the way back, and what is said."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

from toponav.errors import InputError, MissingExtraError
from toponav.perception import DetectorContext, PerceptionConfig, make_detector
from toponav.perception.glee.detector import FILES, GleeConfig, read
from toponav.perception.glee.frames import MEAN, STD, GleeFrame, network_input

SIZE = (300, 437)
BOX = np.array([50.0, 60.0, 250.0, 210.0])


@pytest.fixture
def torch():
    return pytest.importorskip("torch", reason="needs the extra huggingface")


def relative(frame: GleeFrame, box: np.ndarray) -> np.ndarray:
    """Centre and size as the model says them of a box in the image."""
    scale = np.tile(np.array(frame.resized[::-1]) / frame.image[::-1] / frame.padded[::-1], 2)
    corners = box * scale
    return np.hstack([(corners[:2] + corners[2:]) / 2.0, corners[2:] - corners[:2]])


def test_boxes_come_back_to_the_image() -> None:
    frame = GleeFrame.of(*SIZE)
    np.testing.assert_allclose(frame.boxes(relative(frame, BOX)[None]), [BOX], atol=1e-6)
    everything = frame.boxes(np.array([[0.5, 0.5, 1.0, 1.0]]))
    assert everything.tolist() == [[0.0, 0.0, SIZE[1], SIZE[0]]]


@pytest.mark.parametrize("size", [SIZE, (480, 640), (1, 1), (7, 400)])
def test_the_input_is_a_multiple_of_the_stride(size: tuple[int, int]) -> None:
    frame = GleeFrame.of(*size)
    assert min(frame.resized) == 800
    assert all(side % 32 == 0 for side in frame.padded)
    assert all(0 <= p - r < 32 for p, r in zip(frame.padded, frame.resized, strict=True))


def test_the_image_fills_the_upper_left_normalised(torch) -> None:
    rgb = np.broadcast_to(np.array([10, 100, 200], np.uint8), (*SIZE, 3))
    image, frame = network_input(torch, rgb)
    assert image.shape == (1, 3, *frame.padded)
    expected = (np.array([10, 100, 200]) - MEAN) / np.array(STD)
    inside = image[0, :, : frame.resized[0], : frame.resized[1]].numpy()
    np.testing.assert_allclose(
        inside, np.broadcast_to(expected[:, None, None], inside.shape), rtol=1e-4
    )
    assert not image[0, :, :, frame.resized[1] :].any()


def test_answers_become_detections(torch) -> None:
    frame = GleeFrame.of(*SIZE)
    logits = torch.full((1, 3, 4), -9.0)  # the last column is of no class that was asked for
    logits[0, 0, 1], logits[0, 1, 0], logits[0, 2, 3] = 0.0, 2.0, 9.0
    boxes = torch.tensor(np.tile(relative(frame, BOX), (1, 3, 1)), dtype=torch.float32)
    rows, columns = np.mgrid[: frame.padded[0] : 4, : frame.padded[1] : 4] + 2.0
    x, y = (columns * SIZE[1] / frame.resized[1], rows * SIZE[0] / frame.resized[0])
    inside = (x > BOX[0]) & (x < BOX[2]) & (y > BOX[1]) & (y < BOX[3])
    masks = torch.tensor(np.where(inside, 5.0, -5.0), dtype=torch.float32).expand(1, 3, -1, -1)
    outputs = {"pred_logits": logits, "pred_boxes": boxes, "pred_masks": masks}
    seen = read(torch, outputs, frame, ["chair", "tv_monitor", "bed"], GleeConfig(threshold=0.3))
    assert seen.labels == ("chair", "tv_monitor")
    np.testing.assert_allclose(seen.scores, [1 / (1 + np.exp(-2.0)), 0.5], rtol=1e-5)
    np.testing.assert_allclose(seen.boxes, [BOX, BOX], atol=1e-3)
    expected = np.zeros(SIZE, np.bool_)
    expected[60:210, 50:250] = True
    assert np.count_nonzero(seen.masks[0] ^ expected) < 0.03 * expected.sum()
    assert not seen.masks_are_boxes


def test_a_folder_without_code_or_checkpoint_is_said(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="has no GLEE/glee"):
        make_detector(f"glee:{tmp_path}", DetectorContext(PerceptionConfig()))
    (tmp_path / "GLEE/glee").mkdir(parents=True)
    with pytest.raises(InputError, match=r"R50\.yaml"):
        make_detector(f"glee:{tmp_path}", DetectorContext(PerceptionConfig()))


def test_what_their_code_lacks_is_said(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for part in FILES["lite"]:
        (tmp_path / part).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / part).touch()
    (tmp_path / "GLEE/glee").mkdir()
    monkeypatch.setattr(sys, "path", list(sys.path))
    monkeypatch.setitem(sys.modules, "detectron2", None)
    with pytest.raises(MissingExtraError, match=r"(torch|detectron2).* is missing"):
        make_detector(f"glee:{tmp_path}", DetectorContext(PerceptionConfig()))
