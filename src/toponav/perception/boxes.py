"""Boxes as models give them: without doubles, within the image, as detections."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from toponav.types import Detections


@dataclass(frozen=True, eq=False)
class Boxes:
    """Boxes in an image, the surest first.

    Attributes:
        corners: (N, 4) float64 x_min, y_min, x_max, y_max in pixels.
        classes: (N,) int64 class indices.
        scores: (N,) float64 in [0, 1].
    """

    corners: NDArray[np.float64]
    classes: NDArray[np.int64]
    scores: NDArray[np.float64]

    def __len__(self) -> int:
        return len(self.scores)

    def rows(self, kept: NDArray[np.integer]) -> Boxes:
        """Those at some rows, in that order."""
        return Boxes(self.corners[kept], self.classes[kept], self.scores[kept])


def best_class(
    corners: NDArray[np.floating], class_scores: NDArray[np.floating], threshold: float
) -> Boxes:
    """The boxes whose best class reaches a threshold, sorted by score.

    Args:
        corners: (N, 4).
        class_scores: (N, C).
        threshold: Least score.
    """
    classes = class_scores.argmax(axis=1)
    scores = class_scores[np.arange(len(classes)), classes]
    kept = np.flatnonzero(scores >= threshold)
    order = kept[np.argsort(-scores[kept], kind="stable")]
    return Boxes(
        corners[order].astype(np.float64),
        classes[order].astype(np.int64),
        np.clip(scores[order], 0.0, 1.0).astype(np.float64),
    )


def suppressed(boxes: Boxes, overlap: float) -> Boxes:
    """Without the boxes that overlap a surer one of their class by more than this IoU."""
    remaining = np.arange(len(boxes))
    kept = []
    while len(remaining):
        first, rest = remaining[0], remaining[1:]
        kept.append(first)
        same = boxes.classes[rest] == boxes.classes[first]
        double = same & (iou(boxes.corners[first], boxes.corners[rest]) > overlap)
        remaining = rest[~double]
    return boxes.rows(np.array(kept, dtype=np.int64))


def iou(box: NDArray[np.float64], others: NDArray[np.float64]) -> NDArray[np.float64]:
    """(N,) intersection over union of a (4,) box with (N, 4) others; 0 for empty ones."""
    low = np.maximum(box[:2], others[:, :2])
    high = np.minimum(box[2:], others[:, 2:])
    shared = np.prod(np.maximum(high - low, 0.0), axis=1)
    areas = np.prod(np.maximum(others[:, 2:] - others[:, :2], 0.0), axis=1)
    own = float(np.prod(np.maximum(box[2:] - box[:2], 0.0)))
    share: NDArray[np.float64] = shared / np.maximum(own + areas - shared, 1e-12)
    return share


def within(boxes: Boxes, height: int, width: int) -> Boxes:
    """Clipped to an image, without those of which less than a pixel is left along a side."""
    limits = np.array([width, height, width, height], np.float64)
    corners = np.clip(boxes.corners, 0.0, limits)
    inside = np.flatnonzero(((corners[:, 2:] - corners[:, :2]) >= 1.0).all(axis=1))
    return Boxes(corners, boxes.classes, boxes.scores).rows(inside)


def filled_boxes(labels: Sequence[str], boxes: Boxes, height: int, width: int) -> Detections:
    """Detections whose masks are their boxes, in an image of a size."""
    masks = np.zeros((len(labels), height, width), np.bool_)
    low, high = np.floor(boxes.corners[:, :2]), np.ceil(boxes.corners[:, 2:])
    for mask, (left, top), (right, bottom) in zip(
        masks, low.astype(int), high.astype(int), strict=True
    ):
        mask[top:bottom, left:right] = True
    return Detections(
        tuple(labels),
        boxes.scores.astype(np.float32),
        boxes.corners.astype(np.float32),
        masks,
        masks_are_boxes=True,
    )
