"""Furniture that things are kept in."""

from __future__ import annotations

from toponav.scenes.furniture.primitives import Part, box, cylinder, extruded
from toponav.scenes.furniture.shape import Size
from toponav.scenes.furniture.style import BLACK_STEEL, DARK, Style
from toponav.scenes.textures import Surface, book_spines, paint

BOARD_M = 0.02
"""Thickness of a front or a shelf."""

GAP_M = 0.008
"""Between two fronts."""

HANDLE = BLACK_STEEL
LEATHERS = ((40, 36, 34), (110, 66, 40), (200, 200, 204), (150, 40, 44))


def carcass(size: Size, surface: Surface, plinth: float = 0.06) -> list[Part]:
    """A closed body behind its fronts, on a recessed plinth."""
    x, y, z = size[0] / 2.0, size[1] / 2.0, size[2]
    return [
        box((-x, -y + 2.0 * BOARD_M, plinth), (x, y, z), surface),
        box((-x + 0.02, -y + 0.06, 0.0), (x - 0.02, y, plinth), DARK),
    ]


def drawers(
    low: tuple[float, float], high: tuple[float, float], front_y: float, count: int, front: Surface
) -> list[Part]:
    """Drawer fronts with bar handles, one above the other, in the rectangle (x, z) low..high."""
    parts = []
    step = (high[1] - low[1]) / count
    middle, reach = (low[0] + high[0]) / 2.0, min(0.08, 0.3 * (high[0] - low[0]))
    for index in range(count):
        z0, z1 = low[1] + index * step + GAP_M / 2.0, low[1] + (index + 1) * step - GAP_M / 2.0
        parts.append(
            box((low[0] + GAP_M / 2.0, front_y + BOARD_M, z0),
                (high[0] - GAP_M / 2.0, front_y + 2.0 * BOARD_M, z1), front)
        )  # fmt: skip
        z = (z0 + z1) / 2.0
        parts.append(
            box((middle - reach, front_y, z - 0.008),
                (middle + reach, front_y + BOARD_M, z + 0.008), HANDLE)
        )  # fmt: skip
    return parts


def doors(
    low: tuple[float, float], high: tuple[float, float], front_y: float, count: int, front: Surface
) -> list[Part]:
    """Doors side by side in the rectangle (x, z) low..high; handles meet in pairs."""
    parts = []
    step = (high[0] - low[0]) / count
    for index in range(count):
        x0, x1 = low[0] + index * step + GAP_M / 2.0, low[0] + (index + 1) * step - GAP_M / 2.0
        parts.append(
            box((x0, front_y + BOARD_M, low[1]), (x1, front_y + 2.0 * BOARD_M, high[1]), front)
        )
        handle = x1 - 0.04 if index % 2 == 0 else x0 + 0.04
        middle, reach = (low[1] + high[1]) / 2.0, min(0.1, 0.2 * (high[1] - low[1]))
        parts.append(
            box((handle - 0.008, front_y, middle - reach),
                (handle + 0.008, front_y + BOARD_M, middle + reach), HANDLE)
        )  # fmt: skip
    return parts


def cabinet(size: Size, style: Style) -> list[Part]:
    """Two or more doors; a low one has drawers above them."""
    sx, sy, sz = size
    x, y = sx / 2.0, sy / 2.0
    body, front = style.wood(), style.front()
    count = max(1, round(sx / 0.45))
    split = 0.72 * sz if 0.6 < sz < 1.3 else sz - 0.03
    parts = carcass(size, body)
    parts += doors((-x, 0.08), (x, split), -y, count, front)
    if split < sz - 0.1:
        for index in range(count):
            left = -x + index * sx / count
            parts += drawers((left, split + GAP_M), (left + sx / count, sz - 0.03), -y, 1, front)
    return parts


def chest_of_drawers(size: Size, style: Style) -> list[Part]:
    """Rows of drawers, two columns when it is wide."""
    sx, sy, sz = size
    x, y = sx / 2.0, sy / 2.0
    body, front = style.wood(), style.front()
    rows = max(3, min(6, round(sz / 0.22)))
    columns = 2 if sx > 1.05 else 1
    parts = carcass(size, body)
    parts.append(box((-x, -y + BOARD_M, sz - 0.03), (x, y, sz), body))
    for column in range(columns):
        left = -x + column * sx / columns
        parts += drawers((left, 0.08), (left + sx / columns, sz - 0.04), -y, rows, front)
    return parts


def nightstand(size: Size, style: Style) -> list[Part]:
    """Two drawers on short legs."""
    sx, sy, sz = size
    x, y, leg = sx / 2.0, sy / 2.0, 0.22 * sz
    body, front = style.wood(), style.front()
    parts = [box((-x, -y + 2.0 * BOARD_M, leg), (x, y, sz), body)]
    parts.append(box((-x, -y + BOARD_M, sz - 0.025), (x, y, sz), body))
    parts += drawers((-x, leg), (x, sz - 0.03), -y, 2, front)
    for foot_x in (-x + 0.03, x - 0.03):
        for foot_y in (-y + 0.07, y - 0.03):
            parts.append(box((foot_x - 0.02, foot_y - 0.02, 0.0),
                             (foot_x + 0.02, foot_y + 0.02, leg), body))  # fmt: skip
    return parts


def tv_stand(size: Size, style: Style) -> list[Part]:
    """A low board: an open shelf in the middle between two doors."""
    sx, sy, sz = size
    x, y = sx / 2.0, sy / 2.0
    body, front = style.wood(), style.front()
    side = 0.3 * sx
    shelf = 0.5 * sz
    parts = [
        box((-x, -y, sz - 0.03), (x, y, sz), body),
        box((-x, -y + 0.02, 0.05), (x, y, 0.08), body),
        box((-x, y - BOARD_M, 0.05), (x, y, sz), DARK),
        box((-x + side, -y + 0.04, shelf), (x - side, y, shelf + BOARD_M), body),
        box((-0.12 * sx, -y + 0.06, shelf + BOARD_M), (0.12 * sx, y - 0.05, shelf + 0.08), DARK),
    ]
    for left in (-x, x - side):
        parts.append(box((left, -y + 2.0 * BOARD_M, 0.05), (left + side, y, sz - 0.03), body))
        parts += doors((left, 0.08), (left + side, sz - 0.035), -y, 1, front)
    for foot_x in (-x + 0.08, x - 0.08):
        for foot_y in (-y + 0.08, y - 0.06):
            parts.append(cylinder((foot_x, foot_y, 0.0), 0.02, 0.05, DARK, 6))
    return parts


def wardrobe(size: Size, style: Style) -> list[Part]:
    """Tall doors, one of them a mirror in some, with a cornice."""
    sx, sy, sz = size
    x, y = sx / 2.0, sy / 2.0
    body, front = style.wood(), style.front()
    count = max(2, round(sx / 0.55))
    parts = carcass(size, body, plinth=0.08)
    parts.append(box((-x, -y, sz - 0.06), (x, y, sz), body))
    parts += doors((-x, 0.1), (x, sz - 0.07), -y, count, front)
    if style.chance(0.4):
        left = -x + (count // 2) * sx / count
        parts.append(
            box((left + 0.07, -y + 0.01, 0.25), (left + sx / count - 0.07, -y + 0.025, sz - 0.2),
                paint((186, 204, 212)))
        )  # fmt: skip
    return parts


def bookshelf(size: Size, style: Style) -> list[Part]:
    """Shelves of books of many heights, and a few things between them."""
    sx, sy, sz = size
    x, y = sx / 2.0, sy / 2.0
    surface = style.wood()
    shelves = max(2, round(sz / 0.36))
    step = (sz - BOARD_M) / shelves
    parts = [
        box((-x, -y, 0.0), (-x + BOARD_M, y, sz), surface),
        box((x - BOARD_M, -y, 0.0), (x, y, sz), surface),
        box((-x, y - 0.01, 0.0), (x, y, sz), surface),
    ]
    for index in range(shelves + 1):
        z = index * step
        parts.append(box((-x + BOARD_M, -y, z), (x - BOARD_M, y - 0.01, z + BOARD_M), surface))
        if index < shelves:
            parts += _books((-x + BOARD_M, x - BOARD_M), (-y + 0.03, y - 0.02), z + BOARD_M,
                            step - BOARD_M, style)  # fmt: skip
    return parts


def _books(
    along: tuple[float, float], depth: tuple[float, float], z: float, room: float, style: Style
) -> list[Part]:
    """One shelf of books; some space stays empty."""
    parts = []
    left = along[0] + 0.01
    while left < along[1] - 0.06:
        width = min(float(style.rng.uniform(0.1, 0.3)), along[1] - 0.01 - left)
        if not style.chance(0.18):
            height = room * float(style.rng.uniform(0.62, 0.92))
            spines = book_spines(int(style.rng.integers(4)))
            parts.append(box((left, depth[0], z), (left + width, depth[1], z + height), spines))
        left += width + 0.005
    return parts


def shoe_rack(size: Size, style: Style) -> list[Part]:
    """Open boards between two sides, with pairs of shoes."""
    sx, sy, sz = size
    x, y = sx / 2.0, sy / 2.0
    surface = style.wood()
    levels = max(2, round(sz / 0.25))
    parts = [
        box((-x, -y, 0.0), (-x + BOARD_M, y, sz), surface),
        box((x - BOARD_M, -y, 0.0), (x, y, sz), surface),
        box((-x, -y, sz - BOARD_M), (x, y, sz), surface),
    ]
    for level in range(levels):
        z = 0.04 + level * (sz - 0.06) / levels
        parts.append(box((-x, -y + 0.02, z), (x, y, z + 0.015), surface))
        pair = -x + 0.06
        while pair < x - 0.22:
            leather = paint(
                style.pick(((40, 36, 34), (110, 66, 40), (200, 200, 204), (150, 40, 44)))
            )
            ankle = z + min(0.1, 0.6 * sz / levels)
            outline = [(0.01 - y, z + 0.015), (y - 0.02, z + 0.015), (y - 0.02, ankle),
                       (0.3 * y, ankle), (0.01 - y, z + 0.04)]  # fmt: skip
            for shoe in (pair, pair + 0.1):
                parts.append(extruded(outline, shoe, shoe + 0.085, leather))
            pair += 0.26
    return parts


def moving_box(size: Size, style: Style) -> list[Part]:
    """A cardboard box closed with tape."""
    sx, sy, sz = size
    x, y = sx / 2.0, sy / 2.0
    card = paint(style.pick(((186, 148, 100), (170, 130, 84), (200, 166, 120))))
    tape = paint((222, 202, 160))
    return [
        box((-x, -y, 0.0), (x, y, sz - 0.002), card),
        box((-x, -0.03, sz - 0.002), (x, 0.03, sz), tape),
        box((-0.12 * sx, -y - 0.001, 0.35 * sz), (0.12 * sx, -y, 0.65 * sz), paint((120, 88, 56))),
    ]
