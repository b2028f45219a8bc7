"""What people sit on: chairs, stools, benches, sofas, and the cushions on them."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from toponav.scenes.furniture.primitives import (
    Part,
    box,
    cylinder,
    ellipsoid,
    lathe,
    quads,
    rounded_box,
    tube,
)
from toponav.scenes.furniture.shape import Size
from toponav.scenes.furniture.style import BLACK_STEEL, CHROME, DARK, Style
from toponav.scenes.textures import Surface, fabric

SEAT_HEIGHT_M = 0.45
"""Of chairs and benches."""

ARMCHAIR_WIDTH_M = 0.68
"""A wider and deeper chair is upholstered."""

OFFICE_CHAIR_WIDTH_M = 0.55
"""A chair of at least this width and depth stands on a column with castors: room for five feet."""


def chair(size: Size, style: Style) -> list[Part]:
    """A dining chair, an office chair or an armchair, by its width and depth."""
    reach = min(size[0], size[1])
    if reach >= ARMCHAIR_WIDTH_M:
        return _upholstered(size, style.fabric(), seats=1)
    if reach >= OFFICE_CHAIR_WIDTH_M and size[2] >= 0.8:
        return _office_chair(size, style)
    return _dining_chair(size, style)


def _dining_chair(size: Size, style: Style) -> list[Part]:
    sx, sy, sz = size
    frame = style.wood()
    seat = min(SEAT_HEIGHT_M, 0.55 * sz)
    leg, x, y = 0.04, sx / 2.0, sy / 2.0
    parts = [
        rounded_box((-x, -y, seat - 0.05), (x, y, seat), 0.02, style.fabric()),
        box((-x + 0.01, -y + 0.01, seat - 0.09), (x - 0.01, y, seat - 0.05), frame),
    ]
    for side in (-1.0, 1.0):
        left, right = sorted((side * x, side * (x - leg)))
        parts.append(box((left, -y, 0.0), (right, -y + leg, seat - 0.05), frame))
        parts.append(box((left, y - leg, 0.0), (right, y, sz), frame))
    back = (-x + leg, y - 0.03)
    if style.chance(0.5):
        for low, high in ((0.28, 0.42), (0.55, 0.69), (0.82, 1.0)):
            z0, z1 = (seat + share * (sz - seat) for share in (low, high))
            parts.append(box((*back, z0), (x - leg, y - 0.01, z1), frame))
    else:
        z0 = seat + 0.22 * (sz - seat)
        parts.append(rounded_box((*back, z0), (x - leg, y, sz), 0.01, frame))
    return parts


def _office_chair(size: Size, style: Style) -> list[Part]:
    sx, sy, sz = size
    seat = min(0.5, 0.5 * sz)
    cover = style.fabric() if style.chance(0.5) else DARK
    parts = [
        cylinder((0.0, 0.0, 0.07), 0.03, seat - 0.13, CHROME, 8),
        rounded_box(
            (-0.42 * sx, -0.44 * sy, seat - 0.08), (0.42 * sx, 0.4 * sy, seat), 0.04, cover
        ),
        rounded_box(
            (-0.38 * sx, 0.4 * sy - 0.05, seat + 0.08),
            (0.38 * sx, 0.4 * sy + 0.03, sz),
            0.04,
            cover,
        ).turned("x", -6.0, (0.0, 0.4 * sy, seat)),
        box((-0.04, 0.32 * sy, seat - 0.06), (0.04, 0.42 * sy, seat + 0.15), BLACK_STEEL),
    ]
    for angle in np.deg2rad(90.0 + 72.0 * np.arange(5)):
        tip = (0.47 * sx * float(np.cos(angle)), 0.47 * sy * float(np.sin(angle)))
        parts.append(tube((0.0, 0.0, 0.11), (*tip, 0.07), 0.022, BLACK_STEEL, 5))
        parts.append(ellipsoid((*tip, 0.03), (0.03, 0.03, 0.03), DARK, 6))
    for side in (-1.0, 1.0):
        x = side * 0.46 * sx
        left, right = sorted((x - 0.025, x + 0.025))
        arm = seat + 0.2
        parts.append(box((left, -0.22 * sy, arm), (right, 0.22 * sy, arm + 0.03), DARK))
        parts.append(box((left, -0.02, seat - 0.06), (right, 0.02, arm), BLACK_STEEL))
    return parts


def sofa(size: Size, style: Style) -> list[Part]:
    """Arms, a back, and a cushion for every 65 cm of seat."""
    seats = max(1, round((size[0] - 0.3) / 0.65))
    return _upholstered(size, style.fabric(), seats, style)


def _upholstered(size: Size, cover: Surface, seats: int, style: Style | None = None) -> list[Part]:
    """A sofa or armchair; with a style, loose cushions of another colour lie on it."""
    sx, sy, sz = size
    x, y = sx / 2.0, sy / 2.0
    arm = min(0.2, 0.16 * sx + 0.04)
    seat, arm_height, foot = min(0.44, 0.54 * sz), min(0.62, 0.76 * sz), 0.06
    back = min(0.22, 0.25 * sy)
    parts = [
        rounded_box((-x + 0.02, -y + 0.03, foot), (x - 0.02, y, seat - 0.12), 0.02, cover),
        rounded_box((-x + 0.02, y - back, foot), (x - 0.02, y, sz - 0.03), 0.05, cover),
    ]
    for side in (-1.0, 1.0):
        left, right = sorted((side * x, side * (x - arm)))
        parts.append(rounded_box((left, -y, foot), (right, y - 0.02, arm_height), 0.05, cover))
        for depth in (-y + 0.08, y - 0.08):
            foot_x = side * (x - 0.08)
            parts.append(box((foot_x - 0.03, depth - 0.03, 0.0),
                             (foot_x + 0.03, depth + 0.03, foot), DARK))  # fmt: skip
    width = (sx - 2.0 * arm) / seats
    for index in range(seats):
        left = -x + arm + index * width
        low, high = left + 0.006, left + width - 0.006
        parts.append(
            rounded_box((low, -y + 0.01, seat - 0.13), (high, y - back, seat), 0.045, cover)
        )
        parts.append(
            rounded_box((low, y - back - 0.15, seat), (high, y - back + 0.02, sz), 0.06, cover)
            .turned("x", -8.0, (0.0, y - back, seat))
        )  # fmt: skip
    if style is not None:
        accent = style.fabric()
        for side in (-1.0, 1.0):
            middle = (side * (x - arm - 0.22), y - back - 0.2, seat + 0.2)
            pillow = ellipsoid(middle, (0.2, 0.07, 0.2), accent, 8)
            parts.append(pillow.turned("x", -18.0, middle))
    return parts


def stool(size: Size, style: Style) -> list[Part]:
    """A round seat on four splayed legs with a ring."""
    sx, sy, sz = size
    frame = CHROME if style.chance(0.4) else style.wood()
    half = (0.5 * sx, 0.5 * sy)
    profile = [(0.0, sz - 0.06), (0.92, sz - 0.06), (1.0, sz - 0.04), (0.94, sz), (0.0, sz)]
    parts = [lathe(profile, style.fabric(), stretch=half)]
    ring = []
    for sign_x, sign_y in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
        foot = (0.66 * sign_x * half[0], 0.66 * sign_y * half[1], 0.0)
        head = (0.45 * sign_x * half[0], 0.45 * sign_y * half[1], sz - 0.05)
        parts.append(tube(foot, head, 0.02, frame))
        ring.append(tuple(0.7 * a + 0.3 * b for a, b in zip(foot, head, strict=True)))
    for start, end in zip(ring, ring[1:] + ring[:1], strict=True):
        parts.append(
            tube((start[0], start[1], start[2]), (end[0], end[1], end[2]), 0.012, frame, 5)
        )
    return parts


def bench(size: Size, style: Style) -> list[Part]:
    """A plank on two trestles, with a back when it is high enough."""
    sx, sy, sz = size
    frame = style.wood()
    x, y = sx / 2.0, sy / 2.0
    seat = SEAT_HEIGHT_M if sz > 0.65 else sz
    parts = [box((-x, -y, seat - 0.05), (x, y, seat), frame)]
    for side in (-1.0, 1.0):
        left, right = sorted((side * (x - 0.12), side * (x - 0.06)))
        parts.append(box((left, -y + 0.03, 0.0), (right, -y + 0.09, seat - 0.05), frame))
        parts.append(
            box((left, y - 0.06, 0.0), (right, y, sz if sz > seat else seat - 0.05), frame)
        )
        parts.append(box((left, -y + 0.05, 0.12), (right, y - 0.03, 0.17), frame))
    if sz > seat:
        for low, high in ((0.35, 0.58), (0.75, 1.0)):
            z0, z1 = (seat + share * (sz - seat) for share in (low, high))
            parts.append(box((-x, y - 0.04, z0), (x, y - 0.01, z1), frame))
    return parts


def seating(size: Size, style: Style) -> list[Part]:
    """A lounge seat: a tufted bench with a rolled end, or a sofa when it is high."""
    sx, sy, sz = size
    if sz > 0.6:
        return sofa(size, style)
    cover, x, y = style.fabric(), sx / 2.0, sy / 2.0
    parts = [rounded_box((-x, -y, 0.1), (x, y, sz), 0.06, cover)]
    for foot_x in (-x + 0.08, x - 0.08):
        for foot_y in (-y + 0.08, y - 0.08):
            parts.append(cylinder((foot_x, foot_y, 0.0), 0.03, 0.1, DARK, 8))
    return parts


def cushion(size: Size, style: Style) -> list[Part]:
    """A pillow with pinched sides and a seam, plump in the middle; its least extent is through."""
    cover, seam = style.fabric(), fabric((236, 230, 214))
    through = min(range(3), key=lambda axis: size[axis])
    # Cyclic, so that triangles keep their orientation.
    order = [(2 - through) % 3, (3 - through) % 3, (4 - through) % 3]
    levels = np.linspace(-1.0, 1.0, 9)
    u, v = np.meshgrid(levels, levels, indexing="ij")
    plump = np.sqrt((1.0 - u**2) * (1.0 - v**2)) ** 0.8
    pinched = np.stack([u * (1.0 - 0.12 * (1.0 - v**2)), v * (1.0 - 0.12 * (1.0 - u**2))], axis=-1)
    outline = np.concatenate(
        [pinched[:, 0], pinched[-1, 1:], pinched[-2::-1, -1], pinched[0, -2::-1]]
    )

    def placed(points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Points of the cushion lying flat in (-1, 1), in its own frame."""
        return 0.5 * points[..., order] * size + (0.0, 0.0, size[2] / 2.0)

    parts = []
    for side in (1.0, -1.0):
        grid = placed(np.concatenate([pinched, side * plump[..., None]], axis=-1))
        patches = np.stack([grid[:-1, :-1], grid[1:, :-1], grid[1:, 1:], grid[:-1, 1:]], axis=2)
        patches = patches.reshape(-1, 4, 3)
        parts.append(quads(patches if side > 0.0 else patches[:, ::-1], cover))
    rims = [
        placed(np.column_stack([factor * outline, np.full(len(outline), height)]))
        for factor, height in ((0.99, -0.05), (1.02, 0.0), (0.99, 0.05))
    ]
    for lower, upper in pairwise(rims):
        parts.append(quads(np.stack([lower[:-1], lower[1:], upper[1:], upper[:-1]], axis=1), seam))
    return parts
