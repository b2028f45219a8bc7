"""Plants, pictures, lamps, rugs and other things that furnish a room."""

from __future__ import annotations

import numpy as np

from toponav.scenes.furniture.primitives import (
    Part,
    blade,
    box,
    ellipsoid,
    extruded,
    lathe,
    mat,
    picture,
    rounded_box,
    tube,
)
from toponav.scenes.furniture.shape import Size
from toponav.scenes.furniture.style import BLACK_STEEL, CHROME, DARK, STEEL, Style
from toponav.scenes.textures import (
    artwork,
    brick,
    fabric,
    foliage,
    marble,
    paint,
    rug_pattern,
    wood,
)

POT_COLORS = ((178, 92, 60), (232, 228, 220), (84, 94, 106), (196, 150, 96))
GREENS = ((70, 138, 58), (46, 112, 52), (108, 158, 66))
SOIL = paint((66, 48, 36))


def plant(size: Size, style: Style) -> list[Part]:
    """A potted plant: arching leaves, upright blades, or a small tree when it is high."""
    sx, sy, sz = size
    pot = min(0.3, 0.34 * sz)
    half = (sx / 2.0, sy / 2.0)
    wide = 0.5 if sz < 0.8 else 0.58
    clay = paint(style.pick(POT_COLORS))
    profile = [(0.0, 0.0), (0.68 * wide, 0.0), (0.92 * wide, 0.82 * pot), (wide, 0.82 * pot),
               (wide, pot), (0.86 * wide, pot), (0.84 * wide, 0.9 * pot)]  # fmt: skip
    soil = [(0.85 * wide, 0.92 * pot), (0.0, 0.92 * pot)]
    parts = [lathe(profile, clay, stretch=half), lathe(soil, SOIL, stretch=half)]
    if sz > 1.05 and style.chance(0.7):
        return [*parts, *_tree_crown(size, pot, style)]
    if style.chance(0.3):
        return [*parts, *_upright_leaves(size, pot, style)]
    return [*parts, *_arching_leaves(size, pot, style)]


def _arching_leaves(size: Size, pot: float, style: Style) -> list[Part]:
    """Leaves in three tiers that rise from the pot and bend outwards."""
    sx, sy, sz = size
    parts = []
    for tier, (reach, top, count) in enumerate(((1.0, 0.62, 9), (0.8, 0.86, 8), (0.4, 1.0, 6))):
        green = foliage(GREENS[(tier + style.texture_seed) % 3], tier)
        for index in range(count):
            angle = 2.0 * np.pi * (index + 0.5 * tier) / count + float(style.rng.uniform(-0.2, 0.2))
            stretch = float(style.rng.uniform(0.85, 1.0))
            out = np.array([0.5 * sx * np.cos(angle), 0.5 * sy * np.sin(angle)]) * reach * stretch
            rise = (top * sz - pot) * stretch
            bend = [(0.05, 0.0), (0.35, 0.75), (0.7, 1.0), (1.0, 0.82 if tier < 2 else 1.02)]
            points = [(float(out[0] * s), float(out[1] * s), 0.9 * pot + rise * t) for s, t in bend]
            width = 0.3 * min(sx, sy)
            across = (-np.sin(angle), np.cos(angle), 0.0)
            parts.append(blade(points, (0.2 * width, 0.9 * width, width, 0.0), across, green))
    return parts


def _upright_leaves(size: Size, pot: float, style: Style) -> list[Part]:
    """Stiff blades, as of a snake plant."""
    sx, sy, sz = size
    parts = []
    for index in range(14):
        angle = 2.4 * index
        spread = np.sqrt((index + 0.5) / 14.0)
        base = (0.2 * sx * spread * np.cos(angle), 0.2 * sy * spread * np.sin(angle))
        tip = (0.5 * sx * spread * np.cos(angle), 0.5 * sy * spread * np.sin(angle))
        top = sz * float(style.rng.uniform(0.7, 1.0)) if index else sz
        points = [
            (float(base[0] + t * (tip[0] - base[0])), float(base[1] + t * (tip[1] - base[1])),
             0.88 * pot + t * (top - 0.88 * pot))
            for t in (0.0, 0.5, 1.0)
        ]  # fmt: skip
        width = 0.22 * min(sx, sy)
        across = (-np.sin(angle + 0.6), np.cos(angle + 0.6), 0.0)
        green = foliage(GREENS[index % 3], index % 2)
        parts.append(blade(points, (0.7 * width, width, 0.0), across, green))
    return parts


def _tree_crown(size: Size, pot: float, style: Style) -> list[Part]:
    """A trunk and a crown of many leaves around it."""
    sx, sy, sz = size
    bark = wood((104, 76, 50))
    crown_low = pot + 0.28 * (sz - pot)
    middle, radius = (crown_low + sz) / 2.0, (sz - crown_low) / 2.0
    parts = [tube((0.0, 0.0, 0.85 * pot), (0.01, 0.01, middle), 0.025, bark)]
    for index in range(52):
        height = 1.0 - 2.0 * (index + 0.5) / 52.0
        angle = 2.4 * index
        around = np.sqrt(1.0 - height**2)
        out = np.array([0.5 * sx * around * np.cos(angle), 0.5 * sy * around * np.sin(angle),
                        radius * height])  # fmt: skip
        depth = float(style.rng.uniform(0.45, 0.75))
        start, end = depth * out, out - np.array([0.0, 0.0, 0.12 * radius])
        points = [(float(p[0]), float(p[1]), float(p[2]) + middle)
                  for p in (start, 0.55 * start + 0.45 * end + (0.0, 0.0, 0.04), end)]  # fmt: skip
        across = (-np.sin(angle), np.cos(angle), 0.25)
        width = 0.3 * min(sx, sy)
        green = foliage(GREENS[index % 3], index % 2)
        parts.append(blade(points, (0.25 * width, width, 0.0), across, green))
    return parts


def wall_picture(size: Size, style: Style) -> list[Part]:
    """A framed painting with a mount."""
    sx, sy, sz = size
    x, y = sx / 2.0, sy / 2.0
    edge = min(0.04, 0.1 * min(sx, sz))
    frame = style.pick((wood((92, 60, 36)), paint((40, 40, 42)), paint((204, 172, 96))))
    motif = artwork(int(style.rng.integers(6)))
    margin = edge + (0.08 * min(sx, sz) if style.chance(0.6) else 0.0)
    face = -0.5 * y
    return [
        box((-x, -y, 0.0), (x, y, edge), frame),
        box((-x, -y, sz - edge), (x, y, sz), frame),
        box((-x, -y, edge), (-x + edge, y, sz - edge), frame),
        box((x - edge, -y, edge), (x, y, sz - edge), frame),
        box((-x + edge, face, edge), (x - edge, y, sz - edge), paint((240, 238, 230))),
        picture((0.0, face - 0.0005, sz / 2.0), sx - 2.0 * margin, sz - 2.0 * margin, motif),
    ]


def lamp(size: Size, style: Style) -> list[Part]:
    """A shade on a pole with a foot; the shade is lit."""
    sx, sy, sz = size
    half = (sx / 2.0, sy / 2.0)
    shade_low = sz - min(0.32, 0.45 * sz)
    shade = paint(style.pick(((255, 238, 196), (250, 226, 180), (240, 236, 224))))
    pole = CHROME if style.chance(0.5) else BLACK_STEEL
    shape = [(1.0, shade_low), (0.68, sz), (0.62, sz), (0.94, shade_low)]
    return [
        lathe([(0.0, 0.0), (0.7, 0.0), (0.66, 0.02), (0.1, 0.035)], pole, stretch=half),
        tube((0.0, 0.0, 0.02), (0.0, 0.0, shade_low + 0.1), 0.014, pole),
        lathe(shape, shade, stretch=half),
        ellipsoid((0.0, 0.0, shade_low + 0.12), (0.04, 0.04, 0.06), paint((255, 250, 226)), 8),
    ]


def rug(size: Size, style: Style) -> list[Part]:
    """A flat woven rug."""
    sx, sy, sz = size
    x, y = sx / 2.0, sy / 2.0
    colors = ((150, 58, 52), (64, 86, 124), (120, 104, 78), (70, 110, 96))
    weave = rug_pattern(style.pick(colors), style.texture_seed)
    edge = fabric((84, 68, 56))
    return [
        box((-x, -y, 0.0), (x, y, 0.9 * sz), edge),
        mat((-x, -y, sz), (x, y, sz), weave),
    ]


def fireplace(size: Size, style: Style) -> list[Part]:
    """A brick hearth with fire and logs under a mantelpiece."""
    sx, sy, sz = size
    x, y = sx / 2.0, sy / 2.0
    stone = brick((156, 86, 66)) if style.chance(0.6) else marble((216, 212, 206))
    mantel, opening = 0.08, min(0.7 * sz, 0.75)
    inner = 0.58 * x
    parts = [
        box((-x, -y + 0.06, 0.0), (-inner, y, sz - mantel), stone),
        box((inner, -y + 0.06, 0.0), (x, y, sz - mantel), stone),
        box((-inner, -y + 0.06, opening), (inner, y, sz - mantel), stone),
        box((-inner, y - 0.03, 0.0), (inner, y, opening), DARK),
        box((-x, -y, 0.0), (x, y - 0.03, 0.05), marble((150, 146, 142))),
        box((-x - 0.03, -y + 0.01, sz - mantel), (x + 0.03, y, sz), wood((96, 64, 40))),
    ]
    flames = ((paint((240, 120, 30)), 0.22, 0.5), (paint((255, 214, 90)), 0.12, 0.32))
    for index, middle in enumerate((-0.3 * inner, 0.0, 0.3 * inner)):
        z = 0.1 + 0.05 * (index % 2)
        log = ((middle - 0.12, 0.0, z), (middle + 0.14, 0.25 * y, z + 0.02))
        parts.append(tube(*log, 0.045, wood((84, 58, 40))))
        for color, width, height in flames:
            tongue = [
                (middle, 0.1 * y - 0.4 * width, 0.1),
                (middle, 0.1 * y, 0.3 * opening),
                (middle + 0.03, 0.1 * y, height * opening + 0.1),
            ]
            parts.append(blade(tongue, (width, 0.8 * width, 0.0), (1.0, 0.0, 0.0), color))
    return parts


def refuse_bin(size: Size, style: Style) -> list[Part]:
    """A pedal bin with a domed lid."""
    sx, sy, sz = size
    half = (sx / 2.0, sy / 2.0)
    skin = STEEL if style.chance(0.5) else paint((74, 98, 84))
    lid = 0.84 * sz
    return [
        lathe([(0.0, 0.0), (0.84, 0.0), (0.94, 0.05 * sz), (0.97, lid)], skin, stretch=half),
        lathe(
            [(1.0, lid), (1.0, lid + 0.05 * sz), (0.8, 0.95 * sz), (0.0, sz)], DARK, stretch=half
        ),
        box((-0.3 * half[0], -half[1], 0.02), (0.3 * half[0], -0.8 * half[1], 0.045), DARK),
    ]


def book(size: Size, style: Style) -> list[Part]:
    """A closed book: covers around a block of pages."""
    sx, sy, sz = size
    x, y = sx / 2.0, sy / 2.0
    cover = paint(style.pick(((150, 40, 44), (36, 78, 128), (44, 106, 74), (200, 150, 50))))
    board = min(0.004, 0.2 * sz)
    return [
        box((-x, -y, 0.0), (x, y, board), cover),
        box((-x, -y, sz - board), (x, y, sz), cover),
        box((-x, -y, board), (-x + 2.0 * board, y, sz - board), cover),
        box((-x + 2.0 * board, -y + 0.004, board), (x - 0.004, y - 0.004, sz - board),
            paint((240, 234, 216))),
    ]  # fmt: skip


def clothes(size: Size, style: Style) -> list[Part]:
    """Garments on a rack when high, else a folded heap."""
    sx, sy, sz = size
    x, y = sx / 2.0, sy / 2.0
    if sz < 0.6:
        return [
            rounded_box(
                (-x * (1.0 - 0.12 * k), -y * (1.0 - 0.08 * k), sz * k / 4.0),
                (x * (1.0 - 0.06 * (3 - k)), y * (1.0 - 0.1 * (k % 2)), sz * (k + 1) / 4.0),
                0.1 * sz,
                style.fabric(),
            )
            for k in range(4)
        ]
    rail = sz - 0.04
    parts = [
        tube((-x, 0.0, rail), (x, 0.0, rail), 0.015, CHROME),
        box((-x, -y, 0.0), (-x + 0.03, y, 0.03), CHROME),
        box((x - 0.03, -y, 0.0), (x, y, 0.03), CHROME),
        tube((-x + 0.015, 0.0, 0.0), (-x + 0.015, 0.0, sz), 0.015, CHROME),
        tube((x - 0.015, 0.0, 0.0), (x - 0.015, 0.0, sz), 0.015, CHROME),
    ]
    count = max(2, int((sx - 0.1) / 0.11))
    for index in range(count):
        left = -x + 0.05 + index * (sx - 0.1) / count
        right = left + 0.8 * (sx - 0.1) / count
        hem = rail - (rail - 0.15) * float(style.rng.uniform(0.6, 0.95))
        outline = [(-0.8 * y, hem), (0.8 * y, hem), (0.85 * y, rail - 0.14), (0.0, rail - 0.03),
                   (-0.85 * y, rail - 0.14)]  # fmt: skip
        parts.append(extruded(outline, left, right, style.fabric()))
    return parts
