"""The up axis and the floors of a mesh, found from its horizontal surfaces."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from toponav.errors import SceneError

HORIZONTAL_COSINE = 0.95
"""A face whose normal is within 18 degrees of the up axis is horizontal."""

PLANE_BIN_M = 0.1
"""Faces are gathered into planes of this thickness."""

AXIS_DOMINANCE = 1.2
"""A format's own up axis is believed unless another one has a plane this much larger."""

MIN_FLOOR_AREA_M2 = 1.0
"""Smaller planes are furniture."""

MIN_FLOOR_SHARE = 0.25
"""A storey's floor has this part of the largest floor's area: tables and shelves have less."""

MIN_STOREY_M = 1.8
"""Floors are at least this far apart."""

MIN_ROOM_ABOVE_M = 1.0
"""Unless something rises this far above it, a plane above another floor is a roof."""


def detect_up_axis(triangles: NDArray[np.float64], default: str) -> str:
    """Which of y and z points up: the one along which the largest plane, the floor, lies.

    Args:
        triangles: (F, 3, 3) corners, metres.
        default: "y" or "z", the convention of the file's format.
    """
    other = "z" if default == "y" else "y"
    default_area, other_area = (_largest_plane(triangles, axis) for axis in (default, other))
    return other if other_area > AXIS_DOMINANCE * default_area else default


def find_floors(triangles: NDArray[np.float64]) -> tuple[float, ...]:
    """Heights of the floors of a z-up mesh, ascending.

    Args:
        triangles: (F, 3, 3) corners, metres, z up.

    Raises:
        SceneError: No horizontal surface is large enough.
    """
    heights, areas = _horizontal_faces(triangles, axis=2, upward=True)
    if areas.sum() < MIN_FLOOR_AREA_M2:  # faces wound the other way round
        heights, areas = _horizontal_faces(triangles, axis=2, upward=False)
    planes = _planes(heights, areas)
    largest = max((area for _, area in planes), default=0.0)
    if largest < MIN_FLOOR_AREA_M2:
        raise SceneError(
            f"no floor: the largest horizontal surface has {largest:.2f} m2; is the mesh a room in "
            "metres, and its up axis right?"
        )
    top = float(triangles[..., 2].max())
    floors: list[float] = []
    for height, area in planes:
        is_large = area >= max(MIN_FLOOR_SHARE * largest, MIN_FLOOR_AREA_M2)
        is_storey = not floors or (
            height - floors[-1] >= MIN_STOREY_M and top - height >= MIN_ROOM_ABOVE_M
        )
        if is_large and is_storey:
            floors.append(round(height, 3))
    return tuple(floors)


def _horizontal_faces(
    triangles: NDArray[np.float64], axis: int, upward: bool
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Mean heights and areas of the faces that are horizontal when `axis` is up."""
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    doubled = np.linalg.norm(normals, axis=1)
    along = normals[:, axis] if upward else np.abs(normals[:, axis])
    horizontal = (doubled > 0.0) & (along >= HORIZONTAL_COSINE * doubled)
    return triangles[horizontal, :, axis].mean(axis=1), doubled[horizontal] / 2.0


def _planes(heights: NDArray[np.float64], areas: NDArray[np.float64]) -> list[tuple[float, float]]:
    """(mean height, area) of the faces gathered by height, ascending."""
    if not len(heights):
        return []
    order = np.argsort(heights, kind="stable")
    heights, areas = heights[order], areas[order]
    planes = []
    start = 0
    for end in range(1, len(heights) + 1):
        if end == len(heights) or heights[end] - heights[start] > PLANE_BIN_M:
            area = float(areas[start:end].sum())
            planes.append((float(np.average(heights[start:end], weights=areas[start:end])), area))
            start = end
    return planes


def _largest_plane(triangles: NDArray[np.float64], axis: str) -> float:
    heights, areas = _horizontal_faces(triangles, "xyz".index(axis), upward=False)
    return max((area for _, area in _planes(heights, areas)), default=0.0)
