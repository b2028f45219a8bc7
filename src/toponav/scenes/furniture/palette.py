"""Colours of furniture, by seed."""

from __future__ import annotations

from toponav.scenes.mesh import Material
from toponav.scenes.textures import WOODS, Color, plain, planks

FABRICS: tuple[Color, ...] = (
    (92, 110, 136), (140, 86, 80), (98, 118, 92), (150, 134, 110), (88, 88, 96), (168, 140, 74),
)  # fmt: skip
LINENS: tuple[Color, ...] = ((96, 124, 160), (168, 104, 100), (118, 140, 108), (190, 176, 150))

WHITE = plain("white enamel", (238, 240, 240), 1.5)
CREAM = plain("cream", (232, 224, 206), 2.0)
STEEL = plain("steel", (176, 182, 188), 3.0)
DARK = plain("dark metal", (52, 54, 60), 2.0)
BLACK = plain("black plastic", (24, 24, 28), 1.0)
SCREEN = plain("screen", (44, 62, 92), 2.0)
GLASS = plain("glass", (150, 180, 196), 2.0)
LEAF = plain("leaf", (58, 122, 54), 12.0)
LEAF_DARK = plain("dark leaf", (40, 94, 44), 12.0)
CLAY = plain("clay", (176, 96, 64), 4.0)
SOIL = plain("soil", (72, 52, 38), 6.0)
WATER = plain("water", (140, 176, 196), 2.0)
FIRE = plain("embers", (226, 120, 44), 14.0)
STONE = plain("stone", (140, 136, 130), 8.0)
BRASS = plain("brass", (190, 150, 80), 4.0)
SHADE = plain("lampshade", (244, 226, 178), 3.0)
PAPER = plain("paper", (244, 242, 234), 2.0)
RUBBER = plain("rubber", (36, 36, 38), 3.0)


def wood(variant: int) -> Material:
    """One of the woods."""
    k = variant % len(WOODS)
    return planks(f"furniture wood {k}", WOODS[k])


def fabric(variant: int) -> Material:
    """One of the upholstery fabrics."""
    k = variant % len(FABRICS)
    return plain(f"fabric {k}", FABRICS[k], 7.0)


def linen(variant: int) -> Material:
    """One of the bed linens."""
    k = variant % len(LINENS)
    return plain(f"linen {k}", LINENS[k], 6.0)
