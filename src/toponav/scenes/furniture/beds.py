"""Beds: a frame, a mattress, a blanket, pillows and a headboard."""

from __future__ import annotations

from toponav.scenes.furniture.primitives import Part, box, rounded_box
from toponav.scenes.furniture.shape import Size
from toponav.scenes.furniture.style import Style
from toponav.scenes.textures import fabric

DOUBLE_WIDTH_M = 1.25
"""A wider bed has two pillows."""

LINEN = fabric((240, 240, 236))

BLANKETS = ((58, 96, 138), (150, 62, 58), (92, 118, 84), (84, 78, 110), (60, 124, 124))
"""None is like wood or linen, so that a bed stands out from its frame."""


def bed(size: Size, style: Style) -> list[Part]:
    """A made bed; its head is at the back."""
    sx, sy, sz = size
    frame, blanket = style.wood(), fabric(style.pick(BLANKETS), style.texture_seed)
    x, y = sx / 2.0, sy / 2.0
    top = min(0.52, 0.62 * sz)
    rail, slab = 0.55 * top, 0.06
    parts = [
        box((-x, y - slab, 0.0), (x, y, sz), frame),
        box((-x, -y, 0.12 * top), (x, y - slab, rail), frame),
        rounded_box((-x + 0.02, -y + 0.03, rail), (x - 0.02, y - slab, top), 0.05, LINEN),
    ]
    for foot_x in (-x + 0.06, x - 0.06):
        parts.append(box((foot_x - 0.04, -y + 0.02, 0.0), (foot_x + 0.04, -y + 0.1, rail), frame))
    fold = y - 0.34 * sy
    drape = 0.75 * rail
    parts += [
        rounded_box((-x - 0.005, -y, drape), (x + 0.005, fold, top + 0.035), 0.04, blanket),
        rounded_box(
            (-x - 0.01, fold - 0.1, drape), (x + 0.01, fold + 0.1, top + 0.045), 0.04, LINEN
        ),
    ]
    count = 2 if sx > DOUBLE_WIDTH_M else 1
    width = min(0.68, (sx - 0.16) / count)
    depth = min(0.42, 0.22 * sy)
    for index in range(count):
        middle = (index - (count - 1) / 2.0) * sx / 2.0
        back = y - slab - 0.03
        low = (middle - width / 2.0, back - depth, top - 0.01)
        high = (middle + width / 2.0, back, top + 0.15)
        parts.append(rounded_box(low, high, 0.06, LINEN).turned("x", 14.0, (0.0, back, top)))
    return parts
