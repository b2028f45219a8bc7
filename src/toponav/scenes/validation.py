"""What must hold between the values of a house: simple polygons, known names, openings on walls.

Each rule raises a `SceneError` of one line that gives the JSON path of the culprit, such as
`levels[0].rooms[2].polygon: edges 1 and 4 cross`. Indices count from 0; edge i runs from point i to
point i + 1.
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from shapely import LineString, Point, Polygon

from toponav.errors import SceneError
from toponav.scenes.house import House, HouseObject, Level, Opening, Point2, Room, Stairs, Wall

OPENING_REACH_M = 0.6
"""An opening cuts the walls within this distance of its centre (docs/house-format.md)."""

MIN_ROOM_AREA_M2 = 0.01
"""A smaller polygon is degenerate: no agent fits into 10 cm x 10 cm."""

MIN_EDGE_M = 1e-6
"""Points nearer to each other than this coincide."""


def validate_house(house: House, base_dir: Path | None = None) -> None:
    """Check what the schema alone cannot.

    Args:
        house: The house; its values already have the right types and ranges.
        base_dir: Where the objects' mesh files lie; None leaves them unchecked.

    Raises:
        SceneError: One line with the JSON path and the problem, without the file's name.
    """
    if not any(level.rooms for level in house.levels):
        raise SceneError("levels: the house has no room; add one to levels[0].rooms")
    for index, level in enumerate(house.levels):
        _check_level(level, f"levels[{index}]", base_dir)
    for index, stairs in enumerate(house.stairs):
        _check_stairs(stairs, f"stairs[{index}]", house.levels)


def _check_level(level: Level, path: str, base_dir: Path | None) -> None:
    _check_unique((room.id for room in level.rooms), f"{path}.rooms")
    _check_unique((item.id for item in level.objects), f"{path}.objects")
    for index, room in enumerate(level.rooms):
        _check_polygon(room, f"{path}.rooms[{index}].polygon")
    rooms = {room.id: Polygon(room.polygon) for room in level.rooms}
    for index, opening in enumerate(level.openings):
        _check_opening(opening, f"{path}.openings[{index}]", rooms)
    for index, wall in enumerate(level.walls):
        _check_wall(wall, f"{path}.walls[{index}].points")
    if base_dir is not None:
        for index, item in enumerate(level.objects):
            _check_mesh(item, f"{path}.objects[{index}].mesh", base_dir)


def _check_unique(ids: Iterable[str], path: str) -> None:
    first_index: dict[str, int] = {}
    for index, name in enumerate(ids):
        if name in first_index:
            raise SceneError(
                f"{path}[{index}].id: {name!r} is also the id of {path}[{first_index[name]}]; "
                "ids are unique on a level"
            )
        first_index[name] = index


def _check_polygon(room: Room, path: str) -> None:
    points = room.polygon
    if len(points) < 3:
        raise SceneError(f"{path}: a polygon needs at least 3 points, not {len(points)}")
    for i, point in enumerate(points):
        j = (i + 1) % len(points)
        if _coincide(point, points[j]):
            hint = " (the last point closes onto the first by itself)" if j == 0 else ""
            raise SceneError(f"{path}: points {i} and {j} coincide; drop one{hint}")
    crossing = _crossing_edges(points)
    if crossing is not None:
        raise SceneError(f"{path}: edges {crossing[0]} and {crossing[1]} cross")
    area = Polygon(points).area
    if area < MIN_ROOM_AREA_M2:
        raise SceneError(f"{path}: encloses only {area:.2g} m2; coordinates are in metres")


def _coincide(a: Point2, b: Point2) -> bool:
    return abs(a[0] - b[0]) < MIN_EDGE_M and abs(a[1] - b[1]) < MIN_EDGE_M


def _crossing_edges(points: list[Point2]) -> tuple[int, int] | None:
    """The first two edges of a closed polygon that meet elsewhere than at their common corner."""
    if Polygon(points).is_valid:
        return None
    count = len(points)
    edges = [LineString((points[i], points[(i + 1) % count])) for i in range(count)]
    for i in range(count):
        for j in range(i + 1, count):
            meeting = edges[i].intersection(edges[j])
            share_corner = j == i + 1 or (i == 0 and j == count - 1)
            if not meeting.is_empty and not (share_corner and meeting.geom_type == "Point"):
                return i, j
    return None


def _check_opening(opening: Opening, path: str, rooms: dict[str, Polygon]) -> None:
    if len(set(opening.rooms)) < len(opening.rooms):
        raise SceneError(f"{path}.rooms: an opening joins two different rooms or leads outside")
    center = Point(opening.center)
    for index, name in enumerate(opening.rooms):
        if name not in rooms:
            known = ", ".join(rooms) or "none"
            raise SceneError(
                f"{path}.rooms[{index}]: no room {name!r} on this level; rooms: {known}"
            )
        distance = rooms[name].exterior.distance(center)
        if distance > OPENING_REACH_M:
            raise SceneError(
                f"{path}.center: {distance:.2f} m from the walls of room {name!r}; "
                f"an opening lies within {OPENING_REACH_M} m of the walls that it cuts"
            )


def _check_wall(wall: Wall, path: str) -> None:
    for i in range(len(wall.points) - 1):
        if _coincide(wall.points[i], wall.points[i + 1]):
            raise SceneError(f"{path}: points {i} and {i + 1} coincide; drop one")


def _check_mesh(item: HouseObject, path: str, base_dir: Path) -> None:
    if item.mesh is not None and not (base_dir / item.mesh).is_file():
        raise SceneError(f"{path}: no file {base_dir / item.mesh}")


def _check_stairs(stairs: Stairs, path: str, levels: list[Level]) -> None:
    for key, index in (("from_level", stairs.from_level), ("to_level", stairs.to_level)):
        if index >= len(levels):
            raise SceneError(
                f"{path}.{key}: no level {index}; the house has {len(levels)}, counted from 0"
            )
    if levels[stairs.from_level].floor == levels[stairs.to_level].floor:
        raise SceneError(f"{path}.to_level: stairs join two levels of different floor heights")
    if _coincide(stairs.start, stairs.end):
        raise SceneError(f"{path}.end: the same point as start; a flight has a length")
