"""The house format `toponav-house/1`: rooms, openings, objects, walls, levels and stairs.

JSON in metres, z up. What the simulator loads, the generator and importers write, and a user
writes by hand; docs/house-format.md describes it. The models here hold each value to its type and
range; `validation.py` holds the values to one another.
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from toponav.config_model import ConfigModel

HOUSE_FORMAT = "toponav-house/1"
"""What `format` says in every house file that this release reads and writes."""

COORDINATE_LIMIT_M = 10_000.0
"""No building is larger; a coordinate beyond this is a unit mistake (millimetres, degrees)."""

Coordinate = Annotated[
    float, Field(ge=-COORDINATE_LIMIT_M, le=COORDINATE_LIMIT_M, allow_inf_nan=False)
]
Length = Annotated[float, Field(gt=0.0, le=COORDINATE_LIMIT_M, allow_inf_nan=False)]
Angle = Annotated[float, Field(allow_inf_nan=False)]
Name = Annotated[str, Field(min_length=1)]

Point2 = tuple[Coordinate, Coordinate]
Point3 = tuple[Coordinate, Coordinate, Coordinate]
Extents = tuple[Length, Length, Length]


class Room(ConfigModel):
    """A simple polygon with a floor and a ceiling."""

    id: Name
    """Unique on its level; what openings name."""
    type: Name = "unknown"
    """Free text: bedroom, kitchen, hallway, ..."""
    polygon: list[Point2]
    """Corners in order, either way round, the first not repeated."""
    height: Length = 2.6
    """From the floor to the ceiling."""
    enclosed: bool = True
    """Whether walls are built along the polygon."""


class Opening(ConfigModel):
    """A passage that cuts every wall within 0.6 m of its centre; one room: an outer door."""

    kind: Literal["door", "open"]
    """A door has a frame; an open passage has none. Both are always passable."""
    rooms: Annotated[list[Name], Field(min_length=1, max_length=2)]
    """The ids of the one or two rooms of this level that it serves."""
    center: Point2
    """On the wall between the rooms."""
    width: Length = 0.9
    """Along the wall."""
    height: Length = 2.05
    """Above the floor."""


class HouseObject(ConfigModel):
    """A piece of furniture; `position` is the centre of its base, `size` precedes the yaw."""

    id: Name
    """Unique on its level."""
    category: Name
    """Free text: chair, tv_monitor, ..."""
    position: Point3
    """Centre of the base."""
    size: Extents
    """Extents along the object's own x, y and z; its back is at +y, its front at -y."""
    yaw: Angle = 0.0
    """Counter-clockwise about z, radians."""
    mesh: Name | None = None
    """A mesh file beside the house file; null: a shape that suits the category."""


class Wall(ConfigModel):
    """A free-standing wall along a polyline."""

    points: Annotated[list[Point2], Field(min_length=2)]
    """The polyline's corners."""
    height: Length = 2.6
    """Above the floor."""
    thickness: Length = 0.12
    """Across the polyline, which lies in its middle."""


class Level(ConfigModel):
    """One storey."""

    floor: Coordinate = 0.0
    """The z of the floor."""
    rooms: list[Room] = Field(default_factory=list)
    """The rooms of the storey."""
    openings: list[Opening] = Field(default_factory=list)
    """Doors and open passages."""
    objects: list[HouseObject] = Field(default_factory=list)
    """The furniture."""
    walls: list[Wall] = Field(default_factory=list)
    """Walls beside those of the rooms."""


class Stairs(ConfigModel):
    """A straight flight from `start` on one level to `end` on another."""

    from_level: Annotated[int, Field(ge=0)]
    """Index of the level at `start`."""
    to_level: Annotated[int, Field(ge=0)]
    """Index of the level at `end`."""
    start: Point2
    """Middle of the first step."""
    end: Point2
    """Middle of the last step."""
    width: Length = 1.0
    """Across the flight."""


class HouseEpisode(ConfigModel):
    """A target and a start pose: foot point on the floor and yaw in radians."""

    target: Name
    """The category to find."""
    start: Point3
    """The agent's foot point on the floor."""
    yaw: Angle = 0.0
    """Its heading, counter-clockwise from +x, radians."""


class House(ConfigModel):
    """A whole house."""

    format: Literal["toponav-house/1"] = "toponav-house/1"
    """The format's name and version."""
    name: Name
    """Unique among the scenes of a run."""
    levels: list[Level]
    """The storeys."""
    stairs: list[Stairs] = Field(default_factory=list)
    """Flights between storeys."""
    episodes: list[HouseEpisode] = Field(default_factory=list)
    """Episodes that the house brings with it."""
