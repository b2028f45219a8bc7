"""The walls, floors, ceilings and doors of one level."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from shapely import Geometry, Polygon, difference, union_all

from toponav.scenes.building.doors import frame_and_leaf
from toponav.scenes.building.flights import RAIL, RAIL_HEIGHT_M, Stairwell
from toponav.scenes.building.passages import find_passage
from toponav.scenes.building.room_map import NO_ROOM, RoomMap
from toponav.scenes.building.soup import TriangleSoup
from toponav.scenes.building.surfaces import (
    PLAN_GRID_M,
    boundary_edges,
    level_faces,
    level_uv,
    polygons,
    upright_faces,
    upright_uv,
)
from toponav.scenes.building.walls import WallBand, wall_bands
from toponav.scenes.finishes import OUTSIDE, RoomFinish
from toponav.scenes.house import Level
from toponav.scenes.textures import Surface


class LevelStructure:
    """Builds one level into a soup of triangles."""

    def __init__(
        self, soup: TriangleSoup, level: Level, name: str, finishes: Sequence[RoomFinish]
    ) -> None:
        """Prepare a level.

        Args:
            soup: Where the triangles go.
            level: What to build; a valid one.
            name: Of the level, for the instances that belong to no room.
            finishes: One for each of its rooms.
        """
        self._soup = soup
        self._level = level
        self._name = name
        self._finishes = finishes
        self._polygons = [Polygon(room.polygon) for room in level.rooms]
        by_id = {
            room.id: polygon for room, polygon in zip(level.rooms, self._polygons, strict=True)
        }
        enclosed = {room.id: room.enclosed for room in level.rooms}
        self._passages = [find_passage(opening, by_id, enclosed) for opening in level.openings]
        self._room_map = RoomMap(self._polygons)
        self._instances: dict[tuple[int, str], int] = {}

    def build(self, floor_wells: Sequence[Stairwell], ceiling_wells: Sequence[Stairwell]) -> None:
        """Add everything.

        Args:
            floor_wells: Stairwells in this level's floor.
            ceiling_wells: Stairwells in the floor above, of which the ceiling is the underside.
        """
        bands = wall_bands(self._level, self._passages)
        self._build_floors(union_all([well.hole for well in floor_wells]))
        self._build_ceilings(union_all([well.hole for well in ceiling_wells]))
        self._build_walls(bands)
        self._build_doors()
        walls = bands[0].footprint if bands else Polygon()
        self._build_wells(floor_wells, difference(union_all(self._polygons), walls))

    def _build_floors(self, holes: Geometry) -> None:
        """Each room's floor, and the thresholds between rooms."""
        covered: Geometry = holes
        for index, polygon in enumerate(self._polygons):
            self._add_level(index, "floor", difference(polygon, covered, grid_size=PLAN_GRID_M))
            covered = union_all([covered, polygon])
        rooms = [room.id for room in self._level.rooms]
        for passage in self._passages:
            threshold = difference(passage.threshold, covered, grid_size=PLAN_GRID_M)
            self._add_level(rooms.index(passage.opening.rooms[0]), "floor", threshold)
            covered = union_all([covered, passage.threshold])

    def _build_ceilings(self, holes: Geometry) -> None:
        covered: Geometry = holes
        for index, polygon in enumerate(self._polygons):
            self._add_level(index, "ceiling", difference(polygon, covered, grid_size=PLAN_GRID_M))
            covered = union_all([covered, polygon])

    def _build_walls(self, bands: Sequence[WallBand]) -> None:
        for index, band in enumerate(bands):
            below = bands[index - 1].footprint if index else band.footprint
            above = bands[index + 1].footprint if index + 1 < len(bands) else Polygon()
            low, high = self._level.floor + band.low, self._level.floor + band.high
            edges, rooms = self._room_map.faces(boundary_edges(band.footprint))
            for room in np.unique(rooms):
                faces = upright_faces(edges[rooms == room], low, high)
                self._add_upright(int(room), faces)
            overhang = difference(band.footprint, below, grid_size=PLAN_GRID_M)
            self._add_caps(overhang, low, upward=False)
            self._add_caps(
                difference(band.footprint, above, grid_size=PLAN_GRID_M), high, upward=True
            )

    def _build_doors(self) -> None:
        heights = {room.id: room.height for room in self._level.rooms}
        for index, passage in enumerate(self._passages):
            wall_height = max(heights[name] for name in passage.opening.rooms)
            parts = frame_and_leaf(passage, self._level.floor, wall_height)
            if not parts:
                continue
            instance = self._soup.instance(f"{self._name}/door {index}", "door")
            for part in parts:
                material = self._soup.material(part.surface.material)
                self._soup.add(instance, part.corners, part.uv, [material] * len(part.corners))

    def _build_wells(self, wells: Sequence[Stairwell], standing_room: Geometry) -> None:
        """The sides of stairwells through the slab, and the rails around them."""
        for well in wells:
            instance = self._soup.instance(f"{self._name}/stairwell", "wall")
            sides = boundary_edges(well.hole)[:, ::-1]
            self._add_surface(instance, upright_faces(sides, well.underside, well.floor), RAIL)
            rail = well.rail(standing_room)
            top = well.floor + RAIL_HEIGHT_M
            self._add_surface(instance, upright_faces(boundary_edges(rail), well.floor, top), RAIL)
            self._add_surface(instance, level_faces(rail, top, upward=True), RAIL)

    def _add_level(self, room: int, category: str, shape: Geometry) -> None:
        """A floor or a ceiling of a room."""
        finish = self._finishes[room]
        is_floor = category == "floor"
        surface = finish.floor if is_floor else finish.ceiling
        height = 0.0 if is_floor else self._level.rooms[room].height
        corners = level_faces(shape, self._level.floor + height, upward=is_floor)
        self._add_surface(self._instance(room, category), corners, surface)

    def _add_caps(self, shape: Geometry, z: float, upward: bool) -> None:
        """Tops of walls, and undersides of lintels."""
        for polygon in polygons(shape):
            inside = polygon.representative_point()
            room = int(self._room_map.rooms_at(np.array([[inside.x, inside.y]]))[0])
            self._add_upright(room, level_faces(polygon, z, upward))

    def _add_upright(self, room: int, corners: NDArray[np.float64]) -> None:
        surface = OUTSIDE if room == NO_ROOM else self._finishes[room].wall
        self._add_surface(self._instance(room, "wall"), corners, surface)

    def _add_surface(self, instance: int, corners: NDArray[np.float64], surface: Surface) -> None:
        """Faces with texture coordinates in world metres."""
        flat = np.ptp(corners[..., 2], axis=1) == 0.0
        uv = np.where(
            flat[:, None, None],
            level_uv(corners, surface.repeat_m),
            upright_uv(corners, surface.repeat_m, self._level.floor),
        )
        material = self._soup.material(surface.material)
        self._soup.add(instance, corners, uv, [material] * len(corners))

    def _instance(self, room: int, category: str) -> int:
        """The id of a room's wall, floor or ceiling, entered on first use."""
        key = (room, category)
        if key not in self._instances:
            place = f"{self._name}/outside" if room == NO_ROOM else self._level.rooms[room].id
            self._instances[key] = self._soup.instance(f"{place}/{category}", category)
        return self._instances[key]
