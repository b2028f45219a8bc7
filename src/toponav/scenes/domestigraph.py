"""Import of DomestiGraph room graphs: real homes as labelled boxes and their connections.

A file lists the rooms of a home (label, centre and extents, y up, as in Habitat) and which of them
connect. The import makes a plan of it that an agent can walk: boxes become rooms that share walls,
every connection becomes a door or an open passage, and rooms that cannot be reached are left out.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated

import networkx as nx
import yaml
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from toponav.errors import SceneError
from toponav.geometry.conventions import WORLD_FROM_HABITAT
from toponav.scenes.house import COORDINATE_LIMIT_M, House, Level, Room
from toponav.scenes.house_io import read_text
from toponav.scenes.plan_passages import PassageBuilder, make_opening
from toponav.scenes.plan_rooms import RoomBox, plan_rooms
from toponav.scenes.plan_storeys import Storey, find_storeys
from toponav.scenes.schema_errors import describe_schema_error
from toponav.scenes.validation import validate_house

OUTDOOR = "outdoor area"
"""The label of balconies, terraces and yards."""

CEILING_RANGE_M = (2.3, 3.2)
"""A room is as high as its box within these bounds: boxes may be half a room or two storeys."""

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
    try:
        levels = _plan_levels(rooms, connections)
    except SceneError as error:
        raise SceneError(f"{path}: {error}") from None
    house = House(name=path.stem, levels=levels)
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


def _plan_levels(
    rooms: Mapping[int, _GraphRoom], connections: list[tuple[int, int]]
) -> list[Level]:
    """The storeys of the home, reduced to the largest part that is connected."""
    spans = {
        key: (room.centroid.y - room.dims.y / 2.0, room.centroid.y + room.dims.y / 2.0)
        for key, room in rooms.items()
    }
    storeys = find_storeys(spans)
    plans = []
    first_free_key = max(rooms) + 1
    for storey in storeys:
        plan = _plan_storey(storey, rooms, connections, first_free_key)
        first_free_key = max((first_free_key, *(key + 1 for key in plan.labels)))
        plans.append(plan)
    reachable = _largest_connected_part(plans)
    levels = [
        _level(storey, plan, rooms, reachable) for storey, plan in zip(storeys, plans, strict=True)
    ]
    return [level for level in levels if level.rooms]


def _plan_storey(
    storey: Storey,
    rooms: Mapping[int, _GraphRoom],
    connections: list[tuple[int, int]],
    first_free_key: int,
) -> PassageBuilder:
    grid, absorbers = plan_rooms([_box(key, rooms[key]) for key in storey.rooms])
    labels = {key: rooms[key].label for key in storey.rooms if grid.mask(key).any()}
    builder = PassageBuilder(grid, labels, first_free_key)
    pairs = [(absorbers.get(a, a), absorbers.get(b, b)) for a, b in connections]
    builder.connect([(a, b) for a, b in pairs if a in labels and b in labels and a != b])
    return builder


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


def _largest_connected_part(plans: list[PassageBuilder]) -> set[int]:
    """Keys of the rooms of the connected part with the largest floor, outdoor areas aside."""
    graph: nx.Graph[int] = nx.Graph()
    for plan in plans:
        for key, label in plan.labels.items():
            indoor = 0 if label == OUTDOOR else int(plan.grid.mask(key).sum())
            graph.add_node(key, area=indoor)
        graph.add_edges_from(pair for pair, _, _ in plan.openings())
    parts = sorted(nx.connected_components(graph), key=min)
    return set(max(parts, key=lambda part: sum(graph.nodes[key]["area"] for key in part)))


def _level(
    storey: Storey,
    plan: PassageBuilder,
    rooms: Mapping[int, _GraphRoom],
    reachable: set[int],
) -> Level:
    lowest, highest = CEILING_RANGE_M
    heights = {key: min(max(room.dims.y, lowest), highest) for key, room in rooms.items()}
    house_rooms = [
        Room(
            id=f"{_ROOM_PREFIX}{key}",
            type=label,
            polygon=plan.grid.polygon(key),
            height=round(heights.get(key, lowest), 3),
        )
        for key, label in plan.labels.items()
        if key in reachable
    ]
    openings = [
        make_opening(
            plan.grid,
            wall,
            kind,
            (f"{_ROOM_PREFIX}{pair[0]}", f"{_ROOM_PREFIX}{pair[1]}"),
            min(heights.get(key, lowest) for key in pair),
        )
        for pair, wall, kind in plan.openings()
        if pair[0] in reachable
    ]
    return Level(floor=storey.floor, rooms=house_rooms, openings=openings)
