"""What one has to know of a model to use it: a TOML file beside it, or what its form tells.

# yolox_nano.onnx.toml
decoder = "yolox"           # detr, picodet, yolox or yolo
size = 416                  # of the square input, pixels
channels = "bgr"
scale = 1.0                 # pixel values 0..255 are multiplied by it,
mean = [0.0, 0.0, 0.0]      # then the mean is taken off and the result is divided by
std = [1.0, 1.0, 1.0]       # the standard deviation
letterbox = true            # keep the sides' ratio and fill up with grey
names = "coco"              # or a list of class names
licence = "Apache-2.0"
"""

from __future__ import annotations

import json
import tomllib
from collections.abc import Mapping, Sequence
from importlib import resources
from pathlib import Path
from typing import Any, Literal

from pydantic import Field, ValidationError

from toponav.config_model import ConfigModel
from toponav.errors import ConfigError, InputError

Decoder = Literal["detr", "picodet", "yolox", "yolo"]
CARD_SUFFIX = ".toml"
IMAGENET_MEAN, IMAGENET_STD = (0.485, 0.456, 0.406), (0.229, 0.224, 0.225)
"""Of the colour values in 0..1."""

SIZES_INPUT = "orig_target_sizes"
"""A second input of this name marks the DETR family's export."""


class ModelCard(ConfigModel):
    """How a model's input is made and its output read."""

    decoder: Decoder
    """How boxes, classes and scores lie in the outputs."""

    size: int = Field(default=640, ge=32, le=4096)
    """Side of the square input, pixels."""

    channels: Literal["rgb", "bgr"] = "rgb"
    """Order of the input's colours."""

    scale: float = Field(default=1.0 / 255.0, gt=0.0)
    """Factor on the pixel values 0..255."""

    mean: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Taken off after scaling."""

    std: tuple[float, float, float] = (1.0, 1.0, 1.0)
    """Divided by at last."""

    letterbox: bool = False
    """Whether the image keeps the ratio of its sides, in the upper left, on grey."""

    names: tuple[str, ...] | Literal["coco"] = "coco"
    """The classes' names, in the order of their indices."""

    licence: str = "unknown"
    """Of the model."""

    @property
    def class_names(self) -> tuple[str, ...]:
        """The names, spelled out."""
        return coco_names() if self.names == "coco" else tuple(self.names)


def coco_names() -> tuple[str, ...]:
    """COCO's 80 detection classes in the order of their indices."""
    text = resources.files(__package__).joinpath("coco.json").read_text(encoding="utf-8")
    return tuple(json.loads(text))


def card_beside(model: Path) -> ModelCard | None:
    """The card beside a model: MODEL.onnx.toml, or else toponav.toml in its folder.

    Raises:
        ConfigError: The card is no TOML, or has an unknown key or an impossible value.
        InputError: It cannot be read.
    """
    for path in (model.with_name(model.name + CARD_SUFFIX), model.with_name("toponav.toml")):
        if path.is_file():
            try:
                data = tomllib.loads(path.read_text(encoding="utf-8"))
            except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
                raise InputError(f"cannot read the model card {path}: {error}") from error
            return _checked(data, path)
    return None


def _checked(data: dict[str, Any], path: Path) -> ModelCard:
    try:
        return ModelCard.model_validate(data)
    except ValidationError as error:
        first = error.errors()[0]
        key = ".".join(str(part) for part in first["loc"]) or "the whole"
        raise ConfigError(f"{path}: {key}: {first['msg']}") from error


def card_of_form(
    inputs: Mapping[str, Sequence[Any]], outputs: Sequence[Sequence[Any]]
) -> ModelCard | None:
    """The card of a COCO model that one of the known exporters wrote; None for any other form.

    Args:
        inputs: Shape of each input by name; a dimension that is not fixed is no number.
        outputs: Shapes of the outputs.
    """
    first = next(iter(inputs.values()), ())
    size = first[-1] if len(first) == 4 and isinstance(first[-1], int) else 640
    classes = len(coco_names())
    if SIZES_INPUT in inputs and len(outputs) == 3:
        return ModelCard(decoder="detr", size=size)
    widths = [shape[-1] if shape else None for shape in outputs]
    if len(outputs) == 8 and widths[:4] == [classes] * 4:
        return ModelCard(decoder="picodet", size=size, mean=IMAGENET_MEAN, std=IMAGENET_STD)
    if len(outputs) == 1 and widths[0] == classes + 5:
        return ModelCard(decoder="yolox", size=size, channels="bgr", scale=1.0, letterbox=True)
    if len(outputs) == 1 and len(outputs[0]) == 3 and outputs[0][1] == classes + 4:
        return ModelCard(decoder="yolo", size=size, letterbox=True)
    return None
