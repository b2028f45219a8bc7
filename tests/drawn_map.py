"""Maps drawn with letters, and what an agent that stands on them needs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from toponav.control.frontier_clusters import FrontierCluster, frontier_clusters
from toponav.control.planner import CostField, Planner, PlannerConfig
from toponav.geometry import Intrinsics, Pose
from toponav.geometry.conventions import BODY_FROM_OPTICAL
from toponav.mapping.frontiers import label_clusters, mark_frontiers
from toponav.mapping.view import DROP, FREE, OCCUPIED, UNKNOWN, MapView, OccupancyGrid, PointCloud
from toponav.types import Detections, Observation

RESOLUTION_M = 0.1
_CELLS = {".": FREE, "#": OCCUPIED, " ": UNKNOWN, "v": DROP}


def drawn_map(*rows: str, enlarged: int = 1) -> MapView:
    """The map of a drawing: `.` free, `#` obstacle, `v` drop, blank unknown.

    x runs to the right, y downward. Every letter becomes a square of `enlarged` cells of 0.1 m.
    """
    letters = np.array([[_CELLS[letter] for letter in row] for row in rows], np.int8).T
    cells = np.kron(letters, np.ones((enlarged, enlarged), np.int8))
    grid = OccupancyGrid(cells, (0.0, 0.0), RESOLUTION_M)
    mask = np.zeros(cells.shape, np.bool_)
    mark_frontiers(cells, mask, 0, (0, 0, *cells.shape))
    # Beyond the drawing nothing is known, but it ends in walls as far as frontiers go.
    mask[[0, -1]] = mask[:, [0, -1]] = False
    marked = np.argwhere(mask)
    frontiers = np.column_stack([grid.center_of(marked), np.zeros(len(marked))])
    nothing = PointCloud(
        np.zeros((0, 3), np.float32), np.zeros((0, 3), np.uint8), np.zeros(0, np.int32)
    )
    return MapView(
        scene=nothing,
        objects={},
        navigable=nothing,
        obstacles=nothing,
        frontiers=frontiers,
        frontier_labels=label_clusters(mask, marked, 1),
        grid=grid,
        floor_z=0.0,
    )


def reach_from(view: MapView, xy: ArrayLike) -> CostField:
    """Cost of walking from a position to every cell."""
    planner = Planner(PlannerConfig())
    return planner.cost_field(planner.clearance(view.grid, xy), xy)


def clusters_from(view: MapView, xy: ArrayLike) -> tuple[FrontierCluster, ...]:
    """The frontiers that can be walked to from a position."""
    return frontier_clusters(view, reach_from(view, xy))


def straight_cluster(x: float, y: float, cells: int) -> FrontierCluster:
    """A frontier of so many cells along x from a first one, which is the nearest."""
    line = np.column_stack([x + RESOLUTION_M * np.arange(cells), np.full(cells, y)])
    return FrontierCluster(
        line, np.ones(cells, np.bool_), np.array([x, y, 0.0]), float(np.hypot(x, y))
    )


def observation_at(x: float, y: float, depth_m: float = 2.0, step: int = 0) -> Observation:
    """What an agent sees that looks along x at a flat wall."""
    base = Pose.from_yaw(0.0, (x, y, 0.0))
    eye = Pose.from_yaw(0.0, (x, y, 0.88)) @ BODY_FROM_OPTICAL
    camera = Intrinsics.from_hfov(40, 30, 79.0)
    return Observation(
        rgb=np.zeros((30, 40, 3), np.uint8),
        depth=np.full((30, 40), depth_m, np.float32),
        world_from_camera=eye,
        world_from_base=base,
        intrinsics=camera,
        step=step,
    )


def detections_of(
    boxes: Mapping[str, tuple[int, int, int, int]], scores: Sequence[float]
) -> Detections:
    """Detections in an image of `observation_at` whose masks fill their boxes."""
    masks = np.zeros((len(boxes), 30, 40), np.bool_)
    for mask, (left, top, right, bottom) in zip(masks, boxes.values(), strict=True):
        mask[top:bottom, left:right] = True
    corners: NDArray[np.float32] = np.array(list(boxes.values()), np.float32).reshape(-1, 4)
    return Detections(tuple(boxes), np.array(scores, np.float32), corners, masks)
