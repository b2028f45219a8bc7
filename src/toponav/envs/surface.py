"""The part of an environment that says where an agent can be: what every backend's surface can do.

Points are (3,) foot points in the world frame, metres, z up.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray


@dataclass(frozen=True, eq=False)
class Motion:
    """The outcome of a forward move.

    Attributes:
        position: (3,) where the agent ended.
        collided: Whether an obstacle cut the move short.
    """

    position: NDArray[np.float64]
    collided: bool


class Distances(Protocol):
    """Geodesic distances from anywhere to the nearest of some goals."""

    def at(self, point: ArrayLike) -> float:
        """Metres from a (3,) point to the nearest goal; infinite without a path."""
        ...


class Surface(Protocol):
    """All places where a body can stand in a scene."""

    @property
    def area(self) -> float:
        """Of the main island, m2."""
        ...

    def is_navigable(self, point: ArrayLike) -> bool:
        """Whether the agent's foot can be at a (3,) point."""
        ...

    def points_over(self, xy: NDArray[np.float64]) -> NDArray[np.float64]:
        """(M, 3) points of the main island over (N, 2) places, each on every storey it has."""
        ...

    def snap(self, point: ArrayLike, max_distance: float = ...) -> NDArray[np.float64] | None:
        """The nearest point of the surface, (3,), within some metres; None without one."""
        ...

    def move(self, position: ArrayLike, yaw: float, distance: float) -> Motion:
        """Walk straight ahead without sliding: a blocked move ends where it touches."""
        ...

    def distance_field(self, goals: ArrayLike) -> Distances:
        """Distances to the nearest of (N, 3) goals."""
        ...

    def geodesic_distance(self, start: ArrayLike, goal: ArrayLike) -> float:
        """Length of the shortest path between two (3,) points; infinite without one."""
        ...

    def shortest_path(self, start: ArrayLike, goal: ArrayLike) -> NDArray[np.float64]:
        """(K, 3) corners of the shortest path between two (3,) points; empty without one."""
        ...

    def random_point(
        self, rng: np.random.Generator, floor_z: float | None = None
    ) -> NDArray[np.float64]:
        """A (3,) point of the main island, on one floor if its height is given."""
        ...
