"""The walls of a level, as solids in plan, band by band of height."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from shapely import (
    Geometry,
    LinearRing,
    LineString,
    Polygon,
    buffer,
    difference,
    intersection,
    union_all,
)

from toponav.scenes.building.passages import WALL_THICKNESS_M, Passage
from toponav.scenes.building.surfaces import PLAN_GRID_M
from toponav.scenes.house import Level, Wall

_MITRE_LIMIT = 2.0
"""Corners sharper than 60 degrees are bevelled."""


@dataclass(frozen=True, eq=False)
class WallBand:
    """What the walls cover between two heights above the floor.

    Attributes:
        low: Metres above the floor.
        high: Metres above the floor.
        footprint: In plan.
    """

    low: float
    high: float
    footprint: Geometry


@dataclass(frozen=True, eq=False)
class _Piece:
    """Something that stands on the floor up to a height: a wall, or what is cut out of one."""

    footprint: Geometry
    height: float


def wall_bands(level: Level, passages: Sequence[Passage]) -> list[WallBand]:
    """The walls of a level from the floor up; within a band nothing changes with height."""
    walls = [
        _Piece(_around(Polygon(room.polygon).exterior), room.height)
        for room in level.rooms
        if room.enclosed
    ]
    walls += [_Piece(_along(wall), wall.height) for wall in level.walls]
    walls += [
        _jambs(passage, level) for passage in passages if passage.has_walls and not passage.is_outer
    ]
    edges = _room_edges(level)
    cuts = [
        _Piece(passage.cut(passage.crossing_walls(edges)), passage.opening.height)
        for passage in passages
    ]
    heights = sorted({0.0, *(round(piece.height, 3) for piece in walls + cuts)})
    top = max((round(piece.height, 3) for piece in walls), default=0.0)
    bands = []
    for low, high in pairwise(heights):
        if high > top:
            break
        solid = union_all(_reaching(walls, high), grid_size=PLAN_GRID_M)
        holes = union_all(_reaching(cuts, high), grid_size=PLAN_GRID_M)
        bands.append(WallBand(low, high, difference(solid, holes, grid_size=PLAN_GRID_M)))
    return bands


def _reaching(pieces: Sequence[_Piece], height: float) -> list[Geometry]:
    """The footprints of the pieces that are at least so high, to the millimetre."""
    return [piece.footprint for piece in pieces if round(piece.height, 3) >= height]


def _around(ring: LinearRing) -> Geometry:
    return buffer(ring, WALL_THICKNESS_M / 2.0, join_style="mitre", mitre_limit=_MITRE_LIMIT)


def _along(wall: Wall) -> Geometry:
    return buffer(
        LineString(wall.points),
        wall.thickness / 2.0,
        cap_style="flat",
        join_style="mitre",
        mitre_limit=_MITRE_LIMIT,
    )


def _jambs(passage: Passage, level: Level) -> _Piece:
    """What closes the void between the walls of two rooms, beside and above a passage."""
    served = [room for room in level.rooms if room.id in passage.opening.rooms]
    block = passage.rectangle(passage.opening.width + 2.0 * WALL_THICKNESS_M, passage.walls)
    facing = [intersection(block, Polygon(room.polygon)) for room in served]
    between = buffer(union_all(facing).convex_hull, WALL_THICKNESS_M / 2.0, join_style="mitre")
    rooms = union_all([Polygon(room.polygon) for room in level.rooms])
    footprint = difference(intersection(between, block), rooms)
    return _Piece(footprint, max(room.height for room in served))


def _room_edges(level: Level) -> NDArray[np.float64]:
    """(E, 2, 2) edges of all rooms that have walls."""
    edges = [np.zeros((0, 2, 2))]
    for room in level.rooms:
        if room.enclosed:
            points = np.array(room.polygon, dtype=np.float64)
            edges.append(np.stack([points, np.roll(points, -1, axis=0)], axis=1))
    return np.concatenate(edges)
