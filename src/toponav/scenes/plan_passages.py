"""Doors and corridors: the second half of importing a room graph.

Rooms that share enough wall get an opening in it. Rooms apart get a corridor through free ground:
a gap of a wall's thickness goes to one of the two rooms, a longer corridor becomes a hallway.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import networkx as nx
import numpy as np

from toponav.scenes.house import Opening
from toponav.scenes.plan_grid import CELL_M, FREE, CellMask, PlanGrid, simple_room
from toponav.scenes.plan_rooms import NARROWEST_CELLS
from toponav.scenes.plan_routes import SharedWall, corridor, longest_shared_wall

HALLWAY = "hallway"
"""The type of a corridor that becomes a room of its own."""

OPEN_PLAN_TYPES = frozenset({HALLWAY, "living room", "kitchen", "dining room"})
"""Two rooms of these types join by an open passage, all others by a door."""

DOOR_WIDTH_M = 0.9
OPEN_WIDTH_M = 1.4
OPENING_HEIGHT_M = 2.05
"""Common sizes of dwellings."""

WALL_ALLOWANCE_CELLS = 2
"""A shared wall is this much longer than its opening: half a wall's thickness on either side."""

MAX_MERGED_CELLS = 150
"""A gap of up to 1.5 m2 joins one of its rooms."""

MAX_CORRIDOR_CELLS = 500
"""A longer corridor than 5 m2 would run around rooms through which the way leads."""

_MAX_DETOURS = 3
"""A passage through other rooms passes at most so many."""


def room_types(label: str) -> list[str]:
    """`kitchen/living room` holds two rooms in one: the parts, the first one leading."""
    return [part.strip() for part in label.split("/") if part.strip()] or ["unknown"]


class PassageBuilder:
    """Gives every connection of one level a passage that an agent can walk through.

    Attributes:
        grid: The plan; corridors are entered into it.
        labels: Type of each room by key, with the corridors that have been added.
    """

    def __init__(self, grid: PlanGrid, labels: Mapping[int, str], first_free_key: int) -> None:
        """Start from the rooms alone.

        Args:
            grid: The plan, changed in place.
            labels: Type of each room by key.
            first_free_key: Corridors that become rooms are numbered from here.
        """
        self.grid = grid
        self.labels = dict(labels)
        self._next_key = first_free_key
        self._joined: dict[tuple[int, int], None] = {}

    def connect(self, connections: Sequence[tuple[int, int]]) -> None:
        """Join each pair of rooms: those that share a wall, then those near each other, the rest.

        A connection that would need a long corridor is left to the doors of other rooms, as long
        as these lead from the one room to the other.
        """
        apart = [pair for pair in connections if not self._connect_adjacent(*pair)]
        far = [pair for pair in apart if not self._connect_near(*pair)]
        for a, b in far:
            if not self._has_route(a, b):
                self._connect_far(a, b, _MAX_DETOURS)

    def openings(self) -> list[tuple[tuple[int, int], SharedWall, str]]:
        """Each joined pair with the wall that it shares and the kind of its opening."""
        result = []
        for a, b in self._joined:
            wall = longest_shared_wall(self.grid, a, b)
            if wall is not None:
                result.append(((a, b), wall, self._kind(a, b)))
        return result

    def _connect_adjacent(self, a: int, b: int) -> bool:
        if longest_shared_wall(self.grid, a, b) is None:
            return False
        self._join(a, b)
        return True

    def _connect_near(self, a: int, b: int) -> bool:
        cells = corridor(self.grid, a, b, self._free())
        if cells is None or cells.sum() > MAX_CORRIDOR_CELLS:
            return False
        return self._build(a, b, cells)

    def _connect_far(self, a: int, b: int, detours: int) -> None:
        """Lead through a room in between; a long corridor is the last resort."""
        if self._connect_adjacent(a, b) or self._connect_near(a, b):
            return
        through = self._room_between(a, b) if detours else None
        if through is not None:
            self._connect_far(a, through, detours - 1)
            self._connect_far(through, b, detours - 1)
        if not self._has_route(a, b):
            cells = corridor(self.grid, a, b, self._free())
            if cells is not None:
                self._build(a, b, cells)

    def _has_route(self, a: int, b: int) -> bool:
        graph: nx.Graph[int] = nx.Graph(list(self._joined))
        return a in graph and b in graph and nx.has_path(graph, a, b)

    def _free(self) -> CellMask:
        free: CellMask = self.grid.owner == FREE
        return free

    def _room_between(self, a: int, b: int) -> int | None:
        """The room that the best corridor would cross most, when it must cross rooms."""
        anywhere = np.zeros(self.grid.owner.shape, np.bool_)
        anywhere[1:-1, 1:-1] = True
        cells = corridor(self.grid, a, b, anywhere)
        owners = self.grid.owner[cells] if cells is not None else np.zeros(0, np.int32)
        owners = owners[owners != FREE]
        return int(np.bincount(owners).argmax()) if owners.size else None

    def _build(self, a: int, b: int, cells: CellMask) -> bool:
        """Turn corridor cells into part of a room, or into a hallway, if that is walkable."""
        # A hallway takes a small gap if there is one, else the larger room does.
        order = sorted((a, b), key=lambda key: (not self._is_hallway(key), -self._size(key)))
        is_gap = int(cells.sum()) <= MAX_MERGED_CELLS
        if not is_gap and self._add_hallway(cells, a, b):
            return True
        if any(self._extend(key, cells, a, b) for key in order):
            return True
        return is_gap and self._add_hallway(cells, a, b)

    def _extend(self, key: int, cells: CellMask, a: int, b: int) -> bool:
        """Give the cells to one of the two rooms."""
        before = self.grid.owner.copy()
        merged = self.grid.mask(key) | cells
        if self._is_simple(merged):
            self.grid.owner[cells] = key
            if self._connect_adjacent(a, b):
                return True
        self.grid.owner[:] = before
        return False

    def _add_hallway(self, cells: CellMask, a: int, b: int) -> bool:
        """Make the cells a room between the two."""
        key = self._next_key
        if not self._is_simple(cells):
            return False
        self.grid.owner[cells] = key
        if any(longest_shared_wall(self.grid, key, room) is None for room in (a, b)):
            self.grid.owner[cells] = FREE
            return False
        self._next_key += 1
        self.labels[key] = HALLWAY
        self._join(a, key)
        self._join(key, b)
        return True

    def _is_simple(self, cells: CellMask) -> bool:
        others = (self.grid.owner != FREE) & ~cells
        return np.array_equal(simple_room(cells, others, NARROWEST_CELLS), cells)

    def _join(self, a: int, b: int) -> None:
        self._joined[min(a, b), max(a, b)] = None

    def _is_hallway(self, key: int) -> bool:
        return HALLWAY in room_types(self.labels[key])

    def _size(self, key: int) -> int:
        return int(self.grid.mask(key).sum())

    def _kind(self, a: int, b: int) -> str:
        open_plan = all(OPEN_PLAN_TYPES & set(room_types(self.labels[key])) for key in (a, b))
        return "open" if open_plan else "door"


def make_opening(
    grid: PlanGrid, wall: SharedWall, kind: str, rooms: tuple[str, str], ceiling: float
) -> Opening:
    """An opening in the middle of a shared wall.

    Args:
        grid: The plan.
        wall: Where the two rooms meet.
        kind: "door" or "open".
        rooms: The ids of the two rooms.
        ceiling: Height of the lower of the two rooms, metres.
    """
    widest = (wall.length - WALL_ALLOWANCE_CELLS) * CELL_M
    wanted = DOOR_WIDTH_M if kind == "door" else OPEN_WIDTH_M
    return Opening(
        kind="door" if kind == "door" else "open",
        rooms=list(rooms),
        center=grid.point(*wall.middle),
        width=round(min(wanted, widest), 3),
        height=round(min(OPENING_HEIGHT_M, ceiling), 3),
    )
