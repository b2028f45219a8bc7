"""Small maps for the tests of the policy."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike, NDArray

from toponav.mapping.view import FREE, MapView, OccupancyGrid, PointCloud


def cloud(points: ArrayLike) -> PointCloud:
    xyz = np.asarray(points, np.float32).reshape(-1, 3)
    return PointCloud(xyz, np.zeros((len(xyz), 3), np.uint8), np.ones(len(xyz), np.int32))


def make_view(
    navigable: ArrayLike = (),
    obstacles: ArrayLike = (),
    frontiers: ArrayLike = (),
    objects: Mapping[str, ArrayLike] | None = None,
    scene: ArrayLike = (),
    floor_z: float = 0.0,
) -> MapView:
    fro = np.asarray(frontiers, np.float64).reshape(-1, 3)
    grid = OccupancyGrid(np.full((100, 100), FREE, np.int8), (-5.0, -5.0), 0.1)
    return MapView(
        scene=cloud(scene),
        objects={name: cloud(xyz) for name, xyz in (objects or {}).items()},
        navigable=cloud(navigable),
        obstacles=cloud(obstacles),
        frontiers=fro,
        frontier_labels=np.zeros(len(fro), np.int64),
        grid=grid,
        floor_z=floor_z,
    )


def block(low: ArrayLike, high: ArrayLike, spacing: float = 0.05) -> NDArray[np.float64]:
    """(N, 3) points on a lattice that fills a box, its far faces included."""
    axes = [
        np.arange(a, b + 0.5 * spacing, spacing)
        for a, b in zip(np.asarray(low, float), np.asarray(high, float), strict=True)
    ]
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
