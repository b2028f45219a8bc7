"""The robot's body seen from above: one shape for its plans, its guard and the simulated body."""

from __future__ import annotations

import math
from typing import Self

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from toponav.config_model import ConfigModel


class Footprint(ConfigModel):
    """A strip with half circles for its ends, the base in its middle; round where as long as wide.

    Against a rectangle it lacks the corners: where they are square, give the diagonal as length.
    """

    length_m: float = Field(default=0.36, gt=0.0)
    """From end to end, along the robot, metres."""

    width_m: float = Field(default=0.36, gt=0.0)
    """From side to side, metres; at most the length."""

    @model_validator(mode="after")
    def _is_no_wider_than_long(self) -> Self:
        if self.width_m > self.length_m:
            raise ValueError("a body wider than long: give its width as the length as well")
        return self

    @property
    def half_width_m(self) -> float:
        """From the base to either side: what a lane ahead must be wide."""
        return 0.5 * self.width_m

    @property
    def turning_radius_m(self) -> float:
        """Of the circle that the body needs to turn in place."""
        return 0.5 * self.length_m

    @property
    def end_m(self) -> float:
        """From the base to the middle of the half circle at either end; 0 for a round body."""
        return self.turning_radius_m - self.half_width_m

    def grown(self, margin_m: float) -> Footprint:
        """The same with so much more room around it."""
        more = 2.0 * margin_m
        return Footprint(length_m=self.length_m + more, width_m=self.width_m + more)

    def circles(self) -> NDArray[np.float64]:
        """(N,) places along the robot of circles, as wide as it, that together cover it."""
        if self.end_m == 0.0:
            return np.zeros(1)
        # Neighbours no farther apart than their radius leave 13 % of it uncovered at the sides.
        count = 2 + math.ceil(2.0 * self.end_m / self.half_width_m)
        return np.linspace(-self.end_m, self.end_m, count)

    def front_at(self, left: NDArray[np.float64]) -> NDArray[np.float64]:
        """(N,) how far the body reaches ahead of the base, so far (N,) to its left, metres."""
        return self.end_m + np.sqrt(np.maximum(0.0, self.half_width_m**2 - left**2))

    def half_angle_at(self, away: NDArray[np.float64]) -> NDArray[np.float64]:
        """(N,) radians to either side of straight ahead that the body covers so far (N,) out.

        A quarter of a circle within its sides, nothing beyond its ends.
        """
        end, half = self.end_m, self.half_width_m
        if end == 0.0:
            return np.where(away < half, 0.5 * math.pi, 0.0)
        away = np.maximum(away, 1e-9)
        beside = np.arcsin(np.minimum(1.0, half / away))
        at_end = np.arccos(np.clip((away**2 + end**2 - half**2) / (2.0 * away * end), -1.0, 1.0))
        return np.where(away * away <= end * end + half * half, beside, at_end)
