"""Colours by which a semantic mesh names its objects.

A `.semantic.txt` gives each object an sRGB colour; the mesh holds it in linear light, as glTF wants
of vertex colours, and Habitat converts it to sRGB before it compares.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

STRIDE = 2_654_435
"""Step through the palette, so that neighbouring objects differ in hue; coprime with its size."""

MAX_COLOR_ERROR = 4.0
"""A colour this far (of 255) from an object's is that object's: textures are compressed."""


def srgb_from_linear(linear: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Bytes in sRGB of linear ones."""
    x = linear / 255.0
    curved = np.where(x <= 0.0031308, 12.92 * x, 1.055 * x ** (1.0 / 2.4) - 0.055)
    return np.round(255.0 * curved).astype(np.uint8)


def palette(count: int) -> tuple[NDArray[np.uint8], NDArray[np.uint8]]:
    """As many distinct colours, black left out: (n, 3) linear bytes, and the same in sRGB.

    Only linear levels are used that no other one shares its sRGB byte with.
    """
    srgb = srgb_from_linear(np.arange(256, dtype=np.uint8))
    _, first, shared = np.unique(srgb, return_index=True, return_counts=True)
    levels = first[shared == 1].astype(np.uint8)
    size = len(levels)
    number = (STRIDE * np.arange(1, count + 1, dtype=np.int64)) % size**3
    linear = levels[np.stack([number // size**2, number // size % size, number % size], axis=-1)]
    return linear, srgb[linear]


def nearest_objects(
    colors: NDArray[np.uint8], object_colors: NDArray[np.uint8]
) -> NDArray[np.int64]:
    """(N,) index of the object whose colour is that of each of (N, 3) colours; -1 for none.

    Args:
        colors: sRGB.
        object_colors: (K, 3) sRGB, as the annotations name them.
    """
    distinct, inverse = np.unique(colors.reshape(-1, 3), axis=0, return_inverse=True)
    if not len(object_colors):
        return np.full(len(colors), -1)
    distance, index = cKDTree(object_colors.astype(np.float64)).query(distinct.astype(np.float64))
    found = np.where(distance <= MAX_COLOR_ERROR, index, -1)
    nearest: NDArray[np.int64] = found[inverse.reshape(-1)]
    return nearest
