"""The floor that one image shows."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from toponav.mapping.view import MapView
from toponav.types import Observation

FLOOR_BAND_M = 0.15
"""Pixels this near to the height of the floor show floor, metres."""

COLUMN_STRIDE = 4
"""Every how many columns of an image the floor is looked for; rows are farther apart on it."""


def seen_floor(observation: Observation, view: MapView) -> NDArray[np.float64]:
    """(M, 2) where an image shows the current floor, world frame, metres."""
    camera, depth = observation.intrinsics, observation.depth[:, ::COLUMN_STRIDE]
    v, u = np.nonzero(depth)
    in_camera = camera.ray(u * COLUMN_STRIDE, v) * depth[v, u, None].astype(np.float64)
    world = observation.world_from_camera.apply(in_camera)
    return world[np.abs(world[:, 2] - view.floor_z) <= FLOOR_BAND_M, :2]
