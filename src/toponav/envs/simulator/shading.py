"""Colour, depth and instance of each pixel from the triangle that it sees."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from toponav.envs.simulator.homogeneous import Vector, cross, dot, minus, to_pixel

AMBIENT = 0.48
"""Share of light that falls everywhere."""
SKY = 0.18
"""Share that falls from above: it tells table tops from their fronts."""
HEADLIGHT = 0.28
"""Share that comes from the camera: it shapes round things."""
BOUNCE = 0.34
"""Share that the floor throws back up: it keeps ceilings as light as they are in a lit room."""
SIDE = 0.16
"""Share that comes from one side: it tells a room's walls from each other."""
SIDE_DIRECTION = (0.48, 0.80, 0.36)
"""Unit vector towards the side light."""
FALLOFF_PER_M = 0.035
"""Darkening with distance, a depth cue; at most half."""


NO_INSTANCE = -1


class View(NamedTuple):
    """A camera.

    Attributes:
        pixels_from_world: (3, 3) from X - eye to homogeneous pixel coordinates.
        eye: (3,) world coordinates, metres.
        camera: fx, fy, cx, cy in pixels.
    """

    pixels_from_world: NDArray[np.float64]
    eye: NDArray[np.float64]
    camera: tuple[float, float, float, float]


class Surfaces(NamedTuple):
    """A scene's triangles and how they look; all textures lie in one array.

    Attributes:
        vertices: (V, 3) float64, metres.
        faces: (F, 3) int32.
        normals: (F, 3) float64 unit normals, zero for degenerate triangles.
        uv: (F, 3, 2) float32 texture coordinates.
        material: (F,) int32.
        instance: (F,) int32.
        corner_colors: (F, 3, 3) uint8 that multiply the texture; (0, 3, 3) for none.
        texels: (T, 3) uint8, row by row, material after material.
        offset: (M,) first texel of each material.
        size: (M, 2) its rows and columns.
        lit: Whether they are lit; else their colours are shown as they are.
    """

    vertices: NDArray[np.float64]
    faces: NDArray[np.int32]
    normals: NDArray[np.float64]
    uv: NDArray[np.float32]
    material: NDArray[np.int32]
    instance: NDArray[np.int32]
    corner_colors: NDArray[np.uint8]
    texels: NDArray[np.uint8]
    offset: NDArray[np.int64]
    size: NDArray[np.int64]
    lit: bool


class Images(NamedTuple):
    """What is written: (H, W, 3) uint8, (H, W) float32 metres, (H, W) int32."""

    rgb: NDArray[np.uint8]
    depth: NDArray[np.float32]
    instance_ids: NDArray[np.int32]


class _Facet(NamedTuple):
    """What the pixels of one triangle share.

    With p = (u, v, 1), one over the depth is normal . p / offset, and the weights of the second
    and third corner are second . p / normal . p and third . p / normal . p.
    """

    normal: Vector
    offset: float
    second: Vector
    third: Vector
    eye_distance: float
    light: float


@njit(cache=True, nogil=True, error_model="numpy")
def shade(
    view: View, surfaces: Surfaces, faces: NDArray[np.int32], images: Images, first: int
) -> None:
    """Fill rows of the images from row `first` on.

    Args:
        view: The camera.
        surfaces: The scene.
        faces: (N, W) visible triangles of the rows; negative for none.
        images: What is filled in.
        first: The row of the images that `faces` begin with.
    """
    rows, width = faces.shape
    fx, fy, cx, cy = view.camera
    for v in range(first, first + rows):
        y = (v - cy) / fy
        images.rgb[v] = 0
        images.depth[v] = 0.0
        images.instance_ids[v] = NO_INSTANCE
        last = -1
        facet = _facet(view, surfaces, 0)
        for u in range(width):
            f = faces[v - first, u]
            if f < 0:
                continue
            if f != last:
                facet = _facet(view, surfaces, f)
                last = f
            pixel = (float(u), float(v), 1.0)
            along = dot(facet.normal, pixel)
            inverse_depth = along / facet.offset
            if not inverse_depth > 0.0:  # seen edge-on
                continue
            depth = 1.0 / inverse_depth
            images.depth[v, u] = depth
            images.instance_ids[v, u] = surfaces.instance[f]
            x = (u - cx) / fx
            ray_length = np.sqrt(x * x + y * y + 1.0)
            light = 1.0
            if surfaces.lit:
                facing = facet.eye_distance * inverse_depth / ray_length
                light = facet.light + HEADLIGHT * facing
                light *= max(0.5, 1.0 - FALLOFF_PER_M * depth * ray_length)
            b, c = dot(facet.second, pixel) / along, dot(facet.third, pixel) / along
            red, green, blue = _albedo(surfaces, f, b, c)
            images.rgb[v, u, 0] = min(255, int(light * red + 0.5))
            images.rgb[v, u, 1] = min(255, int(light * green + 0.5))
            images.rgb[v, u, 2] = min(255, int(light * blue + 0.5))


@njit(cache=True, nogil=True)
def _facet(view: View, surfaces: Surfaces, f: int) -> _Facet:
    """Prepare triangle f."""
    first = surfaces.faces[f, 0]
    a = to_pixel(surfaces.vertices, first, view.pixels_from_world, view.eye)
    b = to_pixel(surfaces.vertices, surfaces.faces[f, 1], view.pixels_from_world, view.eye)
    c = to_pixel(surfaces.vertices, surfaces.faces[f, 2], view.pixels_from_world, view.eye)
    normal = cross(minus(b, a), minus(c, a))
    x, y, z = surfaces.normals[f, 0], surfaces.normals[f, 1], surfaces.normals[f, 2]
    away = (
        x * (surfaces.vertices[first, 0] - view.eye[0])
        + y * (surfaces.vertices[first, 1] - view.eye[1])
        + z * (surfaces.vertices[first, 2] - view.eye[2])
    )
    if away > 0.0:  # seen from behind: light the side that is seen
        x, y, z = -x, -y, -z
    side = x * SIDE_DIRECTION[0] + y * SIDE_DIRECTION[1] + z * SIDE_DIRECTION[2]
    light = AMBIENT + SKY * (0.5 + 0.5 * z) + SIDE * (0.5 + 0.5 * side)
    light += BOUNCE * max(0.0, -z)
    return _Facet(normal, dot(normal, a), cross(c, a), cross(a, b), abs(away), light)


@njit(cache=True, nogil=True)
def _albedo(surfaces: Surfaces, f: int, b: float, c: float) -> Vector:
    """Colour, 0 to 255, of the point with weights b and c of the second and third corner."""
    a = 1.0 - b - c
    uv = surfaces.uv[f]
    u = a * uv[0, 0] + b * uv[1, 0] + c * uv[2, 0]
    v = a * uv[0, 1] + b * uv[1, 1] + c * uv[2, 1]
    material = surfaces.material[f]
    rows, columns = surfaces.size[material, 0], surfaces.size[material, 1]
    column = min(int((u - np.floor(u)) * columns), columns - 1)
    row = min(int((1.0 - (v - np.floor(v))) * rows), rows - 1)
    texel = surfaces.texels[surfaces.offset[material] + row * columns + column]
    red, green, blue = float(texel[0]), float(texel[1]), float(texel[2])
    if len(surfaces.corner_colors) == 0:
        return red, green, blue
    tint = surfaces.corner_colors[f]
    return (
        red * (a * tint[0, 0] + b * tint[1, 0] + c * tint[2, 0]) / 255.0,
        green * (a * tint[0, 1] + b * tint[1, 1] + c * tint[2, 1]) / 255.0,
        blue * (a * tint[0, 2] + b * tint[1, 2] + c * tint[2, 2]) / 255.0,
    )
