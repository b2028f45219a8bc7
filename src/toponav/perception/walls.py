"""Walls behind things: vertical planes in a box that go on beside it.

A thing ends within its box, a wall does not. What touches the wall, as a bed or a toilet does, has
no jump in depth towards it, and between the leaves of a plant the wall is the largest surface; so
walls are looked for beside the box, where the thing is not in the way.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

MARGIN = 0.2
LEAST_MARGIN = 8
"""What is beside a box: this share of its sides, and at least so many pixels."""

LEAST_BESIDE = 50
"""Fewer measured pixels beside a box tell nothing."""

MOST_BESIDE = 1500
"""Of more pixels so many, evenly spread, are taken."""

LINES = 60
"""Vertical planes that are tried, each through two pixels."""

APART_M = 0.15
"""Two pixels nearer to each other than this give no direction."""

OFF_M = 0.03
OFF_PER_M = 0.01
"""Points nearer to a plane than this, and this more a metre of depth, lie in it."""

SHARE = 0.25
"""Share of what is seen beside a box that a wall must fill."""

MOST_WALLS = 2
"""A corner shows two."""


def on_walls(
    points: NDArray[np.float64],
    depth: NDArray[np.float32],
    standing: NDArray[np.bool_],
    window: tuple[slice, slice],
) -> NDArray[np.bool_]:
    """Which pixels of a box lie in a wall that is also seen beside the box.

    Args:
        points: (H, W, 3) every pixel's point, world frame (z up), metres; of what was not measured,
            anything.
        depth: (H, W) along the optical axis, metres.
        standing: (H, W) whether the pixel was measured and is no floor.
        window: Rows and columns of the box.

    Returns:
        (h, w) over the window.
    """
    rows, columns = window
    around = tuple(_widened(side, end) for side, end in zip(window, standing.shape, strict=True))
    beside = standing[around].copy()
    top, left = around[0].start, around[1].start
    beside[rows.start - top : rows.stop - top, columns.start - left : columns.stop - left] = False
    places = points[around][beside][:, :2]
    inside = points[rows, columns, :2]
    found = np.zeros(inside.shape[:2], np.bool_)
    if len(places) < LEAST_BESIDE:
        return found
    places = places[:: -(-len(places) // MOST_BESIDE)]
    least = SHARE * len(places)
    off_m = OFF_M + OFF_PER_M * depth[rows, columns]
    rng = np.random.default_rng(0)  # the same image gives the same walls
    for _ in range(MOST_WALLS):
        line = _line(places, least, rng)
        if line is None:
            break
        normal, offset = line
        found |= np.abs(inside @ normal - offset) < off_m
        places = places[np.abs(places @ normal - offset) >= OFF_M]
    return found


def _widened(side: slice, end: int) -> slice:
    """One side of a box and its margins, within an image that ends there."""
    margin = max(LEAST_MARGIN, int(MARGIN * (side.stop - side.start)))
    return slice(max(0, side.start - margin), min(end, side.stop + margin))


def _line(
    places: NDArray[np.float64], least: float, rng: np.random.Generator
) -> tuple[NDArray[np.float64], float] | None:
    """The (2,) normal and the offset of the line on which most of (N, 2) places lie; None without.

    Args:
        places: World x and y, metres.
        least: How many of them must lie on it.
        rng: Draws the pairs that are tried.
    """
    if len(places) < least:
        return None
    first, second = places[rng.integers(len(places), size=(2, LINES))]
    along = second - first
    length = np.hypot(*along.T)
    along, first = along[length > APART_M], first[length > APART_M]
    if not len(along):
        return None
    normals = np.column_stack([-along[:, 1], along[:, 0]]) / np.hypot(*along.T)[:, None]
    offsets = (normals * first).sum(axis=1)
    near = np.abs(places @ normals.T - offsets) < OFF_M
    best = int(near.sum(axis=0).argmax())
    on_it = places[near[:, best]]
    if len(on_it) < least:
        return None
    middle = on_it.mean(axis=0)
    spread = on_it - middle
    normal: NDArray[np.float64] = np.linalg.eigh(spread.T @ spread)[1][:, 0]
    return normal, float(normal @ middle)
