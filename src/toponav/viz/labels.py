"""Where to write on a map: names of the objects on it, and spots that hide nothing."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from toponav.mapping.view import MapView

CELL_M = 0.1
"""Points of one category in touching cells of this size are one object."""
MIN_AREA_M2 = 0.3
"""Smaller objects are drawn but not named: their names would hide them."""
STOREY_M = (-0.3, 2.4)
"""Heights relative to the floor that belong to its picture."""
SIDES = ((1, 1), (1, -1), (-1, 1), (-1, -1), (0, 1), (0, -1), (1, 0), (-1, 0))
"""Where a label may lie, seen from its anchor, best first."""
OVERLAP_COST = 40.0
"""What covering another label counts, in hidden points."""


def on_this_floor(points: NDArray[np.floating], view: MapView) -> NDArray[np.bool_]:
    """(N,) bool: which of (N, 3) points lie on the floor that `view` shows."""
    height = points[:, 2] - view.floor_z
    return np.asarray((height > STOREY_M[0]) & (height < STOREY_M[1]))


def landmarks(view: MapView) -> list[tuple[str, NDArray[np.float64]]]:
    """Category and centre (x, y) of each large object mapped on this floor, by category."""
    found = []
    for category, cloud in sorted(view.objects.items()):
        points = cloud.points[on_this_floor(cloud.points, view), :2]
        if not len(points):
            continue
        cells = np.floor((points - points.min(axis=0)) / CELL_M).astype(int)
        raster = np.zeros(cells.max(axis=0) + 1, dtype=np.bool_)
        raster[cells[:, 0], cells[:, 1]] = True
        labels, count = ndimage.label(raster, structure=np.ones((3, 3)))
        for k in range(1, count + 1):
            if np.count_nonzero(labels == k) * CELL_M**2 >= MIN_AREA_M2:
                members = points[labels[cells[:, 0], cells[:, 1]] == k].astype(np.float64)
                found.append((category, (members.min(axis=0) + members.max(axis=0)) / 2.0))
    return found


def place_labels(
    anchors: NDArray[np.float64],
    sizes: Sequence[tuple[float, float]],
    busy: NDArray[np.float64],
    gap: float,
) -> NDArray[np.float64]:
    """The centre of each label, one after the other where it hides least.

    Args:
        anchors: (N, 2) what the labels belong to.
        sizes: N widths and heights, in the anchors' units.
        busy: (M, 2) points that should stay in sight.
        gap: Distance between an anchor and its label.

    Returns:
        (N, 2) centres.
    """
    centers = np.zeros((len(anchors), 2))
    half = np.array(sizes).reshape(-1, 2) / 2.0
    for i, anchor in enumerate(anchors):
        costs = []
        for side in SIDES:
            center = anchor + np.array(side) * (half[i] + gap)
            hidden = np.all(np.abs(busy - center) < half[i], axis=1).sum()
            apart = np.abs(centers[:i] - center) >= half[:i] + half[i]
            covered = np.count_nonzero(~apart.any(axis=1))
            costs.append((hidden + OVERLAP_COST * covered, center))
        centers[i] = min(costs, key=lambda choice: choice[0])[1]
    return centers
