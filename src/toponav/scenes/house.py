"""The house format `toponav-house/1`: rooms, openings, objects, walls, levels and stairs.

JSON in metres, z up. What the simulator loads, the generator and importers write, and a user
writes by hand; docs/house-format.md describes it.
"""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from toponav.config_model import ConfigModel

Point2 = tuple[float, float]
Point3 = tuple[float, float, float]


class Room(ConfigModel):
    """A simple polygon with a floor and a ceiling."""

    id: str
    type: str = "unknown"
    polygon: list[Point2]
    height: float = 2.6
    enclosed: bool = True


class Opening(ConfigModel):
    """A passage that cuts every wall within 0.6 m of its centre; one room: an outer door."""

    kind: Literal["door", "open"]
    rooms: list[str]
    center: Point2
    width: float = 0.9
    height: float = 2.05


class HouseObject(ConfigModel):
    """A piece of furniture; `position` is the centre of its base, `size` precedes the yaw."""

    id: str
    category: str
    position: Point3
    size: Point3
    yaw: float = 0.0
    mesh: str | None = None


class Wall(ConfigModel):
    """A free-standing wall along a polyline."""

    points: list[Point2]
    height: float = 2.6
    thickness: float = 0.12


class Level(ConfigModel):
    """One storey; `floor` is the z of its floor."""

    floor: float = 0.0
    rooms: list[Room] = Field(default_factory=list)
    openings: list[Opening] = Field(default_factory=list)
    objects: list[HouseObject] = Field(default_factory=list)
    walls: list[Wall] = Field(default_factory=list)


class Stairs(ConfigModel):
    """A straight flight from `start` on one level to `end` on another."""

    from_level: int
    to_level: int
    start: Point2
    end: Point2
    width: float = 1.0


class HouseEpisode(ConfigModel):
    """A target and a start pose: foot point on the floor and yaw in radians."""

    target: str
    start: Point3
    yaw: float = 0.0


class House(ConfigModel):
    """A whole house."""

    format: Literal["toponav-house/1"] = "toponav-house/1"
    name: str
    levels: list[Level]
    stairs: list[Stairs] = Field(default_factory=list)
    episodes: list[HouseEpisode] = Field(default_factory=list)
