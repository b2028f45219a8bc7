"""Where what was searched for is."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from toponav.categories import canonical
from toponav.mapping.view import MapView

ABOUT_M = 0.6
"""Points of the target this near to its nearest point belong to the same object, metres."""


def found_position(
    view: MapView, goal: str, robot: NDArray[np.float64]
) -> NDArray[np.float64] | None:
    """(3,) middle of the instance nearest to a (3,) position, metres; None where none is mapped."""
    cloud = view.objects.get(canonical(goal))
    if cloud is None or not len(cloud):
        return None
    points = cloud.points.astype(np.float64)
    nearest = points[np.argmin(np.linalg.norm(points - robot, axis=1))]
    own = points[np.linalg.norm(points - nearest, axis=1) <= ABOUT_M]
    middle: NDArray[np.float64] = own.mean(axis=0)
    return middle
