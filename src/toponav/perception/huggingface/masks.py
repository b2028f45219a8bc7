"""From boxes to masks with a model of the SAM family: SAM, SAM-HQ, SAM 2, SAM 3's tracker."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from toponav.perception.huggingface.loading import Loaded
from toponav.types import Detections


class MaskRefiner:
    """Makes the masks of detections that are boxes so far."""

    def __init__(self, loaded: Loaded) -> None:
        """Use a model that makes masks of boxes."""
        self._loaded = loaded

    def refine(self, rgb: NDArray[np.uint8], detections: Detections) -> Detections:
        """The same detections in the same order, with the masks of their objects.

        A mask is kept within its box. Where the model sees nothing in a box the mask is empty.

        Args:
            rgb: (H, W, 3) the image that the detections are of.
            detections: With masks that are filled boxes.
        """
        if not len(detections):
            return replace(detections, masks_are_boxes=False)
        processor, torch = self._loaded.processor, self._loaded.torch
        inputs = processor(
            images=Image.fromarray(rgb),
            input_boxes=[detections.boxes.astype(float).tolist()],
            return_tensors="pt",
        )
        sizes = [
            inputs.pop(key) for key in ("original_sizes", "reshaped_input_sizes") if key in inputs
        ]
        outputs = self._loaded.run(inputs)
        whole = processor.post_process_masks(outputs.pred_masks.float().cpu(), *sizes)[0]
        surest = outputs.iou_scores[0].argmax(dim=-1).cpu()
        masks = whole[torch.arange(len(surest)), surest].numpy().astype(np.bool_)
        return replace(detections, masks=masks & detections.masks, masks_are_boxes=False)
