"""What floors, walls and ceilings of a room are made of, by its type and a seed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from toponav.categories import canonical
from toponav.scenes.textures import (
    Rgb,
    Surface,
    carpet,
    concrete,
    marble,
    paint,
    planks,
    plaster,
    tiles,
)

WALL_PAINTS: tuple[Rgb, ...] = (
    (236, 230, 216),
    (214, 224, 226),
    (228, 214, 190),
    (206, 220, 202),
    (232, 216, 210),
    (200, 212, 228),
    (240, 234, 206),
    (222, 220, 226),
)
"""Light interior paints."""

BOARD_TONES: tuple[Rgb, ...] = ((168, 122, 76), (196, 156, 108), (128, 86, 54), (150, 130, 106))
CARPET_TONES: tuple[Rgb, ...] = ((150, 142, 130), (124, 132, 148), (168, 150, 124), (112, 124, 112))
TILE_TONES: tuple[Rgb, ...] = ((214, 208, 196), (186, 190, 194), (170, 152, 132), (226, 226, 224))
BATH_TONES: tuple[Rgb, ...] = ((206, 226, 232), (232, 236, 236), (214, 230, 212), (236, 222, 206))

CEILING = paint((244, 243, 239))
"""Every ceiling."""

OUTSIDE = plaster((202, 192, 174))
"""Walls that face no room."""


@dataclass(frozen=True, eq=False)
class RoomFinish:
    """The surfaces of one room."""

    floor: Surface
    wall: Surface
    ceiling: Surface = CEILING


def room_finish(room_type: str, seed: int) -> RoomFinish:
    """The finish of a room; equal arguments give equal rooms.

    Args:
        room_type: Free text; of `kitchen/living room` the first part that is known counts.
        seed: Chooses among what suits the type.
    """
    rng = np.random.default_rng(seed)
    for part in room_type.split("/"):
        finish = _FINISHES.get(canonical(part))
        if finish is not None:
            return finish(rng)
    return _living(rng)


def _pick(rng: np.random.Generator, colors: tuple[Rgb, ...]) -> Rgb:
    return colors[int(rng.integers(len(colors)))]


def _painted(rng: np.random.Generator) -> Surface:
    return plaster(_pick(rng, WALL_PAINTS), int(rng.integers(3)))


def _boards(rng: np.random.Generator) -> Surface:
    return planks(_pick(rng, BOARD_TONES), int(rng.integers(3)))


def _living(rng: np.random.Generator) -> RoomFinish:
    return RoomFinish(_boards(rng), _painted(rng))


def _bedroom(rng: np.random.Generator) -> RoomFinish:
    soft = carpet(_pick(rng, CARPET_TONES), int(rng.integers(3)))
    return RoomFinish(soft if rng.random() < 0.5 else _boards(rng), _painted(rng))


def _bathroom(rng: np.random.Generator) -> RoomFinish:
    tone = _pick(rng, BATH_TONES)
    return RoomFinish(
        floor=tiles(_pick(rng, TILE_TONES), 0.2, int(rng.integers(3))),
        wall=tiles(tone, 0.15, int(rng.integers(3))),
    )


def _kitchen(rng: np.random.Generator) -> RoomFinish:
    chequered = (120, 124, 130) if rng.random() < 0.35 else None
    floor = tiles(_pick(rng, TILE_TONES), 0.3, int(rng.integers(3)), chequered)
    return RoomFinish(floor, _painted(rng))


def _hallway(rng: np.random.Generator) -> RoomFinish:
    stone = marble((206, 200, 190), int(rng.integers(3)))
    return RoomFinish(stone if rng.random() < 0.4 else _boards(rng), _painted(rng))


def _utility(rng: np.random.Generator) -> RoomFinish:
    return RoomFinish(tiles(_pick(rng, TILE_TONES), 0.25, int(rng.integers(3))), _painted(rng))


def _garage(rng: np.random.Generator) -> RoomFinish:
    return RoomFinish(concrete((150, 150, 148), 0), plaster((206, 204, 198), int(rng.integers(3))))


_FINISHES: dict[str, Callable[[np.random.Generator], RoomFinish]] = {
    "bathroom": _bathroom,
    "bedroom": _bedroom,
    "closet": _bedroom,
    "corridor": _hallway,
    "dining_room": _living,
    "entryway": _hallway,
    "garage": _garage,
    "gym": _garage,
    "hallway": _hallway,
    "kids_room": _bedroom,
    "kitchen": _kitchen,
    "laundry": _utility,
    "laundry_room": _utility,
    "living_room": _living,
    "office": _bedroom,
    "storage": _garage,
    "toilet": _bathroom,
    "utility": _utility,
    "utility_room": _utility,
    "washroom": _bathroom,
    "workshop": _garage,
}
