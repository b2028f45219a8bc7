"""Furnishing a room by its type: against walls, in groups, and always with a way through."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic import Field
from shapely.geometry import Polygon

from toponav.config_model import ConfigModel
from toponav.scenes.furniture_sizes import Extents, draw_size
from toponav.scenes.house import HouseObject, Opening, Room
from toponav.scenes.room_furniture import Place, Wish, wishes_for
from toponav.scenes.room_space import RoomSpace, StairsFootprint, rectangle

FRONT_CLEARANCE_M = 0.45
"""Floor in front of a thing at a wall that nothing else may stand on."""
HANG_GAP_M = 0.065
"""How far the middle of a wall is from what hangs on it: half its thickness, and a little."""
TRIES = 40
TUCKED = 0.45
"""Share of a chair that may be under its table."""
ARMCHAIR: Extents = (0.78, 0.8, 0.85)


class FurnishConfig(ConfigModel):
    """How much is put into rooms."""

    clutter: float = Field(default=0.5, ge=0.0, le=1.0)
    """0 leaves all but the essential out, 1 doubles the chance of everything else."""


class _Pose(NamedTuple):
    """Where a thing stands: base centre in the plane, yaw."""

    center: NDArray[np.float64]
    yaw: float

    def beside(self, dx: float, dy: float, turn: float = 0.0) -> _Pose:
        """A place in this thing's frame."""
        c, s = math.cos(self.yaw), math.sin(self.yaw)
        offset = np.array([c * dx - s * dy, s * dx + c * dy])
        return _Pose(self.center + offset, self.yaw + turn)


def furnish_room(
    room: Room,
    openings: Sequence[Opening],
    floor: float,
    rng: np.random.Generator,
    config: FurnishConfig | None = None,
    stairs: Sequence[StairsFootprint] = (),
) -> list[HouseObject]:
    """Furniture for a room, by its type.

    Every opening stays joined to every other and to every thing by floor on which the protocol's
    agent can walk; what would break that is left out.

    Args:
        room: Its polygon and type; a type of several, such as "kitchen/living room", gets both.
        openings: Those of this room.
        floor: Height of the floor, metres.
        rng: Draws sizes, places and what there is.
        config: How much there is.
        stairs: Flights of this level, which stay clear and are walked round.

    Returns:
        Objects with ids that start with the room's.
    """
    furnisher = _Furnisher(room, openings, floor, rng, stairs)
    clutter = (config or FurnishConfig()).clutter
    for wish in wishes_for(room.type):
        chance = wish.chance if wish.chance >= 1.0 else min(1.0, 2.0 * clutter * wish.chance)
        if rng.random() < chance:
            furnisher.grant(wish)
    return furnisher.objects


class _Furnisher:
    """Furnishes one room."""

    def __init__(
        self,
        room: Room,
        openings: Sequence[Opening],
        floor: float,
        rng: np.random.Generator,
        stairs: Sequence[StairsFootprint],
    ) -> None:
        self.objects: list[HouseObject] = []
        self._hung: list[Polygon] = []
        self._room = room
        self._floor = floor
        self._rng = rng
        self._space = RoomSpace(Polygon(room.polygon), openings, stairs)

    def grant(self, wish: Wish) -> None:
        """Put a thing and what belongs to it into the room, if there is a place for it."""
        size = draw_size(wish.category, self._rng)
        if wish.group == "armchair":
            size = ARMCHAIR
        if wish.place is Place.HUNG:
            self._hang(wish, size)
            return
        for pose in self._candidates(wish.place, size):
            front = None
            if wish.place is Place.WALL:
                ahead = pose.beside(0.0, -(size[1] + FRONT_CLEARANCE_M) / 2)
                front = rectangle(ahead.center, pose.yaw, size[0], FRONT_CLEARANCE_M)
            footprint = rectangle(pose.center, pose.yaw, size[0], size[1], grow=0.01)
            if self._space.fits(footprint, front) and self._stand(wish.category, size, pose):
                self._add_group(wish.group, size, pose)
                return

    def _candidates(self, place: Place, size: Extents) -> list[_Pose]:
        """Places to try, in random order."""
        if place is Place.CENTER:
            return self._central_places()
        poses = []
        walls = [wall for wall in self._space.walls() if wall.length >= size[0] + 0.1]
        if not walls:
            return []
        weights = np.array([wall.length for wall in walls])
        for _ in range(TRIES):
            wall = walls[int(self._rng.choice(len(walls), p=weights / weights.sum()))]
            low, high = size[0] / 2 + 0.1, wall.length - size[0] / 2 - 0.1
            if place is Place.CORNER:
                at = low if self._rng.random() < 0.5 else max(low, high)
            else:
                at = float(self._rng.uniform(low, max(low, high)))
            center = wall.start + at * wall.along + (size[1] / 2 + 0.1) * wall.inward
            poses.append(_Pose(center, wall.yaw))
        return poses

    def _central_places(self) -> list[_Pose]:
        """Poses that stray ever farther from the middle, along the longer side."""
        low_x, low_y, high_x, high_y = self._space.polygon.bounds
        middle = np.array([(low_x + high_x) / 2, (low_y + high_y) / 2])
        spread = np.array([high_x - low_x, high_y - low_y]) / 4
        along = 0.0 if high_x - low_x >= high_y - low_y else math.pi / 2
        offsets = self._rng.uniform(-1.0, 1.0, (TRIES, 2)) * np.linspace(0.0, 1.0, TRIES)[:, None]
        return [_Pose(middle + offset * spread, along) for offset in offsets]

    def _stand(self, category: str, size: Extents, pose: _Pose) -> bool:
        """Stand a thing on the floor; takes it away again when it blocks the way."""
        self._space.occupy(rectangle(pose.center, pose.yaw, size[0], size[1]), size[2])
        if not self._space.passable():
            self._space.vacate(1)
            return False
        self._enter(category, size, pose, 0.0)
        return True

    def _enter(self, category: str, size: Extents, pose: _Pose, height: float) -> None:
        x, y = (round(float(v), 3) for v in pose.center)
        self.objects.append(
            HouseObject(
                id=f"{self._room.id}_{category}_{len(self.objects)}",
                category=category,
                position=(x, y, round(self._floor + height, 3)),
                size=size,
                yaw=round(math.remainder(pose.yaw, math.tau), 4),
            )
        )

    def _hang(self, wish: Wish, size: Extents) -> None:
        """Hang a thing where no door and nothing tall is."""
        walls = [wall for wall in self._space.walls() if wall.length >= size[0] + 0.2]
        for _ in range(TRIES if walls else 0):
            wall = walls[int(self._rng.integers(len(walls)))]
            low, high = size[0] / 2 + 0.1, wall.length - size[0] / 2 - 0.1
            at = float(self._rng.uniform(low, max(low, high)))
            center = wall.start + at * wall.along + (HANG_GAP_M + size[1] / 2) * wall.inward
            footprint = rectangle(center, wall.yaw, size[0], size[1] + 0.1)
            tall = [f for f, top in self._space.footprints if top > wish.height_m]
            if any(map(footprint.intersects, (self._space.doors, *tall, *self._hung))):
                continue
            self._hung.append(footprint)
            self._enter(wish.category, size, _Pose(center, wall.yaw), wish.height_m)
            return

    def _add_group(self, group: str, size: Extents, pose: _Pose) -> None:
        """What belongs to a thing that has just been placed."""
        match group:
            case "nightstands":
                stand = draw_size("nightstand", self._rng)
                aside = (size[0] + stand[0]) / 2 + 0.04
                back = (size[1] - stand[1]) / 2
                for side in (-1, 1):
                    self._try("nightstand", stand, pose.beside(side * aside, back))
            case "desk":
                self._seat("chair", pose.beside(0.0, -(size[1] / 2 + 0.2), math.pi))
                gadget = "tv_monitor" if self._rng.random() < 0.4 else "laptop"
                self._top(gadget, size, pose, limit_m=0.55)
            case "tv":
                self._top("tv_monitor", size, pose, limit_m=size[0] - 0.1)
            case "lounge":
                table = draw_size("coffee_table", self._rng)
                ahead = pose.beside(0.0, -(size[1] + table[1]) / 2 - 0.45)
                self._try("coffee_table", table, ahead)
                cushion = draw_size("cushion", self._rng)
                if self._rng.random() < 0.7:
                    spot = pose.beside(-size[0] / 4, 0.05)
                    self._enter("cushion", cushion, spot, round(0.53 * size[2], 3))
            case "dining":
                self._dining_chairs(size, pose)
            case "counter":
                self._top("microwave", size, pose, limit_m=0.5)

    def _dining_chairs(self, size: Extents, pose: _Pose) -> None:
        chair = draw_size("chair", self._rng)
        count = max(1, int(size[0] // 0.65))
        for side, turn in ((-1, math.pi), (1, 0.0)):
            for k in range(count):
                x = (k - (count - 1) / 2) * size[0] / count
                y = side * (size[1] / 2 + chair[1] / 2 - 0.12)
                self._try("chair", chair, pose.beside(x, y, turn), tucked=TUCKED)

    def _seat(self, category: str, pose: _Pose) -> None:
        self._try(category, draw_size(category, self._rng), pose, tucked=TUCKED)

    def _top(self, category: str, size: Extents, pose: _Pose, limit_m: float) -> None:
        """Stand a thing on top of another, shrunk to fit."""
        own = draw_size(category, self._rng)
        scale = min(1.0, limit_m / own[0])
        shrunk = (round(own[0] * scale, 3), min(own[1], round(size[1] - 0.02, 3)),
                  round(own[2] * scale, 3))  # fmt: skip
        room = max(0.0, (size[0] - shrunk[0]) / 2 - 0.03)
        self._enter(category, shrunk, pose.beside(float(self._rng.uniform(-room, room)), 0.0),
                    size[2])  # fmt: skip

    def _try(self, category: str, size: Extents, pose: _Pose, tucked: float = 0.0) -> None:
        """Stand a companion where it belongs, if it fits; a chair may reach under its table."""
        footprint = rectangle(pose.center, pose.yaw, size[0], size[1])
        if self._space.fits(footprint, tucked=tucked):
            self._stand(category, size, pose)
