"""A detector that runs an ONNX model on the CPU, or on a GPU where onnxruntime has one."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image
from pydantic import Field

from toponav.categories import canonical
from toponav.config_model import ConfigModel
from toponav.cores import usable_cores
from toponav.errors import InputError, MissingExtraError
from toponav.perception.base import Detector, DetectorContext, detectors
from toponav.perception.boxes import Boxes, filled_boxes, within
from toponav.perception.onnx.decoders import Reading, decode
from toponav.perception.onnx.model_card import SIZES_INPUT, ModelCard, card_beside, card_of_form
from toponav.types import Detections

NAME = "onnx"
WITHOUT_SPINNING = ("session.intra_op.allow_spinning", "0")
"""Threads that wait for work in a loop take twice the processor time and save none."""

GREY = 114
"""What a letterboxed input is filled up with."""

ONLY_ERRORS = 3
"""onnxruntime's log level: its warnings about exports fill the screen."""


class OnnxConfig(ConfigModel):
    """What counts as a detection."""

    threshold: float = Field(default=0.35, ge=0.0, le=1.0)
    """Least score."""

    most: int = Field(default=100, ge=1)
    """Detections in an image, the surest first."""

    threads: int = Field(default=0, ge=0)
    """Of the CPU; 0 takes as many as the process may use."""


class OnnxDetector:
    """Finds what its model was trained on; masks are filled boxes.

    A model of a closed set of classes detects those of the vocabulary that it knows, told apart by
    `canonical` names.
    """

    def __init__(self, model: Path, config: OnnxConfig | None = None) -> None:
        """Load a model, once a process.

        Raises:
            MissingExtraError: onnxruntime is not installed.
            InputError: No such file, no ONNX, or a form that needs a card and has none.
        """
        self._config = config or OnnxConfig()
        self._session, self.card = _load(model.resolve(), self._config.threads)
        self._names = tuple(canonical(name) for name in self.card.class_names)

    def detect(self, rgb: NDArray[np.uint8], vocabulary: Sequence[str]) -> Detections:
        """Objects of the named categories in an (H, W, 3) uint8 image, the surest first."""
        boxes = self._boxes(rgb)
        wanted = {canonical(name): name for name in vocabulary}
        known = np.array([name in wanted for name in self._names], np.bool_)
        kept = np.flatnonzero(known[boxes.classes])[: self._config.most]
        labels = [wanted[self._names[boxes.classes[k]]] for k in kept]
        return filled_boxes(labels, boxes.rows(kept), rgb.shape[0], rgb.shape[1])

    def _boxes(self, rgb: NDArray[np.uint8]) -> Boxes:
        """All boxes, in pixels of the image."""
        height, width = rgb.shape[:2]
        image, ratio = _prepared(rgb, self.card)
        feed: dict[str, NDArray[Any]] = {self._session.get_inputs()[0].name: image}
        inputs = {entry.name for entry in self._session.get_inputs()}
        if SIZES_INPUT in inputs:  # such a model answers in pixels of its own input
            feed[SIZES_INPUT] = np.array([[self.card.size, self.card.size]], np.int64)
        outputs = self._session.run(None, feed)
        reading = Reading(self.card.size, self._config.threshold, len(self._names))
        boxes = decode(self.card.decoder, outputs, reading)
        in_image = Boxes(boxes.corners / np.tile(ratio, 2), boxes.classes, boxes.scores)
        return within(in_image, height, width)


def _prepared(
    rgb: NDArray[np.uint8], card: ModelCard
) -> tuple[NDArray[np.float32], NDArray[np.float64]]:
    """(1, 3, S, S) the model's input, and (2,) its pixels a pixel of the image along x and y."""
    height, width = rgb.shape[:2]
    ratio = np.array([card.size / width, card.size / height])
    if card.letterbox:
        ratio[:] = ratio.min()
    scaled = np.maximum(np.rint(ratio * (width, height)).astype(int), 1)
    resized = Image.fromarray(rgb).resize((int(scaled[0]), int(scaled[1])))
    pixels = np.full((card.size, card.size, 3), GREY, np.uint8)
    pixels[: scaled[1], : scaled[0]] = np.asarray(resized)
    if card.channels == "bgr":
        pixels = pixels[..., ::-1]
    factor = np.array(card.scale / np.asarray(card.std), np.float32)
    offset = np.array(np.asarray(card.mean) / np.asarray(card.std), np.float32)
    planes = np.ascontiguousarray(pixels.transpose(2, 0, 1)) * factor[:, None, None]
    planes -= offset[:, None, None]
    return planes[None], ratio


@lru_cache(maxsize=4)
def _load(model: Path, threads: int) -> tuple[Any, ModelCard]:
    """The model's session and card."""
    onnxruntime = _import_onnxruntime()
    if not model.is_file():
        raise InputError(f"no such model: {model}; give --detector onnx:PATH/TO/MODEL.onnx")
    card = card_beside(model)
    options = onnxruntime.SessionOptions()
    options.log_severity_level = ONLY_ERRORS
    options.intra_op_num_threads = threads or usable_cores()
    options.add_session_config_entry(*WITHOUT_SPINNING)
    try:
        session = onnxruntime.InferenceSession(
            str(model), options, providers=onnxruntime.get_available_providers()
        )
    except Exception as error:  # onnxruntime's own classes have no common base
        first_line = str(error).partition("\n")[0]
        raise InputError(f"{model} is no ONNX model that can be run: {first_line}") from error
    inputs = {entry.name: entry.shape for entry in session.get_inputs()}
    outputs = [entry.shape for entry in session.get_outputs()]
    card = card or card_of_form(inputs, outputs)
    if card is None:
        raise InputError(
            f"{model} has inputs {inputs} and outputs {outputs}, which tell no known decoder: "
            f"write a model card {model.name}.toml beside it"
        )
    return session, card


def _import_onnxruntime() -> Any:
    try:
        import onnxruntime
    except ImportError as error:
        raise MissingExtraError(
            "the detector onnx needs onnxruntime: pip install 'toponav[onnx]'"
        ) from error
    return onnxruntime


@detectors.register(NAME)
def _onnx(context: DetectorContext) -> Detector:
    if not context.argument:
        raise InputError("name the model's file: --detector onnx:PATH/TO/MODEL.onnx")
    return OnnxDetector(Path(context.argument), context.config.onnx)
