"""From a model's outputs to boxes in pixels of its input, one function a family of exports."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from toponav.errors import InputError
from toponav.perception.boxes import Boxes, best_class, suppressed
from toponav.perception.onnx.model_card import Decoder

Outputs = Sequence[NDArray[Any]]
NMS_IOU = 0.5
"""Boxes of a class that overlap more than this show the same thing."""

YOLOX_STRIDES = (8, 16, 32)
PICODET_STRIDES = (8, 16, 32, 64)


@dataclass(frozen=True)
class Reading:
    """How outputs are read.

    Attributes:
        size: Side of the model's square input, pixels.
        threshold: Least score.
        classes: How many classes the model knows.
    """

    size: int
    threshold: float
    classes: int


def decode(decoder: Decoder, outputs: Outputs, reading: Reading) -> Boxes:
    """Boxes in pixels of the model's input, the surest first.

    Raises:
        InputError: The outputs are not what this decoder reads.
    """
    try:
        boxes = _DECODERS[decoder](outputs, reading)
    except (IndexError, ValueError) as error:
        shapes = ", ".join(str(output.shape) for output in outputs)
        raise InputError(
            f"outputs of shapes {shapes} are not what the decoder {decoder!r} reads; "
            "name the right one in the model's card"
        ) from error
    if len(boxes) and int(boxes.classes.max()) >= reading.classes:
        raise InputError(
            f"the model knows class {int(boxes.classes.max())}, its card names {reading.classes}"
        )
    return boxes


def _detr(outputs: Outputs, reading: Reading) -> Boxes:
    """DEIM, D-FINE, RT-DETR: labels, boxes and scores, decoded in the model; no doubles."""
    labels, corners, scores = (np.asarray(output)[0] for output in outputs)
    kept = np.flatnonzero(scores >= reading.threshold)
    order = kept[np.argsort(-scores[kept], kind="stable")]
    return Boxes(
        corners[order].astype(np.float64),
        labels[order].astype(np.int64),
        np.clip(scores[order], 0.0, 1.0).astype(np.float64),
    )


def _yolox(outputs: Outputs, reading: Reading) -> Boxes:
    """YOLOX: per cell offset of the centre, log of the size, objectness, classes."""
    (raw,) = outputs
    table = raw[0].astype(np.float64)
    cells, strides = _cells(reading.size, YOLOX_STRIDES)
    centers = (table[:, :2] + cells) * strides
    half = 0.5 * np.exp(np.clip(table[:, 2:4], -20.0, 20.0)) * strides
    corners = np.hstack([centers - half, centers + half])
    scores = table[:, 4:5] * table[:, 5:]
    return suppressed(best_class(corners, scores, reading.threshold), NMS_IOU)


def _yolo(outputs: Outputs, reading: Reading) -> Boxes:
    """YOLOv8 and its kind: (1, 4 + C, N), centre and size in pixels, classes."""
    (raw,) = outputs
    table = raw[0].T.astype(np.float64)
    half = 0.5 * table[:, 2:4]
    corners = np.hstack([table[:, :2] - half, table[:, :2] + half])
    return suppressed(best_class(corners, table[:, 4:], reading.threshold), NMS_IOU)


def _picodet(outputs: Outputs, reading: Reading) -> Boxes:
    """PicoDet: a stride's class scores, and the sides' distances as distributions over bins."""
    levels = len(PICODET_STRIDES)
    scores = np.concatenate([output[0] for output in outputs[:levels]]).astype(np.float64)
    bins = np.concatenate([output[0] for output in outputs[levels:]]).astype(np.float64)
    bins = bins.reshape(len(bins), 4, -1)
    weight = np.exp(bins - bins.max(axis=-1, keepdims=True))
    weight /= weight.sum(axis=-1, keepdims=True)
    sides = weight @ np.arange(bins.shape[-1])
    cells, strides = _cells(reading.size, PICODET_STRIDES)
    centers = (cells + 0.5) * strides
    corners = np.hstack([centers - sides[:, :2] * strides, centers + sides[:, 2:] * strides])
    return suppressed(best_class(corners, scores, reading.threshold), NMS_IOU)


def _cells(size: int, strides: tuple[int, ...]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """(N, 2) columns and rows of all cells of the strides' grids, and (N, 1) their strides."""
    cells, widths = [], []
    for stride in strides:
        side = -(-size // stride)
        rows, columns = np.mgrid[:side, :side]
        cells.append(np.stack([columns.ravel(), rows.ravel()], axis=-1))
        widths.append(np.full((side * side, 1), stride))
    return np.concatenate(cells).astype(np.float64), np.concatenate(widths).astype(np.float64)


_DECODERS: dict[Decoder, Callable[[Outputs, Reading], Boxes]] = {
    "detr": _detr,
    "picodet": _picodet,
    "yolox": _yolox,
    "yolo": _yolo,
}
