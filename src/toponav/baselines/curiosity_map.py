"""WMNav's curiosity value map: how much each cell of the floor is still worth seeing."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

CELL_M = 0.1
"""Edge of a cell, metres: that of the grid G."""

UNSEEN = 10.0
"""Value of a cell that no view has painted."""

PAINTED_M = 3.0
"""Floor within this distance of the camera is painted, metres."""


class CuriosityMap:
    """Values of cells of one floor, which views can only lower."""

    def __init__(self) -> None:
        """Every cell is worth the most."""
        self._values: dict[tuple[int, int], float] = {}

    def paint(
        self, floor_points: NDArray[np.float64], eye: NDArray[np.float64], score: float
    ) -> None:
        """Lower the value of the floor seen close by to a view's score.

        Args:
            floor_points: (N, 2) floor that the view shows, metres.
            eye: (2,) where it was taken from.
            score: What the view promises, 0 to `UNSEEN`.
        """
        near = np.hypot(*(floor_points - eye).T) <= PAINTED_M
        for cell in _cells(floor_points[near]):
            self._values[cell] = min(score, self._values.get(cell, UNSEEN))

    def mean(self, floor_points: NDArray[np.float64]) -> float:
        """Mean value of the cells under (N, 2) points, 0 without any."""
        values = [self._values.get(cell, UNSEEN) for cell in _cells(floor_points)]
        return float(np.mean(values)) if values else 0.0

    def at(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """(N,) value of the cell of each of (N, 2) points."""
        indices = np.floor(points / CELL_M).astype(np.int64)
        return np.array([self._values.get((int(i), int(j)), UNSEEN) for i, j in indices])


def _cells(points: NDArray[np.float64]) -> list[tuple[int, int]]:
    """The cells of (N, 2) points, each once, in order."""
    indices = np.unique(np.floor(points / CELL_M).astype(np.int64), axis=0)
    return [(int(i), int(j)) for i, j in indices]
