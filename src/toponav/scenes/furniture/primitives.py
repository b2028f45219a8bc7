"""The solids that furniture is made of, as triangles with texture coordinates.

Local frame of a piece: base at z = 0, z up, front towards -y, back towards +y, metres. Triangles
are wound counter-clockwise as seen from outside.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

from toponav.scenes.textures import Surface

SEGMENTS = 14
"""Sides of round things: round at a glance, and few triangles."""

Vector = tuple[float, float, float]

_BOX_FACES = np.array(
    [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
)
"""Quads of a box whose corner i has bit 0, 1, 2 set where x, y, z is high."""


@dataclass(frozen=True, eq=False)
class Part:
    """Triangles of one surface.

    Attributes:
        corners: (F, 3, 3) metres.
        uv: (F, 3, 2) texture coordinates in repeats.
        surface: What they look like.
    """

    corners: NDArray[np.float64]
    uv: NDArray[np.float32]
    surface: Surface

    def moved(self, offset: Vector) -> Part:
        """The part shifted."""
        return replace(self, corners=self.corners + np.asarray(offset))

    def turned(self, axis: str, degrees: float, about: Vector = (0.0, 0.0, 0.0)) -> Part:
        """The part turned about an axis x, y or z through a point, counter-clockwise."""
        rotation = Rotation.from_euler(axis, degrees, degrees=True).as_matrix()
        return replace(self, corners=(self.corners - about) @ rotation.T + about)


def triangles(corners: ArrayLike, surface: Surface) -> Part:
    """(F, 3, 3) corners as a part; textured from the side that each triangle faces most."""
    corners = np.asarray(corners, dtype=np.float64)
    return Part(corners, box_mapped_uv(corners, surface.repeat_m), surface)


def quads(corners: ArrayLike, surface: Surface) -> Part:
    """(Q, 4, 3) planar quads as a part, textured as `triangles`, without those of no area."""
    return triangles(_solid_triangles(_quads(np.asarray(corners, np.float64))), surface)


def box_mapped_uv(corners: NDArray[np.float64], repeat_m: float) -> NDArray[np.float32]:
    """(F, 3, 2) coordinates of (F, 3, 3) triangles, projected along their dominant normal axis."""
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    dominant = np.abs(normals).argmax(axis=1)
    axes = np.array([[1, 2], [0, 2], [0, 1]])[dominant]
    uv = np.take_along_axis(corners, axes[:, None, :], axis=2)
    return (uv / repeat_m).astype(np.float32)


def box(low: Vector, high: Vector, surface: Surface) -> Part:
    """An axis-aligned box, 12 triangles."""
    bits = (np.arange(8)[:, None] >> np.arange(3)) & 1
    points = np.where(bits, high, low).astype(np.float64)
    return triangles(_quads(points[_BOX_FACES]), surface)


def picture(center: Vector, width: float, height: float, surface: Surface) -> Part:
    """An upright rectangle that faces -y and shows the whole image of its surface once."""
    x, y, z = center
    half, rise = width / 2.0, height / 2.0
    corners = np.array(
        [[x - half, y, z - rise], [x + half, y, z - rise], [x + half, y, z + rise],
         [x - half, y, z + rise]]
    )  # fmt: skip
    return _whole_image(corners, surface)


def mat(low: Vector, high: Vector, surface: Surface) -> Part:
    """A level rectangle at the height of `high` that shows the whole image of its surface once."""
    corners = np.array(
        [[low[0], low[1], high[2]], [high[0], low[1], high[2]], [high[0], high[1], high[2]],
         [low[0], high[1], high[2]]]
    )  # fmt: skip
    return _whole_image(corners, surface)


def rounded_box(low: Vector, high: Vector, radius: float, surface: Surface) -> Part:
    """A box with chamfered edges, 44 triangles: upholstery, ceramics."""
    lower, upper = np.asarray(low, np.float64), np.asarray(high, np.float64)
    half = (upper - lower) / 2.0
    inset = np.minimum(radius, _WIDEST_CHAMFER * half)
    points = (lower + upper) / 2.0 + _SIGNS * (half - inset * _OFF_FACE)
    return triangles(points[_chamfered_box_faces()], surface)


_WIDEST_CHAMFER = 0.98
"""Faces keep at least this little of their size, so that none degenerates."""

_SIGNS = np.repeat(2.0 * ((np.arange(8)[:, None] >> np.arange(3)) & 1) - 1.0, 3, axis=0)
"""(24, 3): the octant of each point of a chamfered box, three points a corner."""

_OFF_FACE = np.tile(1.0 - np.eye(3), (8, 1))
"""(24, 3): 0 along the axis of the face that a point lies on."""


@cache
def _chamfered_box_faces() -> NDArray[np.int64]:
    """(44, 3) indices into the 24 points: the same whatever the proportions."""
    points = _SIGNS * (1.0 - 0.3 * _OFF_FACE)
    faces: NDArray[np.int64] = ConvexHull(points).simplices.astype(np.int64)
    a, b, c = (points[faces[:, k]] for k in range(3))
    inward = np.einsum("ij,ij->i", np.cross(b - a, c - a), a + b + c) < 0.0
    faces[inward] = faces[inward][:, ::-1]
    return faces


def lathe(
    profile: Sequence[tuple[float, float]],
    surface: Surface,
    center: tuple[float, float] = (0.0, 0.0),
    stretch: tuple[float, float] = (1.0, 1.0),
    segments: int = SEGMENTS,
) -> Part:
    """A profile of (radius, z) turned about the vertical through `center`.

    Args:
        profile: From the outer side's lower end; radius 0 closes an end.
        surface: What it is made of.
        center: x, y of the axis.
        stretch: Factors along x and y that make ellipses of circles.
        segments: Sides.
    """
    angles = np.linspace(0.0, 2.0 * np.pi, segments + 1)
    circle = np.stack([stretch[0] * np.cos(angles), stretch[1] * np.sin(angles)], axis=1)
    radii, heights = np.array(profile, dtype=np.float64).T
    points = np.empty((len(radii), segments + 1, 3))
    points[..., :2] = radii[:, None, None] * circle + center
    points[..., 2] = heights[:, None]
    lower, upper = points[:-1], points[1:]
    sides = np.stack([lower[:, :-1], lower[:, 1:], upper[:, 1:], upper[:, :-1]], axis=2)
    return quads(sides.reshape(-1, 4, 3), surface)


def cylinder(
    center: Vector, radius: float, height: float, surface: Surface, segments: int = SEGMENTS
) -> Part:
    """An upright cylinder with both ends; `center` is the middle of its base."""
    x, y, z = center
    profile = [(0.0, z), (radius, z), (radius, z + height), (0.0, z + height)]
    return lathe(profile, surface, (x, y), segments=segments)


def ellipsoid(center: Vector, radii: Vector, surface: Surface, segments: int = 10) -> Part:
    """An ellipsoid with axes along x, y and z."""
    tilt = np.linspace(-0.5 * np.pi, 0.5 * np.pi, segments // 2 + 1)
    profile = [
        (float(r), center[2] + radii[2] * float(s))
        for r, s in zip(np.maximum(np.cos(tilt), 1e-9), np.sin(tilt), strict=True)
    ]
    return lathe(profile, surface, center[:2], radii[:2], segments)


def tube(start: Vector, end: Vector, radius: float, surface: Surface, segments: int = 6) -> Part:
    """A straight rod between two points, open at its ends; without faces where they coincide."""
    a, b = np.asarray(start, np.float64), np.asarray(end, np.float64)
    length = np.linalg.norm(b - a)
    if length == 0.0:
        return quads(np.zeros((0, 4, 3)), surface)
    axis = (b - a) / length
    side = np.cross(axis, np.eye(3)[np.abs(axis).argmin()])
    side /= np.linalg.norm(side)
    angles = np.linspace(0.0, 2.0 * np.pi, segments + 1)[:, None]
    ring = radius * (np.cos(angles) * side + np.sin(angles) * np.cross(axis, side))
    return quads(np.stack([a + ring[:-1], a + ring[1:], b + ring[1:], b + ring[:-1]], 1), surface)


def extruded(
    outline: Sequence[tuple[float, float]], low: float, high: float, surface: Surface
) -> Part:
    """A convex outline of (y, z), counter-clockwise seen from +x, drawn out from x = low to high.

    Side views: arms of a sofa, the body of a car.
    """
    ends = [np.array([(x, y, z) for y, z in outline]) for x in (low, high)]
    faces = [*_fan(ends[1]), *_fan(ends[0][::-1])]
    turn = np.roll(np.arange(len(outline)), -1)
    sides = np.stack([ends[0], ends[0][turn], ends[1][turn], ends[1]], axis=1)
    return triangles(np.concatenate([np.array(faces), _quads(sides)]), surface)


def blade(
    points: Sequence[Vector], widths: Sequence[float], across: ArrayLike, surface: Surface
) -> Part:
    """A strip along a curve, as a leaf: seen from both sides.

    Args:
        points: Along the middle.
        widths: At each point, metres.
        across: (3,) direction of the width.
        surface: Of both sides.
    """
    middle = np.array(points, dtype=np.float64)
    half = 0.5 * np.array(widths)[:, None] * np.asarray(across, np.float64)
    left, right = middle - half, middle + half
    return quads(np.stack([left[:-1], right[:-1], right[1:], left[1:]], axis=1), surface)


def _quads(corners: NDArray[np.float64]) -> NDArray[np.float64]:
    """(2 Q, 3, 3) triangles of (Q, 4, 3) quads."""
    return np.concatenate([corners[:, [0, 1, 2]], corners[:, [0, 2, 3]]])


def _fan(ring: NDArray[np.float64]) -> list[NDArray[np.float64]]:
    """Triangles of a convex polygon."""
    return [ring[[0, i, i + 1]] for i in range(1, len(ring) - 1)]


def _solid_triangles(corners: NDArray[np.float64]) -> NDArray[np.float64]:
    """Without the triangles that have no area, as at the tip of a cone."""
    doubled = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    solid: NDArray[np.float64] = corners[np.linalg.norm(doubled, axis=1) > 1e-10]
    return solid


def _whole_image(corners: NDArray[np.float64], surface: Surface) -> Part:
    """A rectangle, corners counter-clockwise from the image's lower left."""
    unit = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]], np.float32)
    unit = np.clip(unit, _TEXEL_MARGIN, 1.0 - _TEXEL_MARGIN)
    order = np.array([[0, 1, 2], [0, 2, 3]])
    return Part(corners[order], unit[order], surface)


_TEXEL_MARGIN = 1e-4
"""Keeps the edges of an image from showing the texels of the opposite edge."""
