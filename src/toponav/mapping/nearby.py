"""Which objects are near places: the question that memory and search ask of every map."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from toponav.geometry.neighbourhoods import Neighbourhoods


class NearObject(NamedTuple):
    """A category near a place.

    Attributes:
        points: Map points of it that are nearer than the radius, one or more.
        distance_m: To the nearest of them in the plane, metres.
    """

    points: int
    distance_m: float


NearObjects = Mapping[str, NearObject]
"""What is near one place, by category."""


class ObjectSearch(Protocol):
    """Finds the objects near places."""

    def near(
        self, places: NDArray[np.floating], radius_m: float, heights_m: tuple[float, float]
    ) -> list[NearObjects]:
        """What is near each of some places.

        Args:
            places: (K, 2) world frame, metres.
            radius_m: Points strictly nearer than this, in the plane, count.
            heights_m: Lowest and highest z that counts, both included.

        Returns:
            K of them.
        """
        ...


def near_objects(
    objects: Mapping[str, NDArray[np.floating]],
    places: NDArray[np.floating],
    radius_m: float,
    heights_m: tuple[float, float],
) -> list[NearObjects]:
    """As `ObjectSearch.near`, among all of the (N, 3) points of each category."""
    found: list[dict[str, NearObject]] = [{} for _ in places]
    around = Neighbourhoods(places, radius_m)
    for category, points in objects.items():
        near = around.near(points, heights_m)
        for k in np.flatnonzero(near.counts):
            found[k][category] = NearObject(int(near.counts[k]), float(near.distances[k]))
    return list(found)
