"""Detection by words: Grounding DINO, OWLv2 and their kin, asked for the vocabulary."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image
from pydantic import Field

from toponav.categories import spoken
from toponav.config_model import ConfigModel
from toponav.errors import InputError
from toponav.perception.base import Detector, DetectorContext, detectors
from toponav.perception.boxes import Boxes, filled_boxes, suppressed, within
from toponav.perception.huggingface.loading import Dtype, Loaded, Runtime, load
from toponav.perception.huggingface.masks import MaskRefiner
from toponav.perception.huggingface.phrases import grounding_prompts
from toponav.types import Detections

NAME = "huggingface"
GROUNDING = ("grounding-dino", "mm-grounding-dino")
"""Model types that score the tokens of one text; the others score one text a category."""

QUERIES = ("owlv2", "owlvit")
"""Model types that score one text a category."""

QUERY = "a photo of a {}"
"""What those were trained with."""

OVERLAP = 0.7
"""Boxes that overlap a surer one of their class by a larger IoU are doubles."""


class HuggingFaceConfig(ConfigModel):
    """What runs, and what counts as a detection."""

    threshold: float = Field(default=0.3, ge=0.0, le=1.0)
    """Least score: of the words' mean for Grounding DINO, of the text for OWLv2, which scores
    lower (0.15 suits it)."""

    most: int = Field(default=100, ge=1)
    """Detections in an image, the surest first."""

    masks: str = ""
    """A model that makes masks of boxes, such as facebook/sam2.1-hiera-tiny, by name or folder;
    without one the depth image tells the object in its box."""

    device: str = "auto"
    """cpu, cuda, cuda:1, mps; auto takes the best there is."""

    dtype: Dtype = "auto"
    """Precision of the arithmetic: auto is float16 on CUDA and float32 elsewhere."""

    batch: int = Field(default=4, ge=1)
    """Images that are looked at together where several are at hand."""


class HuggingFaceDetector:
    """Finds what is named, in any words; a `BatchDetector`.

    Masks are filled boxes, or what a second model makes of the boxes.
    """

    def __init__(self, name: str, config: HuggingFaceConfig | None = None) -> None:
        """Load a model, once a process.

        Args:
            name: A folder that `save_pretrained` wrote, or a name on the hub.
            config: All else.

        Raises:
            MissingExtraError: torch or transformers is not installed.
            InputError: No such model, or one that does not detect by words.
        """
        self._config = config or HuggingFaceConfig()
        runtime = Runtime(self._config.device, self._config.dtype)
        self._loaded = load(name, "detection", runtime)
        self._type = str(self._loaded.model.config.model_type)
        if self._type not in (*GROUNDING, *QUERIES):
            known = ", ".join((*GROUNDING, *QUERIES))
            raise InputError(f"{name} is a model of type {self._type}; this detector reads {known}")
        masks = self._config.masks
        self._refiner = MaskRefiner(load(masks, "masks", runtime)) if masks else None

    def detect(self, rgb: NDArray[np.uint8], vocabulary: Sequence[str]) -> Detections:
        """Objects of the named categories in an (H, W, 3) uint8 image, the surest first."""
        return self.detect_all([rgb], vocabulary)[0]

    def detect_all(
        self, images: Sequence[NDArray[np.uint8]], vocabulary: Sequence[str]
    ) -> list[Detections]:
        """Objects of the named categories in each of several images, such as a panorama's."""
        names = list(dict.fromkeys(vocabulary))
        if not names:
            return [Detections.empty(*rgb.shape[:2]) for rgb in images]
        size = self._config.batch
        parts = [images[start : start + size] for start in range(0, len(images), size)]
        return [found for part in parts for found in self._detect_batch(part, names)]

    def _detect_batch(
        self, images: Sequence[NDArray[np.uint8]], names: Sequence[str]
    ) -> list[Detections]:
        phrases = [spoken(name) for name in names]
        find = self._grounded if self._type in GROUNDING else self._queried
        pictures = [Image.fromarray(rgb) for rgb in images]
        found = [
            self._kept(within(boxes, *rgb.shape[:2]))
            for boxes, rgb in zip(find(pictures, phrases), images, strict=True)
        ]
        detections = [
            filled_boxes([names[k] for k in boxes.classes], boxes, *rgb.shape[:2])
            for boxes, rgb in zip(found, images, strict=True)
        ]
        if self._refiner is None:
            return detections
        return [self._refiner.refine(*pair) for pair in zip(images, detections, strict=True)]

    def _grounded(self, pictures: list[Image.Image], phrases: Sequence[str]) -> list[Boxes]:
        """Grounding DINO: one text names everything; a box answers to a phrase by its words."""
        loaded = self._loaded
        longest = int(loaded.model.config.max_text_len)
        parts = []
        for part, prompt in grounding_prompts(loaded.processor.tokenizer, phrases, longest):
            outputs = loaded.run(_inputs(loaded, pictures, [prompt.text] * len(pictures)))
            tokens = outputs.logits.sigmoid().float().cpu().numpy()
            relative = outputs.pred_boxes.float().cpu().numpy()
            parts.append([
                _best(_corners(relative[k], *picture.size), prompt.scores(tokens[k]), part.start)
                for k, picture in enumerate(pictures)
            ])  # fmt: skip
        return [_joined(boxes) for boxes in zip(*parts, strict=True)]

    def _queried(self, pictures: list[Image.Image], phrases: Sequence[str]) -> list[Boxes]:
        """OWLv2: one text a category; the image is padded to a square, below and at the right."""
        loaded = self._loaded
        texts = [QUERY.format(phrase) for phrase in phrases]
        inputs = _inputs(loaded, pictures, [texts] * len(pictures), truncation=True)
        outputs = loaded.run(inputs)
        scores = outputs.logits.sigmoid().float().cpu().numpy()
        relative = outputs.pred_boxes.float().cpu().numpy()
        boxes = []
        for k, picture in enumerate(pictures):
            side = max(picture.size)
            sides = (side, side) if self._type == "owlv2" else picture.size
            boxes.append(_best(_corners(relative[k], *sides), scores[k], 0))
        return boxes

    def _kept(self, boxes: Boxes) -> Boxes:
        """Those that reach the threshold, without doubles, the surest first."""
        sure = np.flatnonzero(boxes.scores >= self._config.threshold)
        order = sure[np.argsort(-boxes.scores[sure], kind="stable")]
        kept = suppressed(boxes.rows(order), OVERLAP)
        return kept.rows(np.arange(min(len(kept), self._config.most)))


def _inputs(loaded: Loaded, pictures: list[Image.Image], text: Any, **more: Any) -> Any:
    return loaded.processor(
        images=pictures, text=text, return_tensors="pt", input_data_format="channels_last", **more
    )


def _corners(relative: NDArray[np.float32], width: int, height: int) -> NDArray[np.float64]:
    """(Q, 4) corners in pixels of (Q, 4) centres and sizes relative to an image."""
    middle, size = relative[:, :2].astype(np.float64), relative[:, 2:].astype(np.float64)
    limits = np.array([width, height], np.float64)
    low, high = (middle - size / 2.0) * limits, (middle + size / 2.0) * limits
    return np.hstack([low, high])


def _best(corners: NDArray[np.float64], scores: NDArray[np.floating], first: int) -> Boxes:
    """Each box with its best class; the classes are numbered from `first` on."""
    classes = scores.argmax(axis=1).astype(np.int64)
    best = scores[np.arange(len(scores)), classes].astype(np.float64)
    return Boxes(corners, classes + first, best)


def _joined(parts: Sequence[Boxes]) -> Boxes:
    return Boxes(
        np.concatenate([boxes.corners for boxes in parts]),
        np.concatenate([boxes.classes for boxes in parts]),
        np.concatenate([boxes.scores for boxes in parts]),
    )


@detectors.register(NAME)
def _huggingface(context: DetectorContext) -> Detector:
    if not context.argument:
        raise InputError(
            "name the model: --detector huggingface:FOLDER, "
            "or one of the hub as huggingface:IDEA-Research/grounding-dino-tiny"
        )
    return HuggingFaceDetector(context.argument, context.config.huggingface)
