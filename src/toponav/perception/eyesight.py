"""What a simulated detector or model overlooks, by size and distance, and again and again."""

from __future__ import annotations

import math

from pydantic import Field, model_validator
from scipy.special import expit

from toponav.config_model import ConfigModel
from toponav.perception.draws import Draws, blended
from toponav.perception.sightings import Side


class Eyesight(ConfigModel):
    """How well things are found, and how much the misses of one thing have in common."""

    largest_recall: float = Field(default=0.92, ge=0.0, le=1.0)
    """Share found of the things that fill the image."""

    half_size: float = Field(default=0.05, gt=0.0)
    """Relative size at which half as many are: side of the mask as a square, over the image's."""

    size_slope: float = Field(default=1.6, gt=0.0)
    """How steeply recall grows with size: the logistic's slope a doubling."""

    half_range_m: float = Field(default=9.0, gt=0.0)
    """Range at which recall is halved once more, however large the thing, metres."""

    cut_recall: float = Field(default=0.9, ge=0.0, le=1.0)
    """Factor on recall where the image's border cuts a thing off."""

    object_share: float = Field(default=0.6, ge=0.0, le=1.0)
    """Share of the chance in missing a thing that all its views have in common."""

    side_share: float = Field(default=0.3, ge=0.0, le=1.0)
    """Share that the views from one side have in common; the rest is the single image's."""

    @model_validator(mode="after")
    def _check(self) -> Eyesight:
        if self.object_share + self.side_share > 1.0:
            raise ValueError("object_share + side_share must not exceed 1")
        return self

    def recall(self, relative_size: float, range_m: float, *, cut: bool = False) -> float:
        """Chance that a thing of such a size and range is found, from a side drawn at random."""
        doublings = math.log2(relative_size / self.half_size)
        recall = self.largest_recall * float(expit(self.size_slope * doublings))
        recall /= 1.0 + (range_m / self.half_range_m) ** 4
        return recall * (self.cut_recall if cut else 1.0)

    def happens(
        self, draws: Draws, thing: tuple[int, ...], side: Side, image: int, chance: float
    ) -> bool:
        """Whether a thing is found in an image in which its chance is this.

        Args:
            draws: Random draws of whose eyes these are.
            thing: Keys of the thing.
            side: From which it is seen.
            image: Key of the image.
            chance: In [0, 1].
        """
        luck = blended(
            (self.object_share, self.side_share, 1.0 - self.object_share - self.side_share),
            (
                draws.normal("thing", *thing),
                draws.normal("thing from a side", *thing, *side),
                draws.normal("thing in an image", *thing, image),
            ),
        )
        return bool(luck < chance)


FAULTLESS = Eyesight(largest_recall=1.0, half_size=1e-12, half_range_m=1e9, cut_recall=1.0)
"""Finds everything."""
