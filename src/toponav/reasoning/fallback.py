"""A reasoner that always answers: another one stands in where the first fails."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from toponav.errors import ReasonerError
from toponav.reasoning.base import Query, Reasoner
from toponav.reasoning.schema import Guidance


class FallbackReasoner:
    """Asks the first reasoner, and the stand-in when it fails; never a random choice."""

    def __init__(self, first: Reasoner, stand_in: Reasoner) -> None:
        """`stand_in` never fails."""
        self._first = first
        self._stand_in = stand_in

    def decide(self, query: Query) -> Guidance:
        """The first reasoner's guidance; the reason says so where it is the stand-in's."""
        try:
            return self._first.decide(query)
        except ReasonerError as error:
            guidance = self._stand_in.decide(query)
            reason = f"(stand-in, since {error}) {guidance.reason}"
            return guidance.model_copy(update={"reason": reason})

    def room_affinity(self, target: str, rooms: Sequence[str]) -> NDArray[np.float64]:
        """The first reasoner's, or the stand-in's."""
        try:
            return self._first.room_affinity(target, rooms)
        except ReasonerError:
            return self._stand_in.room_affinity(target, rooms)

    def object_affinity(self, target: str, objects: Sequence[str]) -> NDArray[np.float64]:
        """The first reasoner's, or the stand-in's."""
        try:
            return self._first.object_affinity(target, objects)
        except ReasonerError:
            return self._stand_in.object_affinity(target, objects)
