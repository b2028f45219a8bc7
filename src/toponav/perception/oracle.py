"""The oracle detector: true labels through a handle that the runner injects."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from toponav.categories import canonical
from toponav.config_model import ConfigModel
from toponav.errors import InputError
from toponav.perception.base import Detector, DetectorContext, detectors
from toponav.types import Detections, SemanticSource


class OracleConfig(ConfigModel):
    """What the oracle is too far away to see."""

    min_pixels_per_megapixel: float = 80.0
    """Smaller masks are not detected: 25 pixels of a 640 x 480 image."""


class OracleDetector:
    """Detects every visible instance of the vocabulary with its exact mask and score 1."""

    def __init__(self, source: SemanticSource, config: OracleConfig | None = None) -> None:
        """Take the handle on the ground truth."""
        self._source = source
        self._config = config or OracleConfig()

    def detect(self, rgb: NDArray[np.uint8], vocabulary: Sequence[str]) -> Detections:
        """Visible instances whose canonical category is in the vocabulary, by instance id."""
        height, width = rgb.shape[:2]
        frame = self._source.semantic_frame()
        ids = frame.instance_ids
        if ids.shape != (height, width):
            raise InputError(
                f"the oracle's labels are {ids.shape}, the image is {(height, width)}: "
                "detect on the image last observed"
            )
        wanted = {canonical(name): name for name in vocabulary}
        pixels = np.bincount(ids[ids >= 0], minlength=len(frame.instances))
        threshold = max(1.0, self._config.min_pixels_per_megapixel * height * width * 1e-6)
        seen = [
            k for k in np.flatnonzero(pixels >= threshold) if frame.instances[k].category in wanted
        ]
        if not seen:
            return Detections.empty(height, width)
        masks = np.stack([ids == k for k in seen])
        return Detections(
            labels=tuple(wanted[frame.instances[k].category] for k in seen),
            scores=np.ones(len(seen), np.float32),
            boxes=np.stack([_box(mask) for mask in masks]),
            masks=masks,
        )


def _box(mask: NDArray[np.bool_]) -> NDArray[np.float32]:
    """(4,) x_min, y_min, x_max, y_max of a mask that is not empty, max exclusive."""
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    box = (columns[0], rows[0], columns[-1] + 1, rows[-1] + 1)
    return np.array(box, dtype=np.float32)


@detectors.register("oracle")
def _oracle(context: DetectorContext) -> Detector:
    if context.source is None:
        raise InputError("the oracle detector needs a simulator; choose another --detector")
    return OracleDetector(context.source, context.config.oracle)
