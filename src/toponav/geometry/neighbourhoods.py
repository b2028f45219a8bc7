"""Which of many points are near some places: one pass over the points, few of which are near any.

A tree over the points would cost more to build than so few places can make good, and the points of
a large building are mostly near none of them.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray


class Near(NamedTuple):
    """What lies near each of K places.

    Attributes:
        counts: (K,) int64 points nearer than the radius.
        distances: (K,) float64 distance to the nearest of them, metres; infinite without any.
    """

    counts: NDArray[np.int64]
    distances: NDArray[np.float64]


class _Bins(NamedTuple):
    """Squares as wide as the radius, each with the places that a point in it may be near to.

    Attributes:
        corner: (2,) lower corner of the first square.
        starts: (B_x, B_y) where a square's places start in `places`; a square has `sizes` of them.
        sizes: (B_x, B_y).
        places: Indices of places.
    """

    corner: NDArray[np.float64]
    starts: NDArray[np.int64]
    sizes: NDArray[np.int64]
    places: NDArray[np.int64]


class Neighbourhoods:
    """Discs of one radius around places in the plane."""

    def __init__(self, centers: NDArray[np.floating], radius: float) -> None:
        """Take the (K, 2) centres and the radius in metres."""
        self._centers = np.ascontiguousarray(centers, dtype=np.float64).reshape(-1, 2)
        self._radius = radius
        self._bins = _binned(self._centers, radius)

    def near(
        self, points: NDArray[np.floating], heights: tuple[float, float] = (-np.inf, np.inf)
    ) -> Near:
        """Count the points near each place, and find the nearest.

        Args:
            points: (N, 3) of which those strictly nearer than the radius, in the plane, count.
            heights: Lowest and highest z that counts, both included.
        """
        counts, squared = _look(points, heights, self._centers, self._radius, self._bins)
        return Near(counts, np.sqrt(squared))


def _binned(centers: NDArray[np.float64], radius: float) -> _Bins:
    if not len(centers):
        none = np.zeros((0, 0), np.int64)
        return _Bins(np.zeros(2), none, none, none.ravel())
    corner = centers.min(axis=0) - 1.5 * radius
    square = np.floor((centers - corner) / radius).astype(np.int64)
    shape = square.max(axis=0) + 2
    around = np.stack(np.meshgrid([-1, 0, 1], [-1, 0, 1], indexing="ij"), axis=-1).reshape(9, 1, 2)
    reached = np.ravel_multi_index(np.moveaxis(square + around, -1, 0), shape)  # (9, K)
    order = np.argsort(reached.ravel(), kind="stable")
    sizes = np.bincount(reached.ravel(), minlength=int(shape.prod()))
    starts = np.cumsum(sizes) - sizes
    return _Bins(corner, starts.reshape(shape), sizes.reshape(shape), order % len(centers))


@njit(cache=True, error_model="numpy")
def _look(
    points: NDArray[np.floating],
    heights: tuple[float, float],
    centers: NDArray[np.float64],
    radius: float,
    bins: _Bins,
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """(K,) counts of points near places, and squared distances to the nearest.

    First by entry of the squares' lists, without branches that nobody can foresee.
    """
    corner, starts, sizes, places = bins
    low, high = heights
    per_m, limit = 1.0 / radius, radius * radius
    around, found = centers[places], np.zeros(places.size, np.int64)
    nearest = np.full(places.size, np.inf)
    for row in range(points.shape[0]):
        z = float(points[row, 2])
        if z < low or z > high:
            continue
        x, y = float(points[row, 0]), float(points[row, 1])
        i, j = int(np.floor((x - corner[0]) * per_m)), int(np.floor((y - corner[1]) * per_m))
        if i < 0 or j < 0 or i >= sizes.shape[0] or j >= sizes.shape[1]:
            continue
        for k in range(starts[i, j], starts[i, j] + sizes[i, j]):
            dx, dy = x - around[k, 0], y - around[k, 1]
            distance = dx * dx + dy * dy
            found[k] += int(distance < limit)
            nearest[k] = min(nearest[k], distance)
    counts, squared = np.zeros(len(centers), np.int64), np.full(len(centers), np.inf)
    for k in range(places.size):
        counts[places[k]] += found[k]
        if nearest[k] < limit:
            squared[places[k]] = min(squared[places[k]], nearest[k])
    return counts, squared
