"""A scene's faces by place: what is out of view is not drawn, and what is near is drawn first.

Faces drawn first hide others before these are shaded.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from toponav.envs.simulator.opengl.numbering import number_rows
from toponav.envs.simulator.opengl.shaders import NEAR_M
from toponav.envs.simulator.opengl.solids import OPEN, Solids, find_solids
from toponav.geometry import Intrinsics, Pose

CELL_M = 1.5
"""Side of the cells. Smaller ones are cut off the view more closely, and drawn in more calls."""

OUTSIDE_M = 5.0 * NEAR_M
"""So far from a solid's box, what is too near to be drawn is not a part of it either: a hole would
show its inside. Enough for corners of the view up to 78 degrees off the axis."""


class FaceCells:
    """Faces in the order of their cells, each with the box that its faces fill.

    Attributes:
        order: (F,) faces, cell after cell; within one as they were.
        start: (C + 1,) the faces of cell c are `order[start[c]:start[c + 1]]`.
    """

    def __init__(self, vertices: NDArray[np.float64], faces: NDArray[np.int32]) -> None:
        """Sort (F, 3) faces with (V, 3) vertices, metres."""
        corners = vertices[faces]
        low, high = corners.min(axis=1), corners.max(axis=1)
        cell = np.floor(0.5 * (low + high) / CELL_M).astype(np.int64)
        # A wall would blow up the box of the small things in its middle.
        large = (high - low).max(axis=1, keepdims=True) > CELL_M
        solids = find_solids(vertices, faces)
        bounds = _solid_bounds(solids)[solids.of_face]
        wide = (bounds[:, 1] - bounds[:, 0]).max(axis=1, keepdims=True) > CELL_M
        closed = solids.of_face[:, None] != OPEN
        key = np.concatenate([cell, large, closed, closed & wide], axis=1)
        number = number_rows(list(key.T))
        self.order = np.argsort(number, kind="stable")
        first = np.flatnonzero(np.diff(number[self.order], prepend=-1))
        self.start = np.append(first, len(faces))
        self._low = np.minimum.reduceat(low[self.order], first)
        self._high = np.maximum.reduceat(high[self.order], first)
        self._solids_low = np.minimum.reduceat(bounds[self.order, 0], first)
        self._solids_high = np.maximum.reduceat(bounds[self.order, 1], first)

    def in_view(self, world_from_camera: Pose, intrinsics: Intrinsics) -> NDArray[np.int64]:
        """Cells that a camera may see, from near to far."""
        eye = world_from_camera.translation
        center, half = 0.5 * (self._low + self._high) - eye, 0.5 * (self._high - self._low)
        inward = _sides(intrinsics) @ world_from_camera.rotation.T
        inside = (center @ inward.T + half @ np.abs(inward).T >= 0.0).all(axis=1)
        gap = np.maximum(np.abs(center) - half, 0.0)
        seen = np.flatnonzero(inside)
        nearest: NDArray[np.int64] = np.argsort((gap[seen] ** 2).sum(axis=1), kind="stable")
        return seen[nearest]

    def backs_hidden(self, eye: NDArray[np.float64]) -> NDArray[np.bool_]:
        """(C,) whether the cell's faces belong to solids that a camera at `eye` is outside of."""
        below, above = eye < self._solids_low - OUTSIDE_M, eye > self._solids_high + OUTSIDE_M
        return np.asarray((below | above).any(axis=1))


def _solid_bounds(solids: Solids) -> NDArray[np.float64]:
    """(S + 1, 2, 3) the solids' boxes and, last, that of open surfaces: nothing is outside it."""
    everywhere = np.array([[[-np.inf] * 3, [np.inf] * 3]])
    return np.concatenate([np.stack([solids.low, solids.high], axis=1), everywhere])


def _sides(intrinsics: Intrinsics) -> NDArray[np.float64]:
    """(5, 3) inward normals in the camera frame of the view's front, left, right, top, bottom."""
    # Half a pixel beyond the outermost pixel centres.
    left, right = -0.5 - intrinsics.cx, intrinsics.width - 0.5 - intrinsics.cx
    top, bottom = -0.5 - intrinsics.cy, intrinsics.height - 0.5 - intrinsics.cy
    fx, fy = intrinsics.fx, intrinsics.fy
    return np.array(
        [
            (0.0, 0.0, 1.0),
            (fx, 0.0, -left),
            (-fx, 0.0, right),
            (0.0, fy, -top),
            (0.0, -fy, bottom),
        ]
    )
