"""Walks that somebody else plans: a guide that knows the scene, for comparison only.

Papers whose agents follow paths on the simulator's navmesh are compared on equal terms by
`--follower oracle`; a run that does so is named in every table.
"""

from __future__ import annotations

from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from toponav.types import Action


class Guide(Protocol):
    """Knows the way."""

    def turns(self, goals: NDArray[np.float64]) -> int | None:
        """How often to turn left (right where negative) before the next step to the goals.

        Args:
            goals: (N, 2) places, metres; the nearest that can be reached counts.

        Returns:
            None when no step leads nearer.
        """
        ...


@runtime_checkable
class Guidable(Protocol):
    """An agent whose walks a guide can plan."""

    def follow(self, guide: Guide) -> None:
        """Walk as the guide says, from the next episode on."""
        ...


def guided_action(guide: Guide, goals: NDArray[np.float64]) -> Action | None:
    """The next turn or step; None when no step leads nearer."""
    turns = guide.turns(goals)
    if turns is None:
        return None
    if turns == 0:
        return Action.MOVE_FORWARD
    return Action.TURN_LEFT if turns > 0 else Action.TURN_RIGHT
