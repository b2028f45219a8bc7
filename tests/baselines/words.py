"""A reasoner that knows what a test tells it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from toponav.reasoning.base import Query
from toponav.reasoning.schema import Guidance


@dataclass
class Words:
    """Affinities by name, 0.1 for other names; remembers what it was asked."""

    affinity: dict[str, float]
    asked: list[str] = field(default_factory=list)

    def decide(self, query: Query) -> Guidance:
        raise AssertionError("only affinities are asked")

    def room_affinity(self, target: str, rooms: Sequence[str]) -> NDArray[np.float64]:
        return self.object_affinity(target, rooms)

    def object_affinity(self, target: str, objects: Sequence[str]) -> NDArray[np.float64]:
        self.asked.extend(objects)
        return np.array([1.0 if n == target else self.affinity.get(n, 0.1) for n in objects])
