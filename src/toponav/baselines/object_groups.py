"""Objects that stand together: labelled cells make objects, objects near each other groups."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from toponav.baselines.object_scores import CELL_M, ObjectScores

SAME_OBJECT_M = 2.0 * CELL_M
"""Cells of one category this near to each other belong to one object, metres."""


@dataclass(frozen=True, eq=False)
class ObjectGroup:
    """Objects that stand together.

    Attributes:
        names: Category of each of its M >= 1 objects.
        centre: (2,) mean of the objects' centres, world frame, metres.
    """

    names: tuple[str, ...]
    centre: NDArray[np.float64]


def object_groups(objects: ObjectScores, floor: int, distance_m: float) -> tuple[ObjectGroup, ...]:
    """Group the objects of a floor whose centres are linked by gaps of at most `distance_m`.

    This is DBSCAN with clusters of one object and more.
    """
    names: list[str] = []
    centres: list[NDArray[np.float64]] = []
    for name in objects.names(floor):
        cells = objects.cells(name, floor)
        for rows in linked(cells, SAME_OBJECT_M):
            names.append(name)
            centres.append(cells[rows].mean(axis=0))
    positions = np.array(centres).reshape(-1, 2)
    return tuple(
        ObjectGroup(tuple(names[row] for row in rows), positions[rows].mean(axis=0))
        for rows in linked(positions, distance_m)
    )


def linked(points: ArrayLike, distance_m: float) -> list[NDArray[np.intp]]:
    """Rows of (N, 2) points by single linkage, in the order of each cluster's first row."""
    positions = np.asarray(points, dtype=np.float64)
    pairs = cKDTree(positions).query_pairs(distance_m, output_type="ndarray")
    near = coo_matrix((np.ones(len(pairs)), pairs.T), shape=(len(positions),) * 2)
    count, label = connected_components(near, directed=False)
    clusters = [np.flatnonzero(label == k) for k in range(count)]
    return sorted(clusters, key=lambda rows: int(rows[0]))
