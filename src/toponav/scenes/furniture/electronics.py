"""Screens."""

from __future__ import annotations

from toponav.scenes.furniture.primitives import Part, box, picture, rounded_box
from toponav.scenes.furniture.shape import Size
from toponav.scenes.furniture.style import BLACK_STEEL, CHROME, DARK, Style
from toponav.scenes.textures import desktop_image, paint, television_image

MONITOR_WIDTH_M = 0.72
"""A narrower screen is a computer's."""

WALL_MOUNT_DEPTH_M = 0.1
"""A thinner screen hangs on a wall and has no stand."""

BEZEL_M = 0.018


def tv_monitor(size: Size, style: Style) -> list[Part]:
    """A television that is on, or a computer's monitor; with a stand unless it is thin."""
    sx, sy, sz = size
    x, y = sx / 2.0, sy / 2.0
    is_monitor = sx < MONITOR_WIDTH_M
    image = desktop_image if is_monitor else television_image
    on_stand = sy >= WALL_MOUNT_DEPTH_M
    low = (0.2 if is_monitor else 0.1) * sz if on_stand else 0.0
    thin = min(0.05, 0.7 * sy)
    front = -min(thin, 0.3 * sy) if on_stand else -y
    parts = [
        rounded_box((-x, front, low), (x, front + thin, sz), 0.006, DARK),
        picture(
            (0.0, front - 0.001, (low + sz) / 2.0),
            sx - 2.0 * BEZEL_M,
            sz - low - 2.0 * BEZEL_M,
            image(style.texture_seed),
        ),
    ]
    if not on_stand:
        parts.append(box((-0.3 * x, front + thin, 0.3 * sz), (0.3 * x, y, 0.7 * sz), BLACK_STEEL))
    elif is_monitor:
        parts.append(box((-0.4 * x, -y, 0.0), (0.4 * x, y, 0.015), BLACK_STEEL))
        parts.append(box((-0.04, front + thin, 0.0), (0.04, front + thin + 0.03, 0.6 * sz), CHROME))
    else:
        for side in (-0.6 * x, 0.6 * x):
            parts.append(box((side - 0.02, -y, 0.0), (side + 0.02, y, 0.02), BLACK_STEEL))
            parts.append(
                box((side - 0.02, front, 0.0), (side + 0.02, front + thin, low), BLACK_STEEL)
            )
    return parts


def laptop(size: Size, style: Style) -> list[Part]:
    """An open laptop."""
    sx, sy, sz = size
    x, y = sx / 2.0, sy / 2.0
    shell = paint(style.pick(((176, 178, 182), (70, 72, 78))))
    hinge = 0.55 * y
    screen = (0.0, hinge, (sz + 0.02) / 2.0)
    lid = [
        box((-x, hinge, 0.015), (x, hinge + 0.012, sz), shell),
        picture((screen[0], screen[1] - 0.001, screen[2]), sx - 0.03, sz - 0.05,
                desktop_image(style.texture_seed)),
    ]  # fmt: skip
    return [
        box((-x, -y, 0.0), (x, hinge, 0.018), shell),
        box((-0.85 * x, -0.3 * y, 0.018), (0.85 * x, 0.4 * y, 0.02), DARK),
        box((-0.25 * x, -0.85 * y, 0.018), (0.25 * x, -0.45 * y, 0.0195), BLACK_STEEL),
        *(part.turned("x", -12.0, (0.0, hinge, 0.015)) for part in lid),
    ]
