"""Import of ProcTHOR houses: rooms, doors and furniture of AI2-THOR's procedural homes.

Their frame is left-handed with y up; seen from above, x runs right and z ahead, so that (x, z) is
our (x, y) as it is, and a rotation about y, clockwise from above, is a negative yaw. An asset
faces +z before its rotation. Windows are left out: the house format has none.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated

from pydantic import BaseModel, Field, ValidationError
from shapely import Point, Polygon

from toponav.errors import SceneError
from toponav.scenes.home_furnishing import with_episodes
from toponav.scenes.house import Coordinate, House, HouseObject, Level, Opening, Room
from toponav.scenes.house_io import read_text
from toponav.scenes.procthor_assets import asset_category, counter_sides, typical_size
from toponav.scenes.procthor_counters import Rectangle, counter_arms, fitting_scale
from toponav.scenes.schema_errors import describe_schema_error
from toponav.scenes.validation import validate_house

DEFAULT_CEILING_M = 2.6
"""For a house whose walls have no height."""

MIN_DOOR_WIDTH_M = 0.7
"""Narrower holes are widened, so that the protocol's agent passes."""

_MIN_EXTENT_M = 0.02


class _Vector(BaseModel):
    """Metres, y up; also degrees about each axis."""

    x: Coordinate
    y: Coordinate
    z: Coordinate


class _Room(BaseModel):
    """A floor polygon with a type."""

    id: str
    roomType: str = "unknown"  # noqa: N815 (the file's key)
    floorPolygon: list[_Vector]  # noqa: N815 (the file's key)


class _Wall(BaseModel):
    """A vertical rectangle; the first two corners are on the floor."""

    id: str
    polygon: Annotated[list[_Vector], Field(min_length=3)]


class _Door(BaseModel):
    """A hole in a wall, in metres along it from its first corner and above the floor."""

    id: str
    holePolygon: Annotated[list[_Vector], Field(min_length=2)]  # noqa: N815 (the file's key)
    room0: str
    room1: str
    wall0: str
    openable: bool = False


class _Object(BaseModel):
    """An asset with its centre, degrees, and what lies on or in it."""

    id: str
    assetId: str = ""  # noqa: N815 (the file's key)
    position: _Vector
    rotation: _Vector
    children: list[_Object] = Field(default_factory=list)


class _House(BaseModel):
    """The parts of a ProcTHOR house that the import uses."""

    rooms: Annotated[list[_Room], Field(min_length=1)]
    walls: list[_Wall]
    doors: list[_Door] = Field(default_factory=list)
    objects: list[_Object] = Field(default_factory=list)


def import_procthor(path: Path | str) -> House:
    """Make a house of a ProcTHOR house file.

    Args:
        path: A `.json` file in ProcTHOR's published format.

    Raises:
        SceneError: One line with the file and what is wrong in it.
    """
    path = Path(path)
    try:
        source = _House.model_validate_json(read_text(path))
    except ValidationError as error:
        raise SceneError(f"{path}: {describe_schema_error(error, _House)}") from None
    ceiling = max(
        (corner.y for wall in source.walls for corner in wall.polygon), default=DEFAULT_CEILING_M
    )
    rooms = [_room(room, ceiling) for room in source.rooms]
    polygons = {room.id: Polygon(room.polygon) for room in rooms if len(room.polygon) >= 3}
    try:
        walls = {wall.id: wall for wall in source.walls}
        openings = [_opening(door, walls, polygons) for door in source.doors]
        level = Level(rooms=rooms, openings=openings, objects=_objects(source.objects, polygons))
        house = House(name=path.stem, levels=[level])
        validate_house(house)
    except SceneError as error:
        raise SceneError(f"{path}: {error}") from None
    return with_episodes(house, seed=0)


def _room(room: _Room, ceiling: float) -> Room:
    corners = [(corner.x, corner.z) for corner in room.floorPolygon]
    # Corners in the middle of a straight wall are kept by the source and mean nothing.
    shape = Polygon(corners).simplify(0.0) if len(corners) >= 3 else None
    if isinstance(shape, Polygon) and shape.is_valid and not shape.is_empty:
        corners = [(x, y) for x, y in shape.exterior.coords[:-1]]
    return Room(id=room.id, type=_room_type(room.roomType), polygon=corners, height=ceiling)


def _room_type(name: str) -> str:
    """`LivingRoom` as `living room`."""
    spaced = "".join(f" {letter}" if letter.isupper() else letter for letter in name)
    return spaced.strip().lower() or "unknown"


def _opening(door: _Door, walls: dict[str, _Wall], polygons: dict[str, Polygon]) -> Opening:
    if door.wall0 not in walls:
        raise SceneError(f"doors: {door.id!r} is in wall {door.wall0!r}, which is not in the file")
    first, second = walls[door.wall0].polygon[:2]
    length = math.hypot(second.x - first.x, second.z - first.z)
    if length == 0.0:
        raise SceneError(f"walls: {door.wall0!r} has no length")
    along = [corner.x for corner in door.holePolygon]
    share = (min(along) + max(along)) / 2.0 / length
    rooms = [name for name in dict.fromkeys((door.room0, door.room1)) if name in polygons]
    if not rooms:
        raise SceneError(f"doors: {door.id!r} names no room of the file")
    return Opening(
        # An asset that does not open is a bare frame between two rooms.
        kind="door" if door.openable or len(rooms) == 1 else "open",
        rooms=rooms,
        center=(
            first.x + share * (second.x - first.x),
            first.z + share * (second.z - first.z),
        ),
        width=max(max(along) - min(along), MIN_DOOR_WIDTH_M),
        height=max(corner.y for corner in door.holePolygon),
    )


def _objects(sources: list[_Object], polygons: dict[str, Polygon]) -> list[HouseObject]:
    """All objects, those on others included, none of them sticking through a wall."""
    result: list[HouseObject] = []
    for source in sources:
        center = (source.position.x, source.position.z)
        room = next((p for p in polygons.values() if p.covers(Point(center))), None)
        counter = counter_sides(source.assetId)
        if counter is not None and room is not None:
            result += _counter(source, counter, room)
        else:
            result.append(_object(source, room, None))
        top = _top(source)
        result += [_object(child, None, top) for child in source.children]
        result += _objects([c for child in source.children for c in child.children], polygons)
    return result


def _top(source: _Object) -> float:
    """Height of the upper side of what stands on the floor: its centre is half way up."""
    return 2.0 * source.position.y


def _object(source: _Object, room: Polygon | None, support: float | None) -> HouseObject:
    """An object of typical width and depth, as high as its centre tells.

    Args:
        source: The object.
        room: Where its footprint must fit; None: wherever it is.
        support: z of the upper side of what it lies on; None: the floor or a wall.
    """
    width, depth, height = typical_size(source.id)
    base = source.position.y - height / 2.0
    rest = 0.0 if support is None else support
    # Half as high or low again as is typical still stands; anything else hangs, or lies inside.
    if abs(base - rest) <= height / 2.0 and source.position.y > rest:
        base, height = rest, max(2.0 * (source.position.y - rest), _MIN_EXTENT_M)
    center = (source.position.x, source.position.z)
    yaw = _yaw(source)
    footprint = Rectangle(center, (width, depth), yaw)
    scale = 1.0 if room is None else fitting_scale(footprint, room)
    return HouseObject(
        id=source.id,
        category=asset_category(source.id),
        position=(*center, max(base, 0.0)),
        size=(width * scale, depth * scale, height),
        yaw=yaw,
    )


def _yaw(source: _Object) -> float:
    """Their rotation is clockwise and turns the front from +z, our +y; ours starts at -y."""
    return math.remainder(math.pi - math.radians(source.rotation.y), 2.0 * math.pi)


def _counter(
    source: _Object, counter: tuple[str, float, float], room: Polygon
) -> list[HouseObject]:
    shape, *sides = counter
    center = (source.position.x, source.position.z)
    bounds = Rectangle(center, (sides[0], sides[1]), _yaw(source))
    items = [(child.position.x, child.position.z) for child in source.children]
    return [
        HouseObject(
            id=source.id if index == 0 else f"{source.id}#{index}",
            category=asset_category(source.id),
            position=(*arm.center, 0.0),
            size=(*arm.sides, _top(source)),
            yaw=math.remainder(arm.yaw, 2.0 * math.pi),
        )
        for index, arm in enumerate(counter_arms(shape, bounds, room, items))
    ]
