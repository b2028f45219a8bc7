"""Instruments, sports gear and vehicles."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from toponav.scenes.furniture.primitives import (
    Part,
    box,
    cylinder,
    extruded,
    rounded_box,
    tube,
)
from toponav.scenes.furniture.shape import Size
from toponav.scenes.furniture.style import BLACK_STEEL, CHROME, DARK, STEEL, WHITE_ENAMEL, Style
from toponav.scenes.textures import Surface, paint

RUBBER = paint((36, 36, 38))
HEADLIGHT = paint((250, 246, 220))
TAIL_LIGHT = paint((200, 20, 20))


def piano(size: Size, style: Style) -> list[Part]:
    """An upright piano: a keyboard on two consoles before a high case."""
    sx, sy, sz = size
    x, y = sx / 2.0, sy / 2.0
    lacquer = paint((38, 32, 30)) if style.chance(0.5) else style.wood()
    keys, case = min(0.72, 0.6 * sz), -0.05 * sy
    parts = [
        box((-x, case, 0.0), (x, y, sz - 0.03), lacquer),
        box((-x, case - 0.03, sz - 0.03), (x, y, sz), lacquer),
        box((-x, -y, keys - 0.1), (x, case, keys - 0.03), lacquer),
        box((-x, -y, keys - 0.03), (-x + 0.06, case, keys + 0.06), lacquer),
        box((x - 0.06, -y, keys - 0.03), (x, case, keys + 0.06), lacquer),
        box((-x, -y + 0.02, 0.0), (-x + 0.08, -y + 0.1, keys - 0.1), lacquer),
        box((x - 0.08, -y + 0.02, 0.0), (x, -y + 0.1, keys - 0.1), lacquer),
        box((-x + 0.06, -y + 0.02, keys - 0.03), (x - 0.06, case - 0.03, keys), WHITE_ENAMEL),
        box(
            (-0.35 * x, case - 0.02, keys + 0.14),
            (0.35 * x, case, sz - 0.08),
            paint((236, 230, 214)),
        ),
        box((-0.12, case - 0.06, 0.03), (0.12, case, 0.05), CHROME),
    ]
    spacing = (sx - 0.12) / 21.0
    for index in range(21):
        if index % 7 in (2, 6):
            continue
        left = -x + 0.06 + (index + 0.7) * spacing
        parts.append(
            box((left, -0.32 * sy, keys), (left + 0.6 * spacing, case - 0.03, keys + 0.012), DARK)
        )
    return parts


def gym_equipment(size: Size, style: Style) -> list[Part]:
    """A treadmill when long, else a rack of dumbbells."""
    sx, sy, sz = size
    if max(sx, sy) > 1.0 and sz > 0.9:
        return _treadmill(size)
    return _dumbbell_rack(size, style)


def _treadmill(size: Size) -> list[Part]:
    """A belt between rails; the console is at the back when deep, at +x when wide."""
    sx, sy, sz = size
    if sx > sy:
        return [part.turned("z", -90.0) for part in _treadmill((sy, sx, sz))]
    x, y = sx / 2.0, sy / 2.0
    parts = [
        box((-x, -y, 0.04), (x, y, 0.16), BLACK_STEEL),
        box((-0.72 * x, -y - 0.005, 0.16), (0.72 * x, 0.85 * y, 0.175), RUBBER),
        box((-x, -y, 0.16), (-0.76 * x, 0.85 * y, 0.19), STEEL),
        box((0.76 * x, -y, 0.16), (x, 0.85 * y, 0.19), STEEL),
        rounded_box((-0.85 * x, 0.7 * y, 0.15), (0.85 * x, y, 0.3), 0.04, paint((190, 44, 40))),
        rounded_box((-x, 0.62 * y, sz - 0.22), (x, 0.72 * y, sz), 0.03, BLACK_STEEL),
        box(
            (-0.5 * x, 0.61 * y, sz - 0.17), (0.5 * x, 0.63 * y, sz - 0.05), paint((110, 210, 230))
        ),
        box((-x, -y, 0.0), (x, -y + 0.08, 0.04), DARK),
        box((-x, y - 0.08, 0.0), (x, y, 0.04), DARK),
    ]
    for side in (-0.92 * x, 0.92 * x):
        parts.append(tube((side, 0.85 * y, 0.16), (side, 0.67 * y, sz - 0.1), 0.03, STEEL))
        parts.append(tube((side, 0.67 * y, sz - 0.2), (side, 0.1 * y, sz - 0.3), 0.022, DARK))
    return parts


def _dumbbell_rack(size: Size, style: Style) -> list[Part]:
    """Two or three shelves of dumbbells."""
    sx, sy, sz = size
    x, y = sx / 2.0, sy / 2.0
    rows = 3 if sz > 0.8 else 2 if sz > 0.4 else 1
    color = paint(style.pick(((60, 62, 68), (60, 90, 150), (150, 60, 60))))
    parts = []
    for side in (-x, x - 0.04):
        parts.append(box((side, -y, 0.0), (side + 0.04, y, 0.04), BLACK_STEEL))
        parts.append(box((side, 0.2 * y, 0.0), (side + 0.04, 0.2 * y + 0.05, sz), BLACK_STEEL))
    radius = min(0.07, 0.18 * sz)
    for row in range(rows):
        z = 0.06 + row * (sz - 0.1) / rows
        parts.append(box((-x, -y + 0.02, z), (x, y, z + 0.03), STEEL))
        count = max(2, int(sx / 0.24))
        for index in range(count):
            middle = -x + (index + 0.5) * sx / count
            height = z + 0.03 + radius
            parts.append(tube((middle, -0.8 * y, height), (middle, 0.8 * y, height), 0.016, CHROME))
            for end in (-0.9 * y, 0.3 * y):
                hub = (middle, end + 0.6 * y, height)
                weight = cylinder(hub, radius, 0.6 * y, color, 8)
                parts.append(weight.turned("x", 90.0, hub))
    return parts


def bicycle(size: Size, style: Style) -> list[Part]:
    """A bicycle seen from its side along the longer of its two sides."""
    sx, sy, sz = size
    if sy > sx:
        return [part.turned("z", 90.0) for part in bicycle((sy, sx, sz), style)]
    x = sx / 2.0
    paintwork = paint(style.pick(((190, 40, 44), (36, 96, 160), (44, 120, 74), (40, 42, 48))))
    radius = min(0.34 * sz, 0.24 * sx)
    rear, front = (-x + radius, 0.0, radius), (x - radius, 0.0, radius)
    crank, saddle, head = (
        (-0.1 * x, 0.0, 0.9 * radius),
        (-0.28 * x, 0.0, 0.86 * sz),
        (0.42 * x, 0.0, 0.82 * sz),
    )
    parts = [*_wheel(rear, radius), *_wheel(front, radius)]
    frame = [(rear, crank), (rear, saddle), (crank, saddle), (crank, head), (saddle, head)]
    for start, end in (*frame, (head, front)):
        parts.append(tube(start, end, 0.018, paintwork))
    grip = (head[0] - 0.03, 0.0, sz - 0.02)
    parts += [
        tube(head, grip, 0.014, CHROME),
        tube((grip[0], -0.5 * sy, sz - 0.02), (grip[0], 0.5 * sy, sz - 0.02), 0.016, DARK),
        rounded_box(
            (saddle[0] - 0.14, -0.07, saddle[2]),
            (saddle[0] + 0.12, 0.07, saddle[2] + 0.06),
            0.03,
            DARK,
        ),
        tube((crank[0], -0.1, crank[2] - 0.12), (crank[0], 0.1, crank[2] + 0.12), 0.012, STEEL),
    ]
    return parts


def _wheel(hub: tuple[float, float, float], radius: float) -> list[Part]:
    """A tyre of twelve rods and three pairs of spokes, in the xz plane."""
    angles = np.linspace(0.0, 2.0 * np.pi, 13)
    rim = [
        (
            float(hub[0] + (radius - 0.02) * np.cos(a)),
            hub[1],
            float(hub[2] + (radius - 0.02) * np.sin(a)),
        )
        for a in angles
    ]
    tyre = [tube(a, b, 0.02, RUBBER, 4) for a, b in pairwise(rim)]
    spokes = [tube(rim[k], rim[k + 6], 0.005, STEEL, 3) for k in (0, 2, 4)]
    return tyre + spokes


def car(size: Size, style: Style) -> list[Part]:
    """A hatchback whose front is at -y when it is deep, at -x when it is wide."""
    sx, sy, sz = size
    if sx > sy:
        return [part.turned("z", -90.0) for part in car((sy, sx, sz), style)]
    x, y = sx / 2.0, sy / 2.0
    body = paint(style.pick(((176, 36, 40), (40, 74, 130), (206, 208, 212), (70, 74, 80))))
    glass = paint((70, 88, 102))
    waist, sill, roof = 0.56 * sz, 0.16 * sz, sz - 0.06
    hood = [(-0.3 * y, waist), (-0.95 * y, 0.46 * sz), (-y, 0.4 * sz)]
    lower = [(-y, sill), (y, sill), (y, waist), *hood]
    cabin = [(-0.42 * y, waist), (0.96 * y, waist), (0.7 * y, sz), (-0.1 * y, sz)]
    sides = [
        (-0.36 * y, waist + 0.02),
        (0.88 * y, waist + 0.02),
        (0.68 * y, roof),
        (-0.1 * y, roof),
    ]
    screen = [(-0.43 * y, waist), (-0.4 * y, waist), (-0.1 * y, roof), (-0.13 * y, roof)]
    parts = [
        extruded(lower, -x, x, body),
        extruded(cabin, -0.86 * x, 0.86 * x, body),
        extruded(sides, -0.88 * x, 0.88 * x, glass),
        extruded(screen, -0.78 * x, 0.78 * x, glass),
        box((-0.4 * x, -y - 0.01, 0.2 * sz), (0.4 * x, -y + 0.02, 0.34 * sz), DARK),
    ]
    for low, high in ((-0.9 * x, -0.55 * x), (0.55 * x, 0.9 * x)):
        parts.append(box((low, -y - 0.01, 0.3 * sz), (high, -y + 0.02, 0.38 * sz), HEADLIGHT))
        parts.append(box((low, y - 0.02, 0.4 * sz), (high, y + 0.01, 0.5 * sz), TAIL_LIGHT))
    radius = 0.21 * sz
    for axle in (-0.62 * y, 0.62 * y):
        for side in (-1.0, 1.0):
            parts += _car_wheel((side * (x - 0.08), axle, radius), radius, side)
    return parts


def _car_wheel(hub: tuple[float, float, float], radius: float, side: float) -> list[Part]:
    """A tyre with a bright rim on its outer side."""

    def disc(radius: float, width: float, surface: Surface) -> Part:
        return cylinder(hub, radius, width, surface).turned("y", 90.0 * side, hub)

    return [disc(radius, 0.1, RUBBER), disc(0.6 * radius, 0.105, STEEL)]
