"""Import of DomestiGraph room graphs: real homes as labelled boxes and their connections.

A file lists the rooms of a home (label, centre and extents, y up, as in Habitat) and which of them
connect. The import makes a plan of it that an agent can walk: boxes become rooms that share walls,
every connection becomes a door or an open passage, and rooms that cannot be reached are left out.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated

import yaml
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from toponav.errors import SceneError
from toponav.geometry.conventions import WORLD_FROM_HABITAT
from toponav.scenes.home_furnishing import furnished
from toponav.scenes.house import COORDINATE_LIMIT_M, House, Level, Room, Stairs
from toponav.scenes.house_io import read_text
from toponav.scenes.plan_home import HomePlanner, StoreyPlan
from toponav.scenes.plan_passages import make_opening
from toponav.scenes.plan_rooms import RoomBox
from toponav.scenes.schema_errors import describe_schema_error
from toponav.scenes.validation import validate_house

OUTDOOR = "outdoor area"
"""The label of balconies, terraces and yards."""

CEILING_RANGE_M = (2.3, 3.2)
"""A room is as high as its box within these bounds: boxes may be half a room or two storeys."""

SLAB_M = 0.2
"""Between a ceiling and the floor above it."""

_ROOM_PREFIX = "room_"

Number = Annotated[float, Field(ge=-COORDINATE_LIMIT_M, le=COORDINATE_LIMIT_M, allow_inf_nan=False)]
Extent = Annotated[float, Field(gt=0.0, le=COORDINATE_LIMIT_M, allow_inf_nan=False)]


class _Vector(BaseModel):
    """A point in metres, y up."""

    x: Number
    y: Number
    z: Number


class _Extents(BaseModel):
    """Lengths in metres, y up."""

    x: Extent
    y: Extent
    z: Extent


class _GraphRoom(BaseModel):
    """A room's label and bounding box."""

    label: str
    centroid: _Vector
    dims: _Extents


class _RoomGraph(BaseModel):
    """A whole file: rooms by name `room_<n>`, connections as pairs of n."""

    model_config = ConfigDict(extra="forbid")

    rooms: Annotated[dict[str, _GraphRoom], Field(min_length=1)]
    connections: list[tuple[int, int]] = Field(default_factory=list)


def import_domestigraph(path: Path | str, seed: int = 0) -> House:
    """Make a house of a DomestiGraph file.

    Args:
        path: A `.yaml` file.
        seed: Varies the furniture; the same file and seed give the same house.

    Raises:
        SceneError: One line with the file and what is wrong in it.
    """
    path = Path(path)
    rooms, connections = _parse(path)
    boxes = [_box(key, room) for key, room in rooms.items()]
    spans = {
        key: (room.centroid.y - room.dims.y / 2.0, room.centroid.y + room.dims.y / 2.0)
        for key, room in rooms.items()
    }
    try:
        planner = HomePlanner(boxes, spans, connections)
    except SceneError as error:
        raise SceneError(f"{path}: {error}") from None
    heights = {key: room.dims.y for key, room in rooms.items()}
    house = furnished(_house(path.stem, planner, heights), seed, bare_types=(OUTDOOR,))
    validate_house(house)
    return house


def _parse(path: Path) -> tuple[dict[int, _GraphRoom], list[tuple[int, int]]]:
    """The rooms by number and the connections, each pair once and in order."""
    try:
        content = yaml.safe_load(read_text(path))
        graph = _RoomGraph.model_validate(content)
    except yaml.YAMLError as error:
        raise SceneError(f"{path}: not YAML: {' '.join(str(error).split())}") from None
    except ValidationError as error:
        raise SceneError(f"{path}: {describe_schema_error(error, _RoomGraph)}") from None
    rooms = {}
    for name, room in graph.rooms.items():
        number = name.removeprefix(_ROOM_PREFIX)
        if not name.startswith(_ROOM_PREFIX) or not (number.isascii() and number.isdigit()):
            raise SceneError(f"{path}: rooms.{name}: rooms are called {_ROOM_PREFIX}1, ...")
        rooms[int(number)] = room
    for index, pair in enumerate(graph.connections):
        for end in pair:
            if end not in rooms:
                raise SceneError(f"{path}: connections[{index}]: no room {_ROOM_PREFIX}{end}")
    pairs = {(min(pair), max(pair)) for pair in graph.connections if pair[0] != pair[1]}
    return rooms, sorted(pairs)


def _box(key: int, room: _GraphRoom) -> RoomBox:
    """The footprint in our frame (x, -z of Habitat's)."""
    center = WORLD_FROM_HABITAT.apply([room.centroid.x, room.centroid.y, room.centroid.z])
    half = abs(WORLD_FROM_HABITAT.rotation @ [room.dims.x, room.dims.y, room.dims.z]) / 2.0
    low, high = center - half, center + half
    return RoomBox(
        key,
        room.label,
        (float(low[0]), float(low[1])),
        (float(high[0]), float(high[1])),
        yields=room.label == OUTDOOR,
    )


def _house(name: str, planner: HomePlanner, heights: Mapping[int, float]) -> House:
    """The house of all rooms that can be reached."""
    storeys = planner.plan.storeys
    reachable = planner.largest_connected_part(unwanted_label=OUTDOOR)
    kept = [index for index, plan in enumerate(storeys) if reachable & set(plan.labels)]
    levels = []
    for index in kept:
        above = storeys[index + 1].floor if index + 1 < len(storeys) else math.inf
        levels.append(_level(storeys[index], heights, reachable, above))
    stairs = [
        Stairs(
            from_level=kept.index(index),
            to_level=kept.index(index + 1),
            start=flight.start,
            end=flight.end,
            width=flight.width,
        )
        for index, flight in planner.plan.flights
        if index in kept and index + 1 in kept
    ]
    return House(name=name, levels=levels, stairs=stairs)


def _level(
    plan: StoreyPlan, heights: Mapping[int, float], reachable: set[int], floor_above: float
) -> Level:
    lowest, highest = CEILING_RANGE_M
    highest = min(highest, floor_above - plan.floor - SLAB_M)
    ceilings = {
        key: round(min(max(heights.get(key, lowest), lowest), highest), 3) for key in plan.labels
    }
    names = {key: f"{_ROOM_PREFIX}{key}" for key in plan.labels}
    return Level(
        floor=plan.floor,
        rooms=[
            Room(id=names[key], type=label, polygon=plan.grid.polygon(key), height=ceilings[key])
            for key, label in plan.labels.items()
            if key in reachable
        ],
        openings=[
            make_opening(
                plan.grid,
                passage.wall,
                passage.kind,
                (names[passage.rooms[0]], names[passage.rooms[1]]),
                min(ceilings[key] for key in passage.rooms),
            )
            for passage in plan.passages
            if passage.rooms[0] in reachable
        ],
    )
