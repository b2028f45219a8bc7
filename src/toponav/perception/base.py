"""The Detector seam: one RGB image and a vocabulary in, labelled masks out."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from toponav.registry import Registry
from toponav.types import Detections, SemanticSource


class Detector(Protocol):
    """Finds objects in an image.

    A detector may be called with any image of at least 1 x 1 pixels. It answers only with labels
    of the vocabulary, spelled as there; a name it cannot detect is not an error, it is just never
    found. Detections are in a deterministic order.
    """

    def detect(self, rgb: NDArray[np.uint8], vocabulary: Sequence[str]) -> Detections:
        """Objects of the named categories in an (H, W, 3) uint8 image."""
        ...


DetectorFactory = Callable[[SemanticSource | None, int], Detector]
"""Builds a detector from the ground-truth handle (oracles only) and the episode's seed."""

detectors: Registry[DetectorFactory] = Registry("detector")
