"""Detections from a label image that another node publishes beside the colour image."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from toponav.categories import canonical
from toponav.types import Detections

LEAST_PIXELS_PER_MEGAPIXEL = 80.0
"""Smaller masks are not taken: 25 pixels of a 640 x 480 image."""


class LabelImageDetector:
    """Finds what the current label image names; a `Detector`."""

    def __init__(self) -> None:
        """Without a label image nothing is found."""
        self._labels: NDArray[np.int32] | None = None
        self._names: Sequence[str] = ()

    def show(self, labels: NDArray[np.int32], names: Sequence[str]) -> None:
        """Take the (H, W) indices into `names` of the image detected on next; -1 is nothing."""
        self._labels, self._names = labels, names

    def detect(self, rgb: NDArray[np.uint8], vocabulary: Sequence[str]) -> Detections:
        """Segments whose name is in the vocabulary, in order of their index, with score 1."""
        height, width = rgb.shape[:2]
        labels = self._labels
        if labels is None or labels.shape != (height, width):
            return Detections.empty(height, width)
        wanted = {canonical(name): name for name in vocabulary}
        pixels = np.bincount(labels[labels >= 0], minlength=1)[: len(self._names)]
        least = max(1.0, LEAST_PIXELS_PER_MEGAPIXEL * height * width * 1e-6)
        seen = [
            k
            for k in np.flatnonzero(pixels >= least).tolist()
            if canonical(self._names[k]) in wanted
        ]
        if not seen:
            return Detections.empty(height, width)
        masks = np.stack([labels == k for k in seen])
        return Detections(
            labels=tuple(wanted[canonical(self._names[k])] for k in seen),
            scores=np.ones(len(seen), np.float32),
            boxes=np.array([_box(mask) for mask in masks], np.float32),
            masks=masks,
        )


def _box(mask: NDArray[np.bool_]) -> tuple[int, int, int, int]:
    """x_min, y_min, x_max, y_max of a mask that is not empty, max exclusive."""
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    return int(columns[0]), int(rows[0]), int(columns[-1]) + 1, int(rows[-1]) + 1
