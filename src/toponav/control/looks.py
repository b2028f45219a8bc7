"""Where the camera has looked: what was in view from nearby and stayed unknown promises little."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from toponav.geometry import Pose
from toponav.mapping.sight_lines import lines_through
from toponav.mapping.view import OCCUPIED, MapView

HALF_VIEW_RAD = math.radians(30.0)
"""What is this far off the camera's axis has been looked at: within any camera's view."""

SAME_STOREY_M = 1.0
"""Looks from farther above or below the floor were on another storey."""


class Looks:
    """All looks of a search."""

    def __init__(self) -> None:
        """Start without any."""
        self._looks: list[tuple[float, float, float, float]] = []

    def add(self, world_from_base: Pose) -> None:
        """Note where the agent stands and to where it looks."""
        x, y, z = world_from_base.translation.tolist()
        self._looks.append((x, y, z, world_from_base.yaw))

    def nearest_m(self, place: NDArray[np.float64], view: MapView, within_m: float) -> float:
        """From how near a place on the floor was in sight, metres.

        Args:
            place: (2,) world frame, metres.
            view: The map, whose obstacles hide the place.
            within_m: Looks from farther off do not matter.

        Returns:
            Infinity where no look from within that distance showed the place.
        """
        x, y, z, yaw = np.array(self._looks).reshape(-1, 4).T
        away = np.hypot(place[0] - x, place[1] - y)
        aside = np.arctan2(place[1] - y, place[0] - x) - yaw
        shown = np.abs((aside + np.pi) % math.tau - np.pi) <= HALF_VIEW_RAD
        shown &= (away <= within_m) & (np.abs(z - view.floor_z) <= SAME_STOREY_M)
        if not shown.any():
            return math.inf
        eyes = np.stack([x, y], axis=-1)[shown]
        hidden = lines_through(view.grid.cells == OCCUPIED, place, eyes, view.grid)
        return float(away[shown][~hidden].min(initial=math.inf))
