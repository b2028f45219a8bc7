"""Door frames, and the leaves of outer doors."""

from __future__ import annotations

import math

from toponav.scenes.building.passages import Passage
from toponav.scenes.furniture.primitives import Part, box
from toponav.scenes.textures import Surface, brushed_metal, paint, wood

LINING_M = 0.01
"""Thickness of the frame's lining on either side: it narrows a doorway by 2 cm."""

CASING_M = 0.06
"""Width of the frame's boards on the wall."""

PROUD_M = 0.012
"""How far these boards stand out from the wall."""

LEAF_M = 0.045
"""Thickness of a door leaf."""

FRAME = paint((238, 235, 226))
LEAF = wood((120, 74, 44))
HANDLE = brushed_metal((186, 188, 192))


def frame_and_leaf(passage: Passage, floor: float, wall_height: float) -> list[Part]:
    """A door's frame and, when it leads outside, its closed leaf; world frame.

    Args:
        passage: Where the opening is.
        floor: z of the level's floor.
        wall_height: Of the walls that it is in, metres above the floor.
    """
    parts: list[Part] = []
    if passage.has_walls and passage.opening.kind == "door":
        parts += _frame(passage, wall_height)
    if passage.is_outer:
        parts += _leaf(passage)
    degrees = math.degrees(math.atan2(passage.along[1], passage.along[0]))
    base = (float(passage.center[0]), float(passage.center[1]), floor)
    return [part.turned("z", degrees).moved(base) for part in parts]


def _frame(passage: Passage, wall_height: float) -> list[Part]:
    """Lining and casings; x runs along the wall and y across it."""
    half, height = passage.opening.width / 2.0, min(passage.opening.height, wall_height)
    front, back = passage.walls
    inner, outer = half - LINING_M, half - LINING_M + CASING_M
    top = min(height - LINING_M + CASING_M, wall_height)
    parts = []
    for low, high in ((-half, -inner), (inner, half)):
        parts.append(box((low, front, 0.0), (high, back, height), FRAME))
    parts.append(box((-inner, front, height - LINING_M), (inner, back, height), FRAME))
    for y0, y1 in ((front - PROUD_M, front), (back, back + PROUD_M)):
        for low, high in ((-outer, -inner), (inner, outer)):
            parts.append(box((low, y0, 0.0), (high, y1, top), FRAME))
        parts.append(box((-inner, y0, height - LINING_M), (inner, y1, top), FRAME))
    return parts


def _leaf(passage: Passage) -> list[Part]:
    """A closed leaf with two panels and a handle on either side."""
    half, height = passage.opening.width / 2.0, passage.opening.height
    middle = (passage.walls[0] + passage.walls[1]) / 2.0
    front, back = middle - LEAF_M / 2.0, middle + LEAF_M / 2.0
    parts = [box((-half, front, 0.0), (half, back, height), LEAF)]
    panel: Surface = wood((96, 58, 34))
    for y0, y1 in ((front - 0.006, front), (back, back + 0.006)):
        for low, high in ((0.12, 0.45), (0.52, 0.93)):
            parts.append(
                box((-0.7 * half, y0, low * height), (0.7 * half, y1, high * height), panel)
            )
    for y0, y1 in ((front - 0.05, front), (back, back + 0.05)):
        parts.append(box((0.78 * half, y0, 1.0), (0.9 * half, y1, 1.03), HANDLE))
    return parts
