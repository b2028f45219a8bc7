"""Walls, floors, ceilings and doors of one level."""

from __future__ import annotations

import math
import zlib
from itertools import pairwise

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import LineString, Point, Polygon
from shapely.geometry.base import BaseGeometry
from shapely.ops import unary_union

from toponav.scenes.finishes import OUTSIDE, RoomFinish, room_finish
from toponav.scenes.house import Level, Opening, Room
from toponav.scenes.mesh_builder import MeshBuilder
from toponav.scenes.solids import Triangles, extrude, flat, polygons_of
from toponav.scenes.textures import wood

WALL_THICKNESS_M = 0.12
OPENING_REACH_M = 0.6
"""An opening cuts all walls within this distance of its centre (docs/house-format.md)."""
DOOR_LEAF_M = 0.05
"""Thickness of the leaf that closes an outer door, in front of its wall on both sides."""
FACING_PROBE_M = 0.1
"""A wall's face belongs to the room that lies this far in front of it."""


DOOR = wood((150, 110, 78))


class LevelMesher:
    """Meshes one level of a house into a builder."""

    def __init__(self, builder: MeshBuilder, level: Level, index: int) -> None:
        """Prepare the polygons of the level."""
        self._builder = builder
        self._level = level
        self._index = index
        self._polygons = [Polygon(room.polygon) for room in level.rooms]
        self._by_id = dict(zip((room.id for room in level.rooms), self._polygons, strict=True))
        inner = [opening for opening in level.openings if len(opening.rooms) == 2]
        self._cuts = [(opening, self._cut(opening)) for opening in inner]

    def add(self, floor_holes: list[Polygon], ceiling_holes: list[Polygon]) -> None:
        """Add everything but furniture; holes are where stairs come up or leave."""
        self._add_walls()
        self._add_floors(unary_union(floor_holes))
        self._add_ceilings(unary_union(ceiling_holes))
        for opening in self._level.openings:
            if len(opening.rooms) == 1:
                self._add_closed_door(opening)

    def _add_walls(self) -> None:
        """Room walls joined into one footprint so that shared ones do not overlap, and lintels."""
        level, z = self._level, self._level.floor
        rooms = list(zip(level.rooms, self._polygons, strict=True))
        enclosed = [
            (polygon.exterior.buffer(WALL_THICKNESS_M / 2, cap_style="flat", join_style="mitre"))
            for room, polygon in rooms
            if room.enclosed
        ]
        height = max((room.height for room in level.rooms), default=2.6)
        self._add_cut_wall(unary_union(enclosed), z, height, f"walls_{self._index}")
        for number, wall in enumerate(level.walls):
            shape = LineString(wall.points).buffer(
                wall.thickness / 2, cap_style="flat", join_style="mitre"
            )
            self._add_cut_wall(shape, z, wall.height, f"wall_{self._index}_{number}")

    def _add_cut_wall(self, footprint: BaseGeometry, z: float, height: float, name: str) -> None:
        instance = self._builder.instance(name, "wall")
        openings = unary_union([cut for _, cut in self._cuts])
        for polygon in polygons_of(footprint.difference(openings)):
            self._add_painted(extrude(polygon, z, z + height), instance)
        for opening, cut in self._cuts:
            if opening.height < height:
                for polygon in polygons_of(footprint.intersection(cut)):
                    self._add_painted(extrude(polygon, z + opening.height, z + height), instance)

    def _add_painted(self, triangles: Triangles, instance: int) -> None:
        """Add wall surfaces, each in the paint of the room that it faces."""
        vertices, faces = triangles
        corners = vertices[faces]
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[:, :2]
        normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-12)
        probe = corners.mean(axis=1)[:, :2] + FACING_PROBE_M * normal
        left = np.ones(len(faces), np.bool_)
        for room, polygon in zip(self._level.rooms, self._polygons, strict=True):
            mine = left & shapely.contains_xy(polygon, probe[:, 0], probe[:, 1])
            left &= ~mine
            self._builder.add_surface(vertices, faces[mine], self._finish(room).wall, instance)
        self._builder.add_surface(vertices, faces[left], OUTSIDE, instance)

    def _finish(self, room: Room) -> RoomFinish:
        return room_finish(room.type, zlib.crc32(room.id.encode()))

    def _add_floors(self, hole: BaseGeometry) -> None:
        """The floor of each room, and of the gaps that openings bridge."""
        for room, polygon in zip(self._level.rooms, self._polygons, strict=True):
            instance = self._builder.instance(f"floor_{room.id}", "floor")
            for part in polygons_of(polygon.difference(hole)):
                triangles = flat(part, self._level.floor, up=True)
                self._builder.add_surface(*triangles, self._finish(room).floor, instance)
        rooms = unary_union(self._polygons)
        for number, (opening, cut) in enumerate(self._cuts):
            instance = self._builder.instance(f"threshold_{self._index}_{number}", "floor")
            room = next(room for room in self._level.rooms if room.id == opening.rooms[0])
            gap = cut.difference(rooms).difference(hole)
            for part in polygons_of(gap):
                triangles = flat(part, self._level.floor, up=True)
                self._builder.add_surface(*triangles, self._finish(room).floor, instance)

    def _add_ceilings(self, hole: BaseGeometry) -> None:
        for room, polygon in zip(self._level.rooms, self._polygons, strict=True):
            instance = self._builder.instance(f"ceiling_{room.id}", "ceiling")
            z = self._level.floor + room.height
            for part in polygons_of(polygon.difference(hole)):
                triangles = flat(part, z, up=False)
                self._builder.add_surface(*triangles, self._finish(room).ceiling, instance)

    def _add_closed_door(self, opening: Opening) -> None:
        """An outer door: a leaf on both faces of a wall that stays whole."""
        along = self._wall_direction(opening)
        depth = WALL_THICKNESS_M / 2 + DOOR_LEAF_M
        leaf = _rectangle(opening.center, along, opening.width, depth)
        number = self._level.openings.index(opening)
        instance = self._builder.instance(f"door_{self._index}_{number}", "door")
        z = self._level.floor
        self._builder.add_surface(*extrude(leaf, z, z + opening.height), DOOR, instance)

    def _cut(self, opening: Opening) -> Polygon:
        """The footprint that an opening removes from walls."""
        along = self._wall_direction(opening)
        return _rectangle(opening.center, along, opening.width, OPENING_REACH_M)

    def _wall_direction(self, opening: Opening) -> NDArray[np.float64]:
        """Unit vector along the wall segment nearest to the opening's centre."""
        center = Point(opening.center)
        best: tuple[float, NDArray[np.float64]] | None = None
        for room_id in opening.rooms:
            ring = np.asarray(self._by_id[room_id].exterior.coords)
            for a, b in pairwise(ring):
                distance = LineString([a, b]).distance(center)
                length = math.dist(a, b)
                if length > 0.0 and (best is None or distance < best[0] - 1e-9):
                    best = (distance, (b - a) / length)
        assert best is not None  # validation gives every room at least three corners
        return best[1]


def _rectangle(
    center: tuple[float, float], along: NDArray[np.float64], length: float, half_depth: float
) -> Polygon:
    across = np.array([-along[1], along[0]])
    corners = [
        np.asarray(center) + s * 0.5 * length * along + t * half_depth * across
        for s, t in ((-1, -1), (1, -1), (1, 1), (-1, 1))
    ]
    return Polygon(corners)
