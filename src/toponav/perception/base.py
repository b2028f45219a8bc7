"""The Detector seam: one RGB image and a vocabulary in, labelled masks out."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from toponav.registry import IN_FILE, Registry
from toponav.types import Detections, SemanticSource

if TYPE_CHECKING:
    from toponav.perception.config import PerceptionConfig


class Detector(Protocol):
    """Finds objects in an image.

    A detector may be called with any image of at least 1 x 1 pixels. It answers only with labels
    of the vocabulary, spelled as there; a name it cannot detect is not an error, it is just never
    found. Detections are in a deterministic order.
    """

    def detect(self, rgb: NDArray[np.uint8], vocabulary: Sequence[str]) -> Detections:
        """Objects of the named categories in an (H, W, 3) uint8 image."""
        ...


@runtime_checkable
class BatchDetector(Detector, Protocol):
    """A detector that is faster on several images at once, such as a panorama's, than one by one.

    An agent sees one image a step; recordings and benches have many at hand.
    """

    def detect_all(
        self, images: Sequence[NDArray[np.uint8]], vocabulary: Sequence[str]
    ) -> list[Detections]:
        """What `detect` says of each image; they may differ in size."""
        ...


def detect_all(
    detector: Detector, images: Sequence[NDArray[np.uint8]], vocabulary: Sequence[str]
) -> list[Detections]:
    """What any detector says of each of several images, together if it can."""
    if isinstance(detector, BatchDetector):
        return detector.detect_all(images, vocabulary)
    return [detector.detect(rgb, vocabulary) for rgb in images]


@dataclass(frozen=True, eq=False)
class DetectorContext:
    """What a detector is built from; it takes what it needs.

    Attributes:
        config: Every parameter of perception.
        source: Handle on the ground truth, for detectors that stand for a real one; None where
            there is none.
        seed: Of the episode.
        argument: What follows the detector's name and a colon, such as a model's path.
    """

    config: PerceptionConfig
    source: SemanticSource | None = None
    seed: int = 0
    argument: str = ""


DetectorFactory = Callable[[DetectorContext], Detector]

detectors: Registry[DetectorFactory] = Registry("detector")


def make_detector(spec: str, context: DetectorContext) -> Detector:
    """The detector of a name, or of a name and its argument, such as `onnx:model.onnx`.

    `FILE.py:NAME` is a name: what that file registers.

    Raises:
        InputError: No such detector, or it cannot be made of this.
    """
    name, argument = _name_and_argument(spec)
    return detectors.get(name)(replace(context, argument=argument))


def check_detector(spec: str) -> None:
    """Make sure that a detector of this name exists.

    Raises:
        InputError: It does not; the message lists those known.
    """
    detectors.get(_name_and_argument(spec)[0])


def _name_and_argument(spec: str) -> tuple[str, str]:
    if IN_FILE in spec:
        return spec, ""
    name, _, argument = spec.partition(":")
    return name, argument
