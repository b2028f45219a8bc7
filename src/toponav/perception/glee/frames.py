"""How an image lies in GLEE's input, and how its answers come back to the image."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

SHORTER_SIDE = 800
"""The image is resized to this, pixels."""

STRIDE = 32
"""And filled up with zeros to multiples of this, below and at the right."""

MEAN, STD = (123.675, 116.28, 103.53), (58.395, 57.12, 57.375)
"""Of the colour values in 0..255, red first."""


@dataclass(frozen=True)
class GleeFrame:
    """The image, as it is resized, and the padded input: (height, width) in pixels each."""

    image: tuple[int, int]
    resized: tuple[int, int]
    padded: tuple[int, int]

    @classmethod
    def of(cls, height: int, width: int) -> GleeFrame:
        """The frame of an image of a size."""
        scale = SHORTER_SIDE / min(height, width)
        resized = (max(round(height * scale), 1), max(round(width * scale), 1))
        padded = (-(-resized[0] // STRIDE) * STRIDE, -(-resized[1] // STRIDE) * STRIDE)
        return cls((height, width), resized, padded)

    def boxes(self, relative: NDArray[np.floating]) -> NDArray[np.float64]:
        """(N, 4) corners in pixels of the image of centres and sizes relative to the input."""
        middle, size = relative[:, :2].astype(np.float64), relative[:, 2:].astype(np.float64)
        corners = np.hstack([middle - size / 2.0, middle + size / 2.0])
        padded, resized, image = (
            np.tile(side[::-1], 2) for side in (self.padded, self.resized, self.image)
        )
        in_image: NDArray[np.float64] = np.clip(corners * padded / resized, 0.0, 1.0) * image
        return in_image

    def masks(self, torch: Any, logits: Any) -> NDArray[np.bool_]:
        """(N, H, W) masks of the image of (N, h, w) logits that cover the input."""
        if not len(logits):
            return np.zeros((0, *self.image), np.bool_)
        whole = _resized(torch, logits[:, None], self.padded)
        inner = whole[..., : self.resized[0], : self.resized[1]]
        masks: NDArray[np.bool_] = (_resized(torch, inner, self.image)[:, 0] > 0.0).cpu().numpy()
        return masks


def network_input(torch: Any, rgb: NDArray[np.uint8]) -> tuple[Any, GleeFrame]:
    """(1, 3, H', W') float32 tensor of an (H, W, 3) image, and how the image lies in it."""
    frame = GleeFrame.of(*rgb.shape[:2])
    normal = (rgb.astype(np.float32) - np.array(MEAN, np.float32)) / np.array(STD, np.float32)
    channels = torch.from_numpy(np.ascontiguousarray(normal.transpose(2, 0, 1)))[None]
    padded = torch.zeros(1, 3, *frame.padded)
    padded[..., : frame.resized[0], : frame.resized[1]] = _resized(torch, channels, frame.resized)
    return padded, frame


def _resized(torch: Any, images: Any, size: tuple[int, int]) -> Any:
    return torch.nn.functional.interpolate(images, size=size, mode="bilinear", align_corners=False)
