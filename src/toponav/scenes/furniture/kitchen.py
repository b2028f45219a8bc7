"""Kitchen and laundry: counters and machines."""

from __future__ import annotations

from toponav.scenes.furniture.primitives import Part, box, cylinder, rounded_box, tube
from toponav.scenes.furniture.shape import Size
from toponav.scenes.furniture.storage import carcass, doors, drawers
from toponav.scenes.furniture.style import (
    BLACK_STEEL,
    CHROME,
    DARK,
    STEEL,
    WHITE_ENAMEL,
    Style,
)
from toponav.scenes.textures import Surface, marble, paint, wood

DARK_GLASS = paint((44, 50, 58))
DISPLAY = paint((90, 220, 190))


def counter(size: Size, style: Style) -> list[Part]:
    """Kitchen units under a worktop."""
    sx, sy, sz = size
    x, y, slab = sx / 2.0, sy / 2.0, 0.04
    front = style.front()
    worktop = marble((206, 204, 198)) if style.chance(0.5) else wood((160, 116, 72))
    count = max(1, round(sx / 0.6))
    width = sx / count
    parts = carcass((sx, sy, sz - slab), front, plinth=0.1)
    for index in range(count):
        left = -x + index * width
        if index % 3 == 1:
            parts += drawers((left, 0.12), (left + width, sz - slab - 0.01), -y, 3, front)
        else:
            parts += doors((left, 0.12), (left + width, sz - slab - 0.01), -y, 1, front)
    parts.append(box((-x, -y - 0.005, sz - slab), (x, y, sz), worktop))
    return parts


def fridge(size: Size, style: Style) -> list[Part]:
    """A freezer drawer below a refrigerator, or two wings when it is wide."""
    sx, sy, sz = size
    x, y = sx / 2.0, sy / 2.0
    skin = STEEL if style.chance(0.5) else WHITE_ENAMEL
    front = -y + 0.035
    parts = [
        box((-x, front + 0.05, 0.04), (x, y, sz), skin),
        box((-x + 0.02, front + 0.07, 0.0), (x - 0.02, y, 0.04), DARK),
        box((-x + 0.005, front + 0.03, 0.05), (x - 0.005, front + 0.06, sz - 0.01), DARK),
    ]
    if sx > 0.82:
        panels = [(-x, 0.05, -0.005, sz), (0.005, 0.05, x, sz)]
        handles = [(-0.05, 0.3 * sz, 0.85 * sz), (0.05, 0.3 * sz, 0.85 * sz)]
        parts.append(
            box((-0.75 * x, front - 0.008, 0.55 * sz), (-0.3 * x, front, 0.75 * sz), DARK_GLASS)
        )
    else:
        split = 0.36 * sz
        panels = [(-x, 0.05, x, split - 0.008), (-x, split + 0.008, x, sz)]
        handles = [(x - 0.07, 0.5 * split, split - 0.06), (x - 0.07, split + 0.06, 0.72 * sz)]
    for x0, z0, x1, z1 in panels:
        parts.append(rounded_box((x0, front, z0), (x1, front + 0.045, z1), 0.01, skin))
    for handle, z0, z1 in handles:
        parts.append(box((handle - 0.012, -y, z0), (handle + 0.012, -y + 0.015, z1), CHROME))
        for z in (z0, z1 - 0.02):
            parts.append(box((handle - 0.01, -y, z), (handle + 0.01, front, z + 0.02), CHROME))
    return parts


def oven(size: Size, style: Style) -> list[Part]:
    """A cooker: burners on top, knobs, and a door with a window."""
    sx, sy, sz = size
    x, y = sx / 2.0, sy / 2.0
    skin = STEEL if style.chance(0.6) else WHITE_ENAMEL
    hob = sz - 0.02
    panel = sz - 0.14
    parts = [
        box((-x, -y + 0.04, 0.0), (x, y, hob - 0.01), skin),
        box((-x, -y + 0.04, hob - 0.01), (x, y, hob), DARK_GLASS),
        box((-x, -y + 0.02, panel), (x, -y + 0.05, hob - 0.01), skin),
        box((-x + 0.02, -y + 0.02, 0.2 * sz), (x - 0.02, -y + 0.04, panel - 0.02), skin),
        box((-0.7 * x, -y + 0.012, 0.3 * sz), (0.7 * x, -y + 0.03, panel - 0.14), DARK_GLASS),
        box((-0.8 * x, -y, panel - 0.08), (0.8 * x, -y + 0.015, panel - 0.06), CHROME),
        box((-x + 0.02, -y + 0.02, 0.03), (x - 0.02, -y + 0.04, 0.18 * sz), skin),
    ]
    for knob in (-0.75, -0.5, 0.5, 0.75):
        middle = (knob * x, -y + 0.02, (panel + hob) / 2.0)
        parts.append(cylinder(middle, 0.02, 0.02, DARK, 8).turned("x", 90.0, middle))
    parts.append(
        box((-0.2 * x, -y + 0.015, panel + 0.03), (0.2 * x, -y + 0.03, hob - 0.04), DISPLAY)
    )
    for burner_x in (-0.5 * x, 0.5 * x):
        for burner_y in (-0.4 * y, 0.5 * y):
            parts.append(
                cylinder((burner_x, burner_y, hob), 0.2 * min(sx, sy), sz - hob, STEEL, 10)
            )
    return parts


def microwave(size: Size, style: Style) -> list[Part]:
    """A box with a dark window, and buttons to its right."""
    sx, sy, sz = size
    x, y = sx / 2.0, sy / 2.0
    skin = STEEL if style.chance(0.5) else WHITE_ENAMEL
    split = 0.45 * x
    parts = [
        rounded_box((-x, -y + 0.02, 0.0), (x, y, sz), 0.01, skin),
        box((-0.92 * x, -y + 0.01, 0.12 * sz), (split - 0.04, -y + 0.03, 0.88 * sz), DARK_GLASS),
        box((split - 0.02, -y, 0.15 * sz), (split, -y + 0.02, 0.85 * sz), CHROME),
        box((split + 0.02, -y + 0.01, 0.06 * sz), (0.95 * x, -y + 0.03, 0.94 * sz), BLACK_STEEL),
        box((split + 0.04, -y + 0.005, 0.74 * sz), (0.9 * x, -y + 0.02, 0.88 * sz), DISPLAY),
    ]
    for row in range(3):
        for column in range(2):
            left = split + 0.04 + column * (0.45 * x - 0.02) / 2.0
            low = (0.14 + 0.18 * row) * sz
            parts.append(
                box(
                    (left, -y + 0.005, low),
                    (left + 0.16 * x, -y + 0.02, low + 0.1 * sz),
                    WHITE_ENAMEL,
                )
            )
    return parts


def dishwasher(size: Size, style: Style) -> list[Part]:
    """One door with a handle bar under a control strip."""
    sx, sy, sz = size
    x, y = sx / 2.0, sy / 2.0
    skin = STEEL if style.chance(0.6) else WHITE_ENAMEL
    strip = sz - 0.13
    return [
        box((-x, -y + 0.05, 0.0), (x, y, sz), skin),
        box((-x + 0.01, -y + 0.03, 0.1), (x - 0.01, -y + 0.05, strip), skin),
        box((-x + 0.01, -y + 0.03, strip + 0.01), (x - 0.01, -y + 0.05, sz - 0.01), DARK_GLASS),
        box((0.3 * x, -y + 0.025, strip + 0.04), (0.7 * x, -y + 0.04, sz - 0.04), DISPLAY),
        box((-0.8 * x, -y, strip - 0.06), (0.8 * x, -y + 0.015, strip - 0.04), CHROME),
        box((-0.8 * x, -y, strip - 0.06), (-0.76 * x, -y + 0.03, strip - 0.04), CHROME),
        box((0.76 * x, -y, strip - 0.06), (0.8 * x, -y + 0.03, strip - 0.04), CHROME),
        box((-x + 0.01, -y + 0.08, 0.0), (x - 0.01, -y + 0.1, 0.1), DARK),
    ]


def washing_machine(size: Size, style: Style) -> list[Part]:
    """A round glass door, a dial and a drawer for the detergent."""
    return _laundry_machine(size, paint((120, 168, 200)), style)


def dryer(size: Size, style: Style) -> list[Part]:
    """As a washing machine, with an opaque door and a lint filter."""
    sx, sy, _ = size
    parts = _laundry_machine(size, paint((206, 208, 210)), style)
    y = sy / 2.0
    parts.append(box((-0.3 * sx, -y + 0.02, 0.05), (0.3 * sx, -y + 0.03, 0.12), BLACK_STEEL))
    return parts


def _laundry_machine(size: Size, window: Surface, style: Style) -> list[Part]:
    sx, sy, sz = size
    x, y = sx / 2.0, sy / 2.0
    skin = WHITE_ENAMEL if style.chance(0.75) else paint((92, 96, 104))
    middle, radius = (0.0, -y + 0.03, 0.48 * sz), 0.34 * min(sx, sz)
    front = -y + 0.03

    def disc(radius: float, depth: float, surface: Surface) -> Part:
        """A round plate on the front."""
        return cylinder(middle, radius, depth, surface, 18).turned("x", 90.0, middle)

    return [
        rounded_box((-x, front, 0.02), (x, y, sz), 0.012, skin),
        box((-x + 0.03, front + 0.03, 0.0), (x - 0.03, y - 0.03, 0.02), DARK),
        box((-x + 0.01, front - 0.005, 0.86 * sz), (x - 0.01, front, 0.98 * sz), BLACK_STEEL),
        box((-0.9 * x, front - 0.01, 0.885 * sz), (-0.4 * x, front, 0.955 * sz), WHITE_ENAMEL),
        box((0.45 * x, front - 0.01, 0.9 * sz), (0.85 * x, front, 0.95 * sz), DISPLAY),
        cylinder((0.1 * x, front, 0.92 * sz), 0.03, 0.025, CHROME, 10).turned(
            "x", 90.0, (0.1 * x, front, 0.92 * sz)
        ),
        disc(radius, 0.012, CHROME),
        disc(0.86 * radius, 0.02, DARK),
        disc(0.7 * radius, 0.03, window),
        tube(
            (0.8 * radius, -y + 0.012, 0.42 * sz),
            (0.8 * radius, -y + 0.012, 0.54 * sz),
            0.012,
            CHROME,
        ),
    ]
