"""Plans of homes: a public zone, a hallway out of it, and private rooms on both of its sides.

Rooms are rectangles that share their walls. The public zone (living room, kitchen, dining room)
takes the whole depth at the west end; the hallway leaves it towards the east. An upper level stands
on the walls of the lower one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from toponav.scenes.house import Opening, Room

SOUTH_DEPTH_M = (3.0, 3.9)
NORTH_DEPTH_M = (3.2, 4.2)
HALL_WIDTH_M = (1.25, 1.6)
PUBLIC_WIDTH_M = (4.6, 6.6)
DOOR_WIDTH_M = (0.82, 0.95)
OPEN_WIDTH_M = (1.5, 2.2)
OUTER_DOOR_WIDTH_M = 0.95
CORNER_GAP_M = 0.25
"""Least wall between an opening and a corner."""
FILL_LIMIT_M = 1.6
"""The last room of the shorter row grows by up to this to meet the end of the longer one."""
LEAST_WIDTH_M = 1.5
"""Of a room behind a door: the widest door, both of its corner gaps, and a little."""
SHIFT_M = 0.4
"""How far the wall between two rooms south of the large one may lie from the middle."""

ROOM_WIDTH_M = {
    "bedroom": (3.1, 4.3), "kids room": (2.8, 3.6), "bathroom": (2.2, 2.9), "office": (2.6, 3.6),
    "laundry": (1.9, 2.5), "closet": (1.7, 2.2), "gym": (3.2, 4.2), "garage": (5.2, 6.0),
    "library": (2.8, 3.6), "utility room": (1.9, 2.5),
}  # fmt: skip
"""Width along the hallway of the rooms on it."""

RowRoom = tuple[str, float, float]
"""Type, west end and east end of a room on the hallway."""


@dataclass(frozen=True)
class Frame:
    """The walls that all levels of a house share, metres.

    Attributes:
        public_x: East end of the public zone.
        hall: (y0, y1) of the hallway.
        depth: North end of everything.
    """

    public_x: float
    hall: tuple[float, float]
    depth: float


@dataclass(frozen=True)
class FloorPlan:
    """Rooms and openings of one level.

    Attributes:
        frame: The shared walls.
        rooms: The largest public room first.
        openings: Between rooms, and the outer door.
        row_ends: East ends of the south and the north row.
    """

    frame: Frame
    rooms: tuple[Room, ...]
    openings: tuple[Opening, ...]
    row_ends: tuple[float, float]

    @property
    def has_hallway(self) -> bool:
        """Whether a hallway leaves the public zone, with rooms on it."""
        return max(self.row_ends) > self.frame.public_x


def draw_frame(rng: np.random.Generator, scale: float, least_public_x: float) -> Frame:
    """Draw the walls that all levels share."""
    south = scale * rng.uniform(*SOUTH_DEPTH_M)
    hall = south + rng.uniform(*HALL_WIDTH_M)
    depth = hall + scale * rng.uniform(*NORTH_DEPTH_M)
    public = max(least_public_x, 2 * LEAST_WIDTH_M, scale * rng.uniform(*PUBLIC_WIDTH_M))
    return Frame(round(public, 2), (round(south, 2), round(hall, 2)), round(depth, 2))


class LevelDrawer:
    """Draws one level inside a frame."""

    def __init__(self, rng: np.random.Generator, scale: float, frame: Frame, level: int) -> None:
        """`scale` stretches the rooms; `level` is part of their ids."""
        self._rng = rng
        self._scale = scale
        self._frame = frame
        self._level = level
        self._rooms: list[Room] = []
        self._openings: list[Opening] = []

    def draw(
        self,
        public: Sequence[str],
        private: Sequence[str],
        limits: tuple[float, float] | None = None,
    ) -> FloorPlan:
        """A level with these rooms.

        Args:
            public: Types of the public zone: the large room, then those on its south side.
            private: Types of the rooms on the hallway.
            limits: East ends that the rows must not pass: those of the level below.
        """
        frame = self._frame
        large = self._draw_public(public)
        rows = self._fill_rows(private, limits)
        if any(rows):
            self._draw_hallway(large, rows)
        if self._level == 0:
            self._openings.append(
                Opening(
                    kind="door",
                    rooms=[large.id],
                    center=(0.0, round((frame.hall[0] + frame.depth) / 2, 2)),
                    width=OUTER_DOOR_WIDTH_M,
                )
            )
        south, north = (max((x1 for *_, x1 in row), default=frame.public_x) for row in rows)
        return FloorPlan(frame, tuple(self._rooms), tuple(self._openings), (south, north))

    def _draw_hallway(self, large: Room, rows: tuple[list[RowRoom], list[RowRoom]]) -> None:
        """The hallway, open to the large room, and the rooms south and north of it."""
        frame = self._frame
        end = max(x1 for row in rows for *_, x1 in row)
        hall = self._room("hallway", frame.public_x, frame.hall[0], end, frame.hall[1])
        wide = frame.hall[1] - frame.hall[0] - 2 * CORNER_GAP_M
        self._open("open", large, hall, (frame.public_x, sum(frame.hall) / 2), round(wide, 2))
        for row, (low, high), wall in (
            (rows[0], (0.0, frame.hall[0]), frame.hall[0]),
            (rows[1], (frame.hall[1], frame.depth), frame.hall[1]),
        ):
            for kind, x0, x1 in row:
                room = self._room(kind, x0, low, x1, high)
                self._door(room, hall, wall, (x0, x1))

    def _draw_public(self, types: Sequence[str]) -> Room:
        """The large room, with the others side by side along its south."""
        frame = self._frame
        strip = frame.hall[0] if len(types) > 1 else 0.0
        large = self._room(types[0], 0.0, strip, frame.public_x, frame.depth)
        others = types[1:]
        edges = np.round(np.linspace(0.0, frame.public_x, len(others) + 1), 2)
        if len(others) == 2:
            shift = min(self._scale * SHIFT_M, frame.public_x / 2 - LEAST_WIDTH_M)
            edges[1] = round(float(edges[1] + self._rng.uniform(-shift, shift)), 2)
        for kind, x0, x1 in zip(others, edges[:-1], edges[1:], strict=True):
            room = self._room(kind, float(x0), 0.0, float(x1), strip)
            if kind in ROOM_WIDTH_M:
                self._door(room, large, strip, (float(x0), float(x1)))
            else:
                width = min(self._rng.uniform(*OPEN_WIDTH_M), x1 - x0 - 2 * CORNER_GAP_M)
                center = (round(float(x0 + x1) / 2, 2), strip)
                self._open("open", room, large, center, round(float(width), 2))
        return large

    def _fill_rows(
        self, private: Sequence[str], limits: tuple[float, float] | None
    ) -> tuple[list[RowRoom], list[RowRoom]]:
        """Add each room to the shorter row; from west to east."""
        rows: tuple[list[RowRoom], list[RowRoom]] = ([], [])
        ends = [self._frame.public_x, self._frame.public_x]
        allowed = limits or (np.inf, np.inf)
        for kind in private:
            drawn = self._scale * float(self._rng.uniform(*ROOM_WIDTH_M[kind]))
            width = max(LEAST_WIDTH_M, round(drawn, 2))
            for side in sorted((0, 1), key=lambda k: (ends[k], k)):
                if ends[side] + width <= allowed[side] + 1e-6:
                    x1 = round(ends[side] + width, 2)
                    rows[side].append((kind, ends[side], x1))
                    ends[side] = x1
                    break
        short = int(ends[1] < ends[0])
        if rows[short] and ends[1 - short] - ends[short] < FILL_LIMIT_M and limits is None:
            kind, x0, _ = rows[short][-1]
            rows[short][-1] = (kind, x0, ends[1 - short])
        return rows

    def _room(self, kind: str, x0: float, y0: float, x1: float, y1: float) -> Room:
        corners = [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]
        room = Room(id=f"r{self._level}_{len(self._rooms)}", type=kind, polygon=corners)
        self._rooms.append(room)
        return room

    def _door(self, a: Room, b: Room, y: float, span: tuple[float, float]) -> None:
        """A door somewhere in the wall at height y of the plan between two rooms."""
        width = round(float(self._rng.uniform(*DOOR_WIDTH_M)), 2)
        margin = width / 2 + CORNER_GAP_M
        x = float(self._rng.uniform(span[0] + margin, span[1] - margin))
        self._open("door", a, b, (round(x, 2), y), width)

    def _open(self, kind: str, a: Room, b: Room, center: tuple[float, float], width: float) -> None:
        opening = Opening.model_validate(
            {"kind": kind, "rooms": [a.id, b.id], "center": center, "width": width}
        )
        self._openings.append(opening)
