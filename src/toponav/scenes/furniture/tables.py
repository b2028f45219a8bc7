"""Tables, desks and workbenches."""

from __future__ import annotations

from toponav.scenes.furniture.primitives import Part, box, cylinder, lathe, tube
from toponav.scenes.furniture.shape import Size
from toponav.scenes.furniture.style import BLACK_STEEL, CHROME, STEEL, Style
from toponav.scenes.textures import Surface, paint

ROUND_ASPECT = 1.15
"""A table whose sides differ by less may be round."""


def table(size: Size, style: Style) -> list[Part]:
    """Four legs and a top, or a round top on a pedestal."""
    sx, sy, sz = size
    surface = style.wood()
    if max(sx, sy) < ROUND_ASPECT * min(sx, sy) and style.chance(0.5):
        return _pedestal_table(size, surface)
    leg = min(0.07, 0.12 * min(sx, sy))
    x, y, apron = sx / 2.0, sy / 2.0, min(0.1, 0.2 * sz)
    return [
        box((-x, -y, sz - 0.035), (x, y, sz), surface),
        *_legs(size, leg, 0.03, sz - 0.035, surface),
        box((-x + 0.05, -y + 0.05, sz - apron), (x - 0.05, y - 0.05, sz - 0.035), surface),
    ]


def _pedestal_table(size: Size, surface: Surface) -> list[Part]:
    sx, sy, sz = size
    half = (sx / 2.0, sy / 2.0)
    top = [(0.0, sz - 0.035), (1.0, sz - 0.035), (1.0, sz), (0.0, sz)]
    foot = [(0.0, 0.0), (0.5, 0.0), (0.5, 0.03), (0.12, 0.08), (0.09, 0.5 * sz), (0.2, sz - 0.035)]
    return [
        lathe(top, surface, stretch=half, segments=24),
        lathe(foot, surface, stretch=half),
    ]


def _legs(size: Size, width: float, inset: float, height: float, surface: Surface) -> list[Part]:
    """Four square legs."""
    x, y = size[0] / 2.0 - inset, size[1] / 2.0 - inset
    return [
        box((min(a, a - s * width), min(b, b - t * width), 0.0),
            (max(a, a - s * width), max(b, b - t * width), height), surface)
        for s, a in ((-1, -x), (1, x))
        for t, b in ((-1, -y), (1, y))
    ]  # fmt: skip


def coffee_table(size: Size, style: Style) -> list[Part]:
    """A low table with a shelf, or a glass top on steel."""
    sx, sy, sz = size
    x, y = sx / 2.0, sy / 2.0
    surface = style.wood()
    if style.chance(0.35):
        top, frame = paint((168, 196, 200)), CHROME
    else:
        top, frame = surface, surface
    return [
        box((-x, -y, sz - 0.04), (x, y, sz), top),
        *_legs(size, 0.05, 0.02, sz - 0.04, frame),
        box((-x + 0.04, -y + 0.04, 0.3 * sz), (x - 0.04, y - 0.04, 0.3 * sz + 0.025), surface),
    ]


def desk(size: Size, style: Style) -> list[Part]:
    """A top on a drawer unit and a side panel, with a modesty panel at the back."""
    sx, sy, sz = size
    x, y, top = sx / 2.0, sy / 2.0, sz - 0.035
    surface, front = style.wood(), style.front()
    unit = min(0.42, 0.35 * sx)
    parts = [
        box((-x, -y, top), (x, y, sz), surface),
        box((-x + 0.01, -y + 0.02, 0.0), (-x + 0.05, y - 0.01, top), surface),
        box((-x + 0.05, y - 0.05, 0.45 * sz), (x - unit, y - 0.03, top), surface),
        box((x - unit, -y + 0.03, 0.0), (x - 0.01, y - 0.01, top), surface),
    ]
    for index in range(3):
        low, high = (0.05 + (top - 0.06) * (index + part) / 3.0 for part in (0.0, 1.0))
        parts.append(
            box((x - unit + 0.01, -y + 0.015, low + 0.01), (x - 0.02, -y + 0.03, high), front)
        )
        middle, rise = x - unit / 2.0, (low + high) / 2.0
        parts.append(
            box((middle - 0.06, -y, rise), (middle + 0.06, -y + 0.015, rise + 0.015), BLACK_STEEL)
        )
    return parts


def workbench(size: Size, style: Style) -> list[Part]:
    """A thick top on a steel frame with a shelf, a vice, and a tool board when it is high."""
    sx, sy, sz = size
    x, y = sx / 2.0, sy / 2.0
    top = min(sz, 0.9) if sz > 1.15 else sz - 0.1
    surface = style.wood()
    parts = [
        box((-x, -y, top - 0.06), (x, y, top), surface),
        *_legs(size, 0.06, 0.02, top - 0.06, BLACK_STEEL),
        box((-x + 0.03, -y + 0.05, 0.2), (x - 0.03, y - 0.03, 0.23), surface),
        box((-0.5 * x, -0.1, 0.23), (-0.1 * x, 0.12, 0.23 + 0.25 * top), paint((176, 52, 44))),
        box((0.55 * x, -y, top), (0.55 * x + 0.14, -y + 0.06, top + 0.1), STEEL),
        box((0.55 * x, -y + 0.1, top), (0.55 * x + 0.14, -y + 0.16, top + 0.1), STEEL),
        tube(
            (0.55 * x + 0.07, -y, top + 0.05),
            (0.55 * x + 0.07, -y + 0.12, top + 0.05),
            0.02,
            CHROME,
        ),
    ]
    if sz > top + 0.12:
        parts.append(box((-x, y - 0.02, top), (x, y, sz), paint((188, 160, 120))))
        for index in range(5):
            tool = -0.75 * x + 0.37 * x * index
            low, high = top + 0.3 * (sz - top), top + 0.85 * (sz - top)
            parts.append(
                box((tool - 0.015, y - 0.045, low), (tool + 0.015, y - 0.02, high - 0.06), surface)
            )
            parts.append(
                box((tool - 0.05, y - 0.05, high - 0.07), (tool + 0.05, y - 0.02, high), STEEL)
            )
    else:
        parts.append(cylinder((-0.5 * x, 0.0, top), 0.05, 0.1, paint((220, 170, 40)), 8))
    return parts
