"""The map from above in its own colours: what a person recognises a room by."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from toponav.files import temporary_beside
from toponav.mapping.view import MapView, PointCloud

CEILING_M = 1.9
"""Points higher above the floor than this are left out: ceilings and lamps hide the room."""
PIXELS_PER_METRE = 140
POINT_M = 0.065
"""Every voxel is drawn as a square of this size, so that neighbours leave no cracks."""
BACKGROUND = 255
MAX_SIDE = 2400


def save_topdown_colors(view: MapView, path: Path) -> None:
    """Write the scene cloud as seen from above, higher points over lower ones."""
    image = Image.fromarray(draw_topdown_colors(view.scene, view.floor_z))
    temporary = temporary_beside(path)
    image.save(temporary)
    temporary.replace(path)


def draw_topdown_colors(scene: PointCloud, floor_z: float) -> NDArray[np.uint8]:
    """(H, W, 3) uint8, x to the right and y up."""
    below = scene.points[:, 2] < floor_z + CEILING_M
    points, colors = scene.points[below], scene.colors[below]
    if not len(points):
        return np.full((1, 1, 3), BACKGROUND, np.uint8)
    low, high = points[:, :2].min(axis=0), points[:, :2].max(axis=0)
    scale = min(PIXELS_PER_METRE, MAX_SIDE / max(float((high - low).max()), 0.1))
    width, height = (int(n) + 1 for n in np.ceil((high - low) * scale))
    half = max(1, round(POINT_M * scale / 2))
    image = np.full((height + 2 * half, width + 2 * half, 3), BACKGROUND, np.uint8)
    order = np.argsort(points[:, 2], kind="stable")
    column = ((points[order, 0] - low[0]) * scale).astype(int) + half
    row = height - 1 - ((points[order, 1] - low[1]) * scale).astype(int) + half
    for dx in range(-half, half):
        for dy in range(-half, half):
            image[row + dy, column + dx] = colors[order]
    return image
