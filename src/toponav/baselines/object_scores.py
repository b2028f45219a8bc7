"""Where objects were detected and how surely: labelled cells of the floor plan with their score."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from toponav.mapping.semantic_map import MapConfig
from toponav.types import Detections, Observation

CELL_M = 0.1
"""Edge of a cell, metres: that of the grid G."""

PIXELS_PER_DETECTION = 128
"""Pixels of a mask that are looked at, evenly spread: enough for the cells of any furniture."""

Cells = dict[tuple[int, int], float]
"""Cell index to the best score of one category there."""


class ObjectScores:
    """The best score that each category has had in each cell of each floor."""

    def __init__(self, config: MapConfig) -> None:
        """Start without objects; depths outside the map's window are ignored."""
        self._depth_window = (config.min_depth_m, config.max_depth_m)
        self._floors: dict[int, dict[str, Cells]] = {}

    def add(self, observation: Observation, detections: Detections, floor: int) -> None:
        """Take the detections of one frame, taken on a floor."""
        labels = self._floors.setdefault(floor, {})
        for label, score, mask in zip(
            detections.labels, detections.scores, detections.masks, strict=True
        ):
            cells = labels.setdefault(label, {})
            for i, j in self._cells_of(observation, mask):
                cells[i, j] = max(float(score), cells.get((i, j), 0.0))

    def names(self, floor: int) -> tuple[str, ...]:
        """The categories detected from a floor, in the order of their first detection."""
        return tuple(self._floors.get(floor, {}))

    def cells(self, name: str, floor: int) -> NDArray[np.float64]:
        """(M, 2) centres of the cells of a category, world frame, metres."""
        keys = list(self._floors.get(floor, {}).get(name, {}))
        return (np.array(keys, dtype=np.float64).reshape(-1, 2) + 0.5) * CELL_M

    def within_radius(self, xy: ArrayLike, radius_m: float, floor: int) -> NDArray[np.float64]:
        """(N, L) best score of each of L `names` within a circle round each of (N, 2) positions."""
        return self._best(xy, radius_m, floor, order=2)

    def within_box(self, xy: ArrayLike, half_edge_m: float, floor: int) -> NDArray[np.float64]:
        """(N, L) best score of each of L `names` in a square round each of (N, 2) positions."""
        return self._best(xy, half_edge_m, floor, order=np.inf)

    def _best(
        self, xy: ArrayLike, distance_m: float, floor: int, order: float
    ) -> NDArray[np.float64]:
        positions = np.asarray(xy, dtype=np.float64)
        names = self.names(floor)
        best = np.zeros((len(positions), len(names)))
        for column, name in enumerate(names):
            offset = np.abs(positions[:, None] - self.cells(name, floor))
            near = (
                (offset <= distance_m).all(axis=-1)
                if order == np.inf
                else (offset**2).sum(axis=-1) <= distance_m**2
            )
            score = np.array(list(self._floors[floor][name].values()))
            best[:, column] = np.where(near, score, 0.0).max(axis=1, initial=0.0)
        return best

    def _cells_of(self, observation: Observation, mask: NDArray[np.bool_]) -> list[tuple[int, int]]:
        """The cells under a mask, each once."""
        pixels = np.flatnonzero(mask)
        pixels = pixels[:: max(1, len(pixels) // PIXELS_PER_DETECTION)]
        depth = observation.depth.ravel()[pixels].astype(np.float64)
        nearest, farthest = self._depth_window
        valid = (depth > nearest) & (depth < farthest)
        v, u = np.divmod(pixels[valid], mask.shape[1])
        camera = observation.intrinsics
        rays = np.stack([(u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy], axis=-1)
        in_camera = np.column_stack([rays, np.ones(len(rays))]) * depth[valid, None]
        world = observation.world_from_camera.apply(in_camera)
        cells = np.unique(np.floor(world[:, :2] / CELL_M).astype(np.int64), axis=0)
        return [(int(i), int(j)) for i, j in cells]
