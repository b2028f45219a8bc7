"""Where the floor was seen, square by square: elsewhere something low may stand unseen."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

SQUARE_M = 0.1
"""Side of a square, metres."""

OFFSET = 1 << 20
"""Squares are numbered from so many before the origin: 100 km."""


class SeenFloor:
    """A set of squares."""

    def __init__(self) -> None:
        """Nothing has been seen."""
        self._keys = np.zeros(0, np.int64)

    def add(self, xy: NDArray[np.float64]) -> None:
        """The floor was seen at (N, 2) positions, metres."""
        self._keys = np.union1d(self._keys, _keys(xy))

    def share(self, xy: NDArray[np.float64]) -> float:
        """Share of (N, 2) positions whose square has been seen."""
        return float(np.isin(_keys(xy), self._keys).mean())


def _keys(xy: NDArray[np.float64]) -> NDArray[np.int64]:
    square = np.floor(xy / SQUARE_M).astype(np.int64) + OFFSET
    keys: NDArray[np.int64] = square[:, 0] * (2 * OFFSET) + square[:, 1]
    return np.unique(keys) if len(keys) > 64 else keys
