"""What the rest of the system sees of the map: clouds, the grid and frontiers (Section III-C)."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from toponav.mapping.nearby import NearObjects, ObjectSearch, near_objects

FREE, UNKNOWN, OCCUPIED = 1, 0, -1
"""Values of G(i, j): navigable, otherwise, obstacle."""

DROP = -2
"""Value of G(i, j) where the floor is missing (a stairwell, an open edge); not in the paper."""


@dataclass(frozen=True, eq=False)
class PointCloud:
    """Voxel centroids, in a fixed order (that of the voxels' first observation).

    Attributes:
        points: (N, 3) float32, world frame, metres.
        colors: (N, 3) uint8, mean colour.
        counts: (N,) int32, points averaged.
    """

    points: NDArray[np.float32]
    colors: NDArray[np.uint8]
    counts: NDArray[np.int32]

    def __len__(self) -> int:
        return len(self.points)


class DeferredCloud(PointCloud):
    """A cloud that is put together when it is first looked at.

    Most steps of an episode never look at M_nav or M_obs, which cost as much as the map is large.
    """

    def __init__(self, make: Callable[[], PointCloud]) -> None:
        """Take what puts it together."""
        object.__setattr__(self, "_make", make)

    @property
    def points(self) -> NDArray[np.float32]:  # noqa: D102
        return self._made.points

    @property
    def colors(self) -> NDArray[np.uint8]:  # noqa: D102
        return self._made.colors

    @property
    def counts(self) -> NDArray[np.int32]:  # noqa: D102
        return self._made.counts

    @cached_property
    def _made(self) -> PointCloud:
        made: PointCloud = self._make()  # type: ignore[attr-defined]
        return made


@dataclass(frozen=True, eq=False)
class OccupancyGrid:
    """The 2-D grid G of one floor; `cells[i, j]` covers x in origin + [i, i + 1) * resolution.

    Attributes:
        cells: (N_x, N_y) int8 of FREE, UNKNOWN, OCCUPIED, DROP; obstacles take precedence.
        origin: (x_min, y_min) of cell (0, 0), metres.
        resolution: r_g, metres.
        stairs: (N_x, N_y) float32 height of the highest stair tread over the floor, metres, NaN
            where there is no stair; None for a floor without stairs.
    """

    cells: NDArray[np.int8]
    origin: tuple[float, float]
    resolution: float
    stairs: NDArray[np.float32] | None = None

    def index_of(self, xy: ArrayLike) -> NDArray[np.int64]:
        """phi(p): (..., 2) cell indices of (..., 2) positions; may lie outside the grid."""
        offset = np.asarray(xy, dtype=np.float64)[..., :2] - np.asarray(self.origin)
        index: NDArray[np.int64] = np.floor(offset / self.resolution).astype(np.int64)
        return index

    def center_of(self, index: ArrayLike) -> NDArray[np.float64]:
        """(..., 2) centres of (..., 2) cells, metres."""
        center: NDArray[np.float64] = (np.asarray(index, dtype=np.float64) + 0.5) * self.resolution
        center += np.asarray(self.origin)
        return center

    def contains(self, index: ArrayLike) -> NDArray[np.bool_]:
        """Whether (..., 2) cell indices lie inside the grid."""
        cell = np.asarray(index)
        return np.asarray(np.all((cell >= 0) & (cell < self.cells.shape), axis=-1))


@dataclass(frozen=True, eq=False)
class MapView:
    """What the map knows on the agent's current floor, read-only.

    The clouds are looked at before the map takes its next frame; grid and frontiers are copies.

    Attributes:
        scene: M_scene, all floors.
        objects: M_obj^(c) by category, all floors.
        navigable: M_nav of the current floor.
        obstacles: M_obs of the current floor.
        frontiers: M_fro of the current floor, (N, 3) float64 at floor height.
        frontier_labels: (N,) int64 cluster of each frontier point, 0-based.
        grid: G of the current floor.
        floor_z: z_floor of the current floor, metres.
        floor: Index of the current floor, stable over the episode.
        object_search: Finds what is near places sooner than by a look at all of `objects`.
    """

    scene: PointCloud
    objects: Mapping[str, PointCloud]
    navigable: PointCloud
    obstacles: PointCloud
    frontiers: NDArray[np.float64]
    frontier_labels: NDArray[np.int64]
    grid: OccupancyGrid
    floor_z: float
    floor: int = 0
    object_search: ObjectSearch | None = None

    def objects_near(
        self, places: NDArray[np.floating], radius_m: float, heights_m: tuple[float, float]
    ) -> list[NearObjects]:
        """What is near each of (K, 2) places; `ObjectSearch.near` says more."""
        if self.object_search is not None:
            return self.object_search.near(places, radius_m, heights_m)
        points = {category: cloud.points for category, cloud in self.objects.items()}
        return near_objects(points, places, radius_m, heights_m)


@dataclass(frozen=True, eq=False)
class FrameUpdate:
    """What one integrated frame showed.

    Attributes:
        navigable_points: (N, 3) float32 floor points of this frame (before interpolation), one a
            voxel, world frame: the S_dir of this view.
        labels: Categories with at least one point in this frame.
        gone: (M, 3) float32 centroids of the voxels that were taken out of the map with this frame.
    """

    navigable_points: NDArray[np.float32]
    labels: tuple[str, ...]
    gone: NDArray[np.float32]
