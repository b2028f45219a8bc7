"""Small maps and memories for the tests of the topological memory."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike

from toponav.mapping.view import FREE, MapView, OccupancyGrid, PointCloud
from toponav.memory.builder import MemoryBuilder, MemoryConfig

RESOLUTION = 0.1


def cloud(points: ArrayLike) -> PointCloud:
    xyz = np.asarray(points, np.float32).reshape(-1, 3)
    return PointCloud(xyz, np.zeros((len(xyz), 3), np.uint8), np.ones(len(xyz), np.int32))


def open_grid(size_m: float = 20.0) -> OccupancyGrid:
    """A free square around the origin."""
    cells = np.full((round(size_m / RESOLUTION),) * 2, FREE, np.int8)
    return OccupancyGrid(cells, (-size_m / 2, -size_m / 2), RESOLUTION)


def make_map(
    objects: Mapping[str, Sequence[Sequence[float]]] | None = None,
    frontiers: ArrayLike = (),
    grid: OccupancyGrid | None = None,
    floor: int = 0,
    floor_z: float = 0.0,
) -> MapView:
    points = np.asarray(frontiers, np.float64).reshape(-1, 3)
    return MapView(
        scene=cloud([]),
        objects={name: cloud(xyz) for name, xyz in (objects or {}).items()},
        navigable=cloud([]),
        obstacles=cloud([]),
        frontiers=points,
        frontier_labels=np.zeros(len(points), np.int64),
        grid=grid or open_grid(),
        floor_z=floor_z,
        floor=floor,
    )


def two_rooms() -> tuple[MemoryBuilder, int]:
    """A bedroom and a kitchen joined by a hallway; the agent came back to the hallway."""
    view = make_map(
        objects={
            "bed": [(-4.0, 0.5, 0.4)],
            "nightstand": [(-4.5, 1.0, 0.3)],
            "fridge": [(5.0, 4.0, 1.0)],
            "chest_of_drawers": [(-3.0, -1.0, 0.5)],
        },
        frontiers=[(x, 5.5, 0.0) for x in np.arange(3.0, 6.0, 0.1)],
    )
    builder = MemoryBuilder(MemoryConfig())
    bedroom = builder.arrive((-4.0, 0.0), view, 0.0)
    hallway = builder.arrive((0.0, 0.0), view, 4.5)
    kitchen = builder.arrive((4.0, 3.0), view, 6.0)
    back = builder.arrive((0.0, 0.5), view, 5.0)
    builder.refresh(view)
    builder.set_room(bedroom, "bedroom")
    builder.set_room(hallway, "hallway")
    builder.set_room(kitchen, "kitchen")
    return builder, back
