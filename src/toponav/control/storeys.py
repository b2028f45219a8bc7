"""What the other storeys of a building promise: those not seen yet, and those that were left."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from toponav.mapping.view import MapView

UPSTAIRS, DOWNSTAIRS = ("bed", "bathtub"), ("sofa", "oven", "table")
"""In a home of several storeys, these tend to stand on the upper ones and on the lowest."""

LEAST_PROMISE = 0.01
"""Of a storey of which nothing is left to see: something may have been missed."""


@dataclass
class _Storey:
    """A floor: its height, metres, and what the frontiers on it promised when it was last seen."""

    z: float
    left: float


class Storeys:
    """The floors that the agent has been on, and what a way up or down is worth.

    A floor that was never seen promises as much as a floor does, more or less by whether the
    target goes with what stands upstairs or downstairs; one that was left, what was left there.
    """

    def __init__(self) -> None:
        """Know of none."""
        self._known: dict[int, _Storey] = {}

    def note(self, view: MapView, left: float) -> None:
        """Remember what the frontiers on the agent's floor promise.

        Args:
            view: The map.
            left: The sum of their promises.
        """
        self._known[view.floor] = _Storey(view.floor_z, left)

    def promise(
        self, *, up: bool, view: MapView, unseen: float, affinity: Mapping[str, float]
    ) -> float:
        """What the next storey up or down promises.

        Args:
            up: Which way.
            view: The map on the agent's floor.
            unseen: What a storey promises of which nothing is known.
            affinity: By category, how well the target goes with such an object, in [0, 1].
        """
        there = [s for s in self._known.values() if (s.z > view.floor_z) is up]
        there = [s for s in there if s.z != view.floor_z]
        if there:
            nearest = min(there, key=lambda storey: abs(storey.z - view.floor_z))
            return max(LEAST_PROMISE, min(nearest.left, unseen))
        upstairs = share_upstairs(affinity)
        return unseen * 2.0 * (upstairs if up else 1.0 - upstairs)


def share_upstairs(affinity: Mapping[str, float]) -> float:
    """How likely the target is upstairs rather than downstairs, in [0, 1]; 0.5 if nothing tells.

    Args:
        affinity: By category, how well the target goes with such an object; the target itself
            with 1.
    """
    above = max(affinity.get(name, 0.0) for name in UPSTAIRS)
    below = max(affinity.get(name, 0.0) for name in DOWNSTAIRS)
    return above / (above + below) if above + below else 0.5
