"""Bathroom fixtures."""

from __future__ import annotations

import numpy as np

from toponav.scenes.furniture.primitives import (
    Part,
    box,
    cylinder,
    lathe,
    quads,
    rounded_box,
    tube,
)
from toponav.scenes.furniture.shape import Size
from toponav.scenes.furniture.storage import carcass, doors
from toponav.scenes.furniture.style import BLACK_STEEL, CERAMIC, CHROME, Style
from toponav.scenes.textures import fabric, paint, tiles

WATER = paint((150, 190, 205))
SHADED_CERAMIC = paint((196, 200, 202))
GLASS = paint((178, 208, 214))


def toilet(size: Size, style: Style) -> list[Part]:
    """A bowl on a foot with a seat, its lid raised or closed, before a cistern."""
    sx, sy, sz = size
    x, y = sx / 2.0, sy / 2.0
    rim = 0.52 * sz
    tank = 0.28 * sy
    front = y - tank
    half = (0.46 * sx, (front + y) / 2.0)
    middle = (0.0, front - half[1])
    bowl = [(0.5, 0.0), (0.56, 0.04), (0.5, 0.3 * rim), (0.62, 0.6 * rim), (0.95, 0.92 * rim),
            (0.97, rim)]  # fmt: skip
    inside = [(0.97, rim), (0.7, rim), (0.62, 0.8 * rim), (0.35, 0.62 * rim)]
    seat = [(0.7, rim), (0.7, rim + 0.025), (0.76, rim + 0.035), (0.96, rim + 0.035),
            (1.0, rim + 0.02), (1.0, rim)]  # fmt: skip
    trim = CERAMIC if style.chance(0.6) else style.wood()
    parts = [
        lathe(bowl, CERAMIC, middle, half),
        box((-0.3 * sx, middle[1], 0.0), (0.3 * sx, front + 0.04, 0.9 * rim), CERAMIC),
        rounded_box((-x, front, 0.82 * rim), (x, y, sz - 0.05), 0.03, CERAMIC),
        rounded_box(
            (-x - 0.01, front - 0.015, sz - 0.05), (x + 0.01, y, sz - 0.008), 0.012, CERAMIC
        ),
        cylinder((0.0, (front + y) / 2.0, sz - 0.008), 0.025, 0.008, CHROME, 8),
    ]
    if style.chance(0.7):
        hole = [(0.35, 0.62 * rim), (0.0, 0.62 * rim)]
        lid = [(0.0, 0.0), (0.97, 0.0), (0.97, 0.02), (0.0, 0.025)]
        raised = lathe(lid, trim, (0.0, 0.0), (0.44 * sx, 0.44 * (sz - rim)))
        parts += [
            lathe(inside, SHADED_CERAMIC, middle, half),
            lathe(hole, WATER, middle, half),
            lathe(seat[::-1], trim, middle, half),
            raised.turned("x", 82.0).moved((0.0, front - 0.045, rim + 0.05 + 0.42 * (sz - rim))),
        ]
    else:
        lid = [(0.0, rim), (1.0, rim), (1.0, rim + 0.03), (0.92, rim + 0.05), (0.0, rim + 0.055)]
        parts.append(lathe(lid, trim, middle, half))
    return parts


def sink(size: Size, style: Style) -> list[Part]:
    """A basin with a tap: round on a pedestal when narrow, else let into a cabinet."""
    sx, sy, sz = size
    rim = sz - min(0.14, 0.4 * sz)
    if rim < 0.5:
        return [*_round_basin(size, 0.0, rim), *_tap(size, rim)]
    if sx < 0.56:
        foot = [(0.4, 0.0), (0.3, 0.1 * rim), (0.28, 0.6 * rim), (0.5, 0.8 * rim)]
        pedestal = lathe(foot, CERAMIC, (0.0, 0.1 * sy), (0.4 * sx, 0.4 * sy))
        return [pedestal, *_round_basin(size, 0.76 * rim, rim), *_tap(size, rim)]
    front = style.front()
    body: Size = (0.98 * sx, 0.96 * sy, rim - 0.05)
    return [
        *carcass((body[0], body[1], rim - 0.15), front),
        *doors((-0.49 * sx, 0.08), (0.49 * sx, rim - 0.06), -0.48 * sy, 2, front),
        *_inset_basin(size, rim),
        *_tap(size, rim),
    ]


def _round_basin(size: Size, low: float, rim: float) -> list[Part]:
    """A bowl from `low` to `rim` with a ledge for the tap behind it."""
    x, y = size[0] / 2.0, size[1] / 2.0
    rise = rim - low
    outside = [(0.4, low), (0.8, low + 0.4 * rise), (1.0, rim), (0.86, rim)]
    inside = [
        (0.86, rim),
        (0.75, rim - 0.4 * rise),
        (0.35, low + 0.25 * rise),
        (0.0, low + 0.25 * rise),
    ]
    return [
        lathe(outside, CERAMIC, stretch=(x, y)),
        lathe(inside, SHADED_CERAMIC, stretch=(x, y)),
        rounded_box((-0.7 * x, 0.6 * y, low + 0.4 * rise), (0.7 * x, y, rim + 0.01), 0.02, CERAMIC),
    ]


def _inset_basin(size: Size, rim: float) -> list[Part]:
    """A slab with a rectangular basin in it, 15 cm deep."""
    x, y = size[0] / 2.0, size[1] / 2.0
    inner = min(0.72 * x, 0.3)
    front, back, slab, floor = -0.72 * y, 0.45 * y, rim - 0.05, rim - 0.13
    return [
        box((-x, -y, slab), (x, front, rim), CERAMIC),
        box((-x, back, slab), (x, y, rim), CERAMIC),
        box((-x, front, slab), (-inner, back, rim), CERAMIC),
        box((inner, front, slab), (x, back, rim), CERAMIC),
        box((-inner, front, floor), (inner, back, floor + 0.01), SHADED_CERAMIC),
        box((-inner - 0.01, front - 0.01, floor), (-inner, back + 0.01, slab), SHADED_CERAMIC),
        box((inner, front - 0.01, floor), (inner + 0.01, back + 0.01, slab), SHADED_CERAMIC),
        box((-inner, back, floor), (inner, back + 0.01, slab), SHADED_CERAMIC),
        box((-inner, front - 0.01, floor), (inner, front, slab), SHADED_CERAMIC),
    ]


def _tap(size: Size, rim: float) -> list[Part]:
    """A mixer tap at the back of a basin."""
    y, top = size[1] / 2.0, size[2]
    return [
        tube((0.0, 0.8 * y, rim), (0.0, 0.8 * y, top - 0.012), 0.018, CHROME),
        tube((0.0, 0.8 * y, top - 0.03), (0.0, 0.1 * y, top - 0.045), 0.014, CHROME),
        box((-0.04, 0.74 * y, top - 0.012), (0.04, 0.86 * y, top), CHROME),
    ]


def bathtub(size: Size, style: Style) -> list[Part]:
    """A tub with a broad rim and a tap at its left end."""
    sx, sy, sz = size
    x, y = sx / 2.0, sy / 2.0
    rim = sz - 0.12 if sz > 0.62 else sz
    wide = min(0.08, 0.12 * sy)
    floor = 0.35 * rim
    apron = CERAMIC if style.chance(0.6) else paint((206, 214, 218))
    slope = 0.12 * sx
    inner = np.array([[-x + wide, -y + wide], [x - wide, -y + wide], [x - wide, y - wide],
                      [-x + wide, y - wide]])  # fmt: skip
    base = inner * (1.0 - 2.0 * slope / sx, 0.8)
    upper = np.column_stack([inner, np.full(4, rim)])
    lower = np.column_stack([base, np.full(4, floor)])
    turn = np.roll(np.arange(4), -1)
    sides = np.stack([upper, upper[turn], lower[turn], lower], axis=1)
    parts = [
        box((-x, -y, 0.0), (x, -y + wide, rim - 0.04), apron),
        box((-x, y - wide, 0.0), (x, y, rim - 0.04), apron),
        box((-x, -y, 0.0), (-x + wide, y, rim - 0.04), apron),
        box((x - wide, -y, 0.0), (x, y, rim - 0.04), apron),
        box((-x, -y, rim - 0.04), (x, -y + wide, rim), CERAMIC),
        box((-x, y - wide, rim - 0.04), (x, y, rim), CERAMIC),
        box((-x, -y, rim - 0.04), (-x + wide, y, rim), CERAMIC),
        box((x - wide, -y, rim - 0.04), (x, y, rim), CERAMIC),
        quads(sides, SHADED_CERAMIC),
        quads(lower[None], SHADED_CERAMIC),
    ]
    if sz > rim:
        parts.append(tube((-x + 0.04, 0.0, rim), (-x + 0.04, 0.0, sz - 0.02), 0.02, CHROME))
        parts.append(tube((-x + 0.04, 0.0, sz - 0.02), (-x + 0.2, 0.0, sz - 0.04), 0.018, CHROME))
        parts.append(box((-x + 0.02, -0.08, sz - 0.03), (-x + 0.06, 0.08, sz), CHROME))
    return parts


def shower(size: Size, style: Style) -> list[Part]:
    """A tray, a tiled back, glass to the left, a pole with its head; open to the front."""
    sx, sy, sz = size
    x, y = sx / 2.0, sy / 2.0
    wall = tiles(style.pick(((150, 186, 198), (196, 206, 200), (176, 190, 210))), 0.1)
    head = sz - 0.12
    parts = [
        box((-x, -y, 0.0), (x, y, 0.08), CERAMIC),
        cylinder((0.0, 0.0, 0.08), 0.05, 0.004, CHROME, 8),
        box((-x, y - 0.02, 0.08), (x, y, sz), wall),
        tube((0.0, y - 0.05, min(0.9, 0.5 * head)), (0.0, y - 0.05, head), 0.015, CHROME),
        tube((0.0, y - 0.05, head), (0.0, 0.2 * y, head), 0.015, CHROME),
        lathe(
            [(0.0, head - 0.05), (0.11, head - 0.05), (0.02, head), (0.0, head)],
            CHROME,
            (0.0, 0.2 * y),
        ),
        box((-0.1, y - 0.08, 0.95), (0.1, y - 0.02, 1.02), CHROME),
    ]
    for left in (-x, x - 0.02):
        parts.append(box((left, -y, 0.08), (left + 0.02, -y + 0.03, sz - 0.02), CHROME))
        parts.append(box((left, -y, sz - 0.03), (left + 0.02, y, sz), CHROME))
    parts.append(box((-x + 0.006, -y + 0.03, 0.08), (-x + 0.014, y - 0.02, sz - 0.03), GLASS))
    parts.append(box((-x, -y, sz - 0.03), (x, -y + 0.03, sz), CHROME))
    return parts


def towel(size: Size, style: Style) -> list[Part]:
    """A towel over a rail; folded when it is flat."""
    sx, sy, sz = size
    x, y = sx / 2.0, sy / 2.0
    cloth, band = style.fabric(), fabric((238, 236, 228))
    if sz < 0.6 * min(sx, sy):
        layers = 3
        return [
            rounded_box((-x, -y, sz * k / layers), (x, y, sz * (k + 1) / layers), 0.3 * sz / layers,
                        band if k == 1 else cloth)
            for k in range(layers)
        ]  # fmt: skip
    rail = sz - 0.02
    return [
        tube((-x, 0.1 * y, rail), (x, 0.1 * y, rail), min(0.012, 0.4 * sy), CHROME),
        box((-x, 0.0, rail - 0.015), (-x + 0.02, y, rail + 0.015), CHROME),
        box((x - 0.02, 0.0, rail - 0.015), (x, y, rail + 0.015), CHROME),
        rounded_box((-0.88 * x, -y, 0.0), (0.88 * x, -0.2 * y, sz), 0.01, cloth),
        rounded_box((-0.86 * x, 0.3 * y, 0.15 * sz), (0.86 * x, 0.8 * y, sz), 0.01, cloth),
        rounded_box((-0.9 * x, -1.02 * y, 0.12 * sz), (0.9 * x, -0.1 * y, 0.2 * sz), 0.008, band),
    ]


def mirror(size: Size, style: Style) -> list[Part]:
    """A framed glass with bright reflections."""
    sx, sy, sz = size
    x, y = sx / 2.0, sy / 2.0
    frame = style.wood() if style.chance(0.6) else BLACK_STEEL
    edge = min(0.05, 0.08 * min(sx, sz))
    glass, streak = paint((190, 210, 220)), paint((226, 238, 242))
    face = -0.6 * y
    shine = np.array(
        [[-0.35 * sx, face - 0.001, 0.2 * sz], [-0.22 * sx, face - 0.001, 0.2 * sz],
         [0.2 * sx, face - 0.001, 0.8 * sz], [0.07 * sx, face - 0.001, 0.8 * sz]]
    )  # fmt: skip
    return [
        box((-x, -y, 0.0), (x, y, edge), frame),
        box((-x, -y, sz - edge), (x, y, sz), frame),
        box((-x, -y, edge), (-x + edge, y, sz - edge), frame),
        box((x - edge, -y, edge), (x, y, sz - edge), frame),
        box((-x + edge, face, edge), (x - edge, y, sz - edge), glass),
        quads(shine[None], streak),
        quads(shine[None] + (0.16 * sx, 0.0, 0.0), streak),
    ]
