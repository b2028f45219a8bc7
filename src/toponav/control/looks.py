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

    def nearest_m(
        self, places: NDArray[np.float64], view: MapView, within_m: float
    ) -> NDArray[np.float64]:
        """From how near places on the floor were in sight.

        Args:
            places: (N, 2) world frame, metres.
            view: The map, whose obstacles hide places.
            within_m: Looks from farther off do not matter.

        Returns:
            (N,) metres; infinity where no look from within that distance showed the place.
        """
        nearest = np.full(len(places), np.inf)
        x, y, z, yaw = np.array(self._looks).reshape(-1, 4).T
        east, north = places[:, :1] - x, places[:, 1:] - y
        away = np.hypot(east, north)
        place, look = np.nonzero((away <= within_m) & (np.abs(z - view.floor_z) <= SAME_STOREY_M))
        aside = np.arctan2(north[place, look], east[place, look]) - yaw[look]
        shown = np.abs((aside + np.pi) % math.tau - np.pi) <= HALF_VIEW_RAD
        place, look = place[shown], look[shown]
        if not len(place):
            return nearest
        obstacles = view.grid.cells == OCCUPIED
        for k in np.unique(place):
            looks = look[place == k]
            eyes = np.stack([x[looks], y[looks]], axis=-1)
            hidden = lines_through(obstacles, places[k], eyes, view.grid)
            nearest[k] = away[k, looks][~hidden].min(initial=math.inf)
        return nearest
