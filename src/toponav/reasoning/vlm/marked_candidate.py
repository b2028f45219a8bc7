"""A candidate object marked in an image, closely and with what is around it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from PIL import Image
from scipy.ndimage import binary_dilation, binary_erosion

OUTLINE = (255, 0, 200)
"""A colour that few objects have."""

OUTLINE_SHARE = 0.006
"""Width of the outline, in longer sides of the image; at least one pixel."""

CROP_MARGIN = 0.35
"""Room left round the object in the close view, in its own sizes."""

CROP_SIDE = 448
"""Pixels of the longer side of the close view: smaller ones are enlarged."""


@dataclass(frozen=True, eq=False)
class MarkedCandidate:
    """Both views of one candidate.

    Attributes:
        context: (H, W, 3) uint8, the whole image with the object outlined.
        crop: (h, w, 3) uint8, the object from close by, outlined.
    """

    context: NDArray[np.uint8]
    crop: NDArray[np.uint8]


def mark_candidate(image: NDArray[np.uint8], mask: NDArray[np.bool_]) -> MarkedCandidate:
    """Outline an object in an image.

    Args:
        image: (H, W, 3) uint8.
        mask: (H, W) bool, the object; not empty.
    """
    context = _outlined(image, mask)
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    row = _window(rows[0], rows[-1] + 1, image.shape[0])
    column = _window(columns[0], columns[-1] + 1, image.shape[1])
    near, near_mask = image[row, column], mask[row, column]
    scale = CROP_SIDE / max(near.shape[:2])
    size = (max(1, round(near.shape[1] * scale)), max(1, round(near.shape[0] * scale)))
    enlarged = np.asarray(Image.fromarray(near).resize(size))
    grown = np.asarray(Image.fromarray(near_mask).resize(size, Image.Resampling.NEAREST))
    return MarkedCandidate(context, _outlined(enlarged, grown.astype(np.bool_)))


def _outlined(image: NDArray[np.uint8], mask: NDArray[np.bool_]) -> NDArray[np.uint8]:
    """The image with a line round the mask, outside of it, so that nothing of it is hidden."""
    width = max(1, round(OUTLINE_SHARE * max(image.shape[:2])))
    line = binary_dilation(mask, iterations=width) & ~mask
    if not line.any():  # the mask fills the image
        line = mask & ~binary_erosion(mask, iterations=width)
    marked = image.copy()
    marked[line] = OUTLINE
    return marked


def _window(low: int, high: int, end: int) -> slice:
    """A range with its margin, within the image."""
    margin = round(CROP_MARGIN * (high - low))
    return slice(max(0, low - margin), min(end, high + margin))
