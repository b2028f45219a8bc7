"""An adapter for GLEE: their code and checkpoints, our contract.

GLEE (Wu et al., CVPR 2024) is no package: its demo folder `app`, from the authors' repository, with
a checkpoint in it, is what one has. `docs/perception.md` tells how to get there.
"""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from toponav.categories import spoken
from toponav.config_model import ConfigModel
from toponav.errors import InputError, MissingExtraError
from toponav.perception.base import Detector, DetectorContext, detectors
from toponav.perception.glee.frames import GleeFrame, network_input
from toponav.types import Detections

NAME = "glee"

FILES = {
    "lite": ("GLEE/configs/R50.yaml", "GLEE_R50_Scaleup10m.pth"),
    "plus": ("GLEE/configs/SwinL.yaml", "GLEE_SwinL_Scaleup10m.pth"),
}
"""Configuration and checkpoint of each model, in the folder `app`."""


class GleeConfig(ConfigModel):
    """Which model, and what counts as a detection."""

    model: Literal["lite", "plus"] = "lite"
    """lite is the ResNet-50, plus the Swin-L."""

    threshold: float = Field(default=0.2, ge=0.0, le=1.0)
    """Least score; the demo's."""

    most: int = Field(default=50, ge=1)
    """Detections in an image, the surest first."""

    device: str = "auto"
    """cpu, cuda or cuda:1; auto takes CUDA where there is any."""


class GleeDetector:
    """Finds what is named, with masks of its own."""

    def __init__(self, folder: Path, config: GleeConfig | None = None) -> None:
        """Load a model, once a process.

        Args:
            folder: The `app` of the authors' repository.
            config: All else.

        Raises:
            InputError: The folder lacks the code or the checkpoint.
            MissingExtraError: torch, detectron2 or what else their code imports is not installed.
        """
        self._config = config or GleeConfig()
        self._torch, self._model = _load(folder.resolve(), self._config.model, self._config.device)

    def detect(self, rgb: NDArray[np.uint8], vocabulary: Sequence[str]) -> Detections:
        """Objects of the named categories in an (H, W, 3) uint8 image, the surest first."""
        names = list(dict.fromkeys(vocabulary))
        if not names:
            return Detections.empty(*rgb.shape[:2])
        torch, device = self._torch, next(self._model.parameters()).device
        image, frame = network_input(torch, rgb)
        phrases = [spoken(name) for name in names]
        with torch.inference_mode():
            outputs, _ = self._model(
                image.to(device), [], task="coco", batch_name_list=phrases, is_train=False
            )
        return read(torch, outputs, frame, names, self._config)


def read(
    torch: Any, outputs: Any, frame: GleeFrame, names: Sequence[str], config: GleeConfig
) -> Detections:
    """Detections of what the model answers for one image.

    Args:
        torch: The library.
        outputs: `pred_logits` (1, Q, C or more), `pred_boxes` (1, Q, 4) as centre and size relative
            to the padded input, `pred_masks` (1, Q, h, w) logits.
        frame: How the image lies in that input.
        names: What the C classes are called.
        config: What counts as a detection.
    """
    scores, classes = outputs["pred_logits"][0, :, : len(names)].sigmoid().max(dim=-1)
    order = torch.argsort(scores, descending=True, stable=True)[: config.most]
    order = order[scores[order] >= config.threshold]
    boxes = frame.boxes(outputs["pred_boxes"][0, order].float().cpu().numpy())
    masks = frame.masks(torch, outputs["pred_masks"][0, order].float())
    kept = np.flatnonzero(((boxes[:, 2:] - boxes[:, :2]) >= 1.0).all(axis=1))
    labels = [names[int(k)] for k in classes[order].cpu()]
    return Detections(
        tuple(labels[k] for k in kept),
        scores[order].float().cpu().numpy().astype(np.float32)[kept],
        boxes[kept].astype(np.float32),
        masks[kept],
    )


@lru_cache(maxsize=2)
def _load(folder: Path, model: str, device: str) -> tuple[Any, Any]:
    config_file, checkpoint = FILES[model]
    for part in ("GLEE/glee", config_file, checkpoint):
        if not (folder / part).exists():
            raise InputError(
                f"{folder} has no {part}: give --detector glee:APP, the folder app of GLEE's "
                "repository with its checkpoint in it (docs/perception.md)"
            )
    # Their code is imported from the folder, and opens the text encoder's files relative to it.
    if str(folder) not in sys.path:
        sys.path.append(str(folder))
    with contextlib.chdir(folder):
        torch, cfg, glee_model = _import_glee()
        cfg.merge_from_file(config_file)
        name = device if device != "auto" else "cuda" if torch.cuda.is_available() else "cpu"
        try:
            network = glee_model(cfg, None, name, None, True).to(name)
            weights = torch.load(checkpoint, map_location=name, weights_only=True)
            network.load_state_dict(weights, strict=False)
        except Exception as error:  # of whatever their code and the checkpoint's reader raise
            reason = str(error).strip().partition("\n")[0] or type(error).__name__
            raise InputError(f"{folder / checkpoint} cannot be loaded: {reason}") from error
    return torch, network.eval()


def _import_glee() -> tuple[Any, Any, Any]:
    """torch, GLEE's configuration before any file, and the class of its model."""
    try:
        import torch
        from detectron2.config import get_cfg
        from GLEE.glee.config import add_glee_config
        from GLEE.glee.config_deeplab import add_deeplab_config
        from GLEE.glee.models.glee_model import GLEE_Model
    except ImportError as error:
        raise MissingExtraError(
            f"the detector glee needs what GLEE's own code imports, and {error.name or error} is "
            "missing: install it as docs/perception.md says"
        ) from error
    cfg = get_cfg()
    add_deeplab_config(cfg)
    add_glee_config(cfg)
    return torch, cfg, GLEE_Model


@detectors.register(NAME)
def _glee(context: DetectorContext) -> Detector:
    if not context.argument:
        raise InputError(
            "name GLEE's folder: --detector glee:PATH/TO/GLEE/app (docs/perception.md)"
        )
    return GleeDetector(Path(context.argument), context.config.glee)
