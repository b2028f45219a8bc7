"""VLFM's value map: what images said of each place, weighted by how well they showed it."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from toponav.types import Observation

CELL_M = 0.1
"""Edge of a cell, metres: that of the grid G."""

LEAST_CONFIDENCE = 0.25
"""Confidence at the edge of the image; at its middle it is 1."""

IGNORED_CONFIDENCE = 0.35
"""Where a cell is known better, a look of less confidence than this changes nothing."""

GROWTH_CELLS = 64
"""Margin by which the storage outgrows its contents, so that it is seldom copied."""


class ValueMap:
    """Value and confidence of the cells of one floor; cell (i, j) covers x in [i, i + 1) cells."""

    def __init__(self, max_range_m: float) -> None:
        """Create an empty map; images say nothing of what is farther than the range, metres."""
        self._max_range_m = max_range_m
        self._first = np.zeros(2, np.int64)
        self._value = np.zeros((0, 0))
        self._confidence = np.zeros((0, 0))

    def add(self, observation: Observation, value: float) -> None:
        """Fuse the value of one image into the cells that it shows; the camera is level."""
        cells, confidence = visible_cone(observation, self._max_range_m)
        if not len(cells):
            return
        self._cover(cells.min(axis=0), cells.max(axis=0))
        at = tuple((cells - self._first).T)
        self._value[at], self._confidence[at] = fused(
            self._value[at], self._confidence[at], value, confidence
        )

    def median_within(self, xy: ArrayLike, radius_m: float) -> float:
        """Median value of the cells seen within a circle round a (2,) position; 0 without any."""
        centre = np.asarray(xy, dtype=np.float64)
        low = np.floor((centre - radius_m) / CELL_M).astype(np.int64) - self._first
        high = np.floor((centre + radius_m) / CELL_M).astype(np.int64) - self._first + 1
        low, high = np.maximum(low, 0), np.maximum(high, 0)
        window = (slice(low[0], high[0]), slice(low[1], high[1]))
        seen = np.argwhere(self._confidence[window] > 0.0)
        offset = (seen + low + self._first + 0.5) * CELL_M - centre
        values = self._value[window][tuple(seen[np.hypot(*offset.T) <= radius_m].T)]
        return float(np.median(values)) if len(values) else 0.0

    def _cover(self, low: NDArray[np.int64], high: NDArray[np.int64]) -> None:
        """Make room for the cells from `low` to `high`, both included."""
        end = self._first + self._value.shape
        if self._value.size and (low >= self._first).all() and (high < end).all():
            return
        first, last = low - GROWTH_CELLS, high + 1 + GROWTH_CELLS
        if self._value.size:
            first, last = np.minimum(first, self._first), np.maximum(last, end)
            padding = tuple(zip(self._first - first, last - end, strict=True))
            self._value = np.pad(self._value, padding)
            self._confidence = np.pad(self._confidence, padding)
        else:
            self._value, self._confidence = np.zeros(last - first), np.zeros(last - first)
        self._first = first


def fused(
    old_value: NDArray[np.float64],
    old_confidence: NDArray[np.float64],
    value: float,
    confidence: NDArray[np.float64],
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """(N,) values and confidences of N cells after an image of some value showed them.

    V = (w v + W V) / (w + W) and W = (w^2 + W^2) / (w + W), but a doubtful look does not change
    what is known better.
    """
    kept = (confidence < IGNORED_CONFIDENCE) & (confidence < old_confidence)
    total = confidence + old_confidence
    new_value = (confidence * value + old_confidence * old_value) / total
    new_confidence = (confidence**2 + old_confidence**2) / total
    return np.where(kept, old_value, new_value), np.where(kept, old_confidence, new_confidence)


def visible_cone(
    observation: Observation, max_range_m: float
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """The cells that an image of a level camera shows, and how well.

    A cell is shown if it is no farther than the deepest pixel of its column of the image.

    Args:
        observation: The image.
        max_range_m: Cells farther than this are not shown, metres.

    Returns:
        (N, 2) cell indices, and (N,) their confidence in (0, 1].
    """
    base, camera = observation.world_from_base, observation.intrinsics
    here = base.translation[:2]
    low, high = (np.floor((here + side) / CELL_M) for side in (-max_range_m, max_range_m))
    cells = np.stack(
        np.meshgrid(*(np.arange(a, b + 1) for a, b in zip(low, high, strict=True)), indexing="ij"),
        axis=-1,
    ).reshape(-1, 2)
    x, y = ((cells + 0.5) * CELL_M - here).T
    forward = x * math.cos(base.yaw) + y * math.sin(base.yaw)
    right = x * math.sin(base.yaw) - y * math.cos(base.yaw)
    ahead = np.flatnonzero((forward > 0.0) & (np.hypot(x, y) <= max_range_m))
    column = np.rint(camera.cx + camera.fx * right[ahead] / forward[ahead]).astype(np.int64)
    inside = (column >= 0) & (column < camera.width)
    ahead, column = ahead[inside], column[inside]
    shown = forward[ahead] <= observation.depth.max(axis=0)[column]
    ahead = ahead[shown]
    angle = np.arctan2(right[ahead], forward[ahead])
    return cells[ahead].astype(np.int64), cone_confidence(angle, camera.hfov)


def cone_confidence(angle: NDArray[np.float64], hfov: float) -> NDArray[np.float64]:
    """(N,) confidence at (N,) angles from the optical axis: cos^2, 0 at the edge, then rescaled."""
    off_axis = np.clip(np.abs(angle) / (0.5 * hfov), 0.0, 1.0)
    cos_squared = np.cos(off_axis * 0.5 * math.pi) ** 2
    return np.asarray(LEAST_CONFIDENCE + (1.0 - LEAST_CONFIDENCE) * cos_squared)
