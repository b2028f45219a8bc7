"""How much what is seen speaks for the target: the stand-in for a language or image-text model."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from toponav.reasoning.base import Reasoner
from toponav.types import Detections


class Relevance:
    """Asks the reasoner about one target, once for each name."""

    def __init__(self, reasoner: Reasoner, target: str) -> None:
        """Start without answers."""
        self._reasoner = reasoner
        self._target = target
        self._of_object: dict[str, float] = {}
        self._of_room: dict[str, float] = {}

    def of_objects(self, names: Sequence[str]) -> NDArray[np.float64]:
        """obj(g, o): (N,) in [0, 1] for N category names.

        Raises:
            ReasonerError: No valid answer could be had.
        """
        new = [name for name in dict.fromkeys(names) if name not in self._of_object]
        if new:
            answer = self._reasoner.object_affinity(self._target, new)
            self._of_object.update(zip(new, answer.tolist(), strict=True))
        return np.array([self._of_object[name] for name in names], dtype=np.float64)

    def of_rooms(self, names: Sequence[str]) -> NDArray[np.float64]:
        """room(g, r): (N,) in [0, 1] for N types of room.

        Raises:
            ReasonerError: No valid answer could be had.
        """
        new = [name for name in dict.fromkeys(names) if name not in self._of_room]
        if new:
            answer = self._reasoner.room_affinity(self._target, new)
            self._of_room.update(zip(new, answer.tolist(), strict=True))
        return np.array([self._of_room[name] for name in names], dtype=np.float64)

    def of_image(self, detections: Detections) -> float:
        """itm(image, g): the best of obj(g, o) times score over the detections, 0 without any."""
        if not len(detections):
            return 0.0
        return float((self.of_objects(detections.labels) * detections.scores).max())
