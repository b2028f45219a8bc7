"""Which floor the agent is on, from the height of its feet alone."""

from __future__ import annotations

import math
from collections import deque

import numpy as np
from numpy.typing import NDArray

SAME_FLOOR_M = 0.5
"""Feet this near to a floor's height stand on it: less than half the least storey."""

NEW_FLOOR_M = 1.2
"""A level stretch at least this far from every known floor is a new one."""

LEVEL_TRAVEL_M = 0.7
LEVEL_TOLERANCE_M = 0.06
"""A stretch is level when the feet rise less than this over that travel: no stairs do."""


class FloorTracker:
    """Floors with stable indices, in the order of discovery.

    On stairs the last floor stays current until the feet are near another known floor, or have
    walked a level stretch at a new height.
    """

    def __init__(self) -> None:
        """Start without floors; the first pose makes floor 0."""
        self.heights: list[float] = []
        self.current = 0
        self._stretch: deque[tuple[float, float, float]] = deque()

    def update(self, foot: NDArray[np.float64]) -> int:
        """Take the (3,) foot point of a frame, metres; returns the current floor's index."""
        x, y, z = (float(v) for v in foot)
        if not self.heights:
            self.heights.append(z)
        self._stretch.append((x, y, z))
        while abs(self._stretch[0][2] - z) > LEVEL_TOLERANCE_M:
            self._stretch.popleft()
        nearest = min(range(len(self.heights)), key=lambda k: abs(self.heights[k] - z))
        gap = abs(self.heights[nearest] - z)
        if gap <= SAME_FLOOR_M:
            self.current = nearest
        elif gap >= NEW_FLOOR_M and self._level_travel() >= LEVEL_TRAVEL_M:
            self.heights.append(z)
            self.current = len(self.heights) - 1
        return self.current

    def _level_travel(self) -> float:
        """Distance between the ends of the level stretch, metres."""
        return math.dist(self._stretch[0][:2], self._stretch[-1][:2])
