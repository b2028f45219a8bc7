"""What the agent wants the base to do next, in the frame of its map."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Turn:
    """Turn in place by an angle (radians, counter-clockwise), then stand still."""

    angle: float


@dataclass(frozen=True, eq=False)
class Follow:
    """Drive along a way and stand still at its end.

    Attributes:
        way: (K, 2) positions, world frame, metres; at least one.
    """

    way: NDArray[np.float64]


Intent = Turn | Follow
