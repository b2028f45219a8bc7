"""The colours and materials that one piece of furniture is made in."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeVar

import numpy as np

from toponav.scenes.textures import Rgb, Surface, brushed_metal, fabric, paint, wood

_Item = TypeVar("_Item")

WOODS: tuple[Rgb, ...] = ((150, 100, 58), (186, 142, 92), (104, 66, 40), (206, 178, 136))
FABRICS: tuple[Rgb, ...] = (
    (58, 96, 138),
    (150, 62, 58),
    (92, 118, 84),
    (120, 112, 104),
    (176, 138, 84),
    (84, 78, 110),
    (60, 124, 124),
    (188, 176, 156),
)
CERAMIC = paint((240, 241, 240))
DARK = paint((30, 31, 34))
BLACK_STEEL = paint((58, 60, 64))
WHITE_ENAMEL = paint((228, 230, 230))
CHROME = brushed_metal((190, 194, 198))
STEEL = brushed_metal((166, 170, 174))


class Style:
    """Seeded choices: equal variants give equal pieces."""

    def __init__(self, variant: int) -> None:
        """Start the choices of a variant, any integer."""
        self.rng = np.random.default_rng(abs(variant))
        self.texture_seed = abs(variant) % 3

    def pick(self, options: Sequence[_Item]) -> _Item:
        """One of the options."""
        return options[int(self.rng.integers(len(options)))]

    def chance(self, probability: float) -> bool:
        """Whether something of that probability happens."""
        return bool(self.rng.random() < probability)

    def wood(self) -> Surface:
        """A veneer."""
        return wood(self.pick(WOODS), self.texture_seed)

    def fabric(self) -> Surface:
        """An upholstery."""
        return fabric(self.pick(FABRICS), self.texture_seed)

    def front(self) -> Surface:
        """A cupboard's front: veneer or lacquer."""
        if self.chance(0.4):
            return paint(self.pick(((226, 222, 212), (196, 204, 206), (120, 134, 128))))
        return self.wood()
