"""A scene's triangles and textures on the device."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from toponav.envs.simulator.opengl.cells import FaceCells
from toponav.envs.simulator.opengl.context import start_drawing
from toponav.envs.simulator.opengl.numbering import number_rows
from toponav.envs.simulator.opengl.shaders import NEAR_M, UNIT_NORMAL, program_sources
from toponav.envs.simulator.opengl.shared_corners import share_corners
from toponav.envs.simulator.shading import Surfaces
from toponav.errors import SceneError
from toponav.geometry import Intrinsics, Pose

CORNER = np.dtype(
    [
        ("position", "3f4"),
        ("normal", "4i2"),
        ("uv", "2f4"),
        ("first_texel", "i4"),
        ("columns", "i4"),
        ("rows", "i4"),
        ("instance", "i4"),
        ("tint", "4u1"),
    ]
)
"""A corner as the vertex shader takes it, and the look of the faces whose last one it is."""

LAYOUT = {
    "position": ("3f", "12x"),
    "whole_normal": ("4i2", "8x"),
    "uv": ("2f", "8x"),
    "look": ("4i", "16x"),
    "tint": ("4f1", "4x"),
}
"""The same in moderngl's terms by the shader's names: read, and skipped."""

FACES_AT_A_TIME = 8000
"""After so many the device is told to begin: Mesa's threads fill them in while the next are
prepared, and less lies in between."""


class DrawnScene:
    """The corners of all faces, all texels, and the program that draws them, in one context."""

    def __init__(self, context: Any, surfaces: Surfaces) -> None:
        """Upload a scene; the context is current.

        Raises:
            SceneError: Its textures are larger than what the device holds.
        """
        self._context = context
        low, high = surfaces.vertices.min(axis=0), surfaces.vertices.max(axis=0)
        self._center = 0.5 * (low + high)
        tinted = len(surfaces.corner_colors) > 0
        bits = _column_bits(context, len(surfaces.texels))
        vertex, fragment = program_sources(surfaces.lit, tinted, bits)
        self._program = context.program(vertex_shader=vertex, fragment_shader=fragment)
        self._texels = _upload_texels(context, surfaces.texels, 1 << bits)
        # A name that the compiler has dropped may not be bound: its bytes are skipped.
        used = [name for name in LAYOUT if name in self._program]
        formats = [read if name in used else skip for name, (read, skip) in LAYOUT.items()]
        self._cells = FaceCells(surfaces.vertices, surfaces.faces)
        corners, index = _corners(surfaces, self._cells.order, self._center)
        content = [(context.buffer(corners), " ".join(formats), *used)]
        self._triangles = context.vertex_array(self._program, content, context.buffer(index))
        self._set("near", np.float32(NEAR_M))

    def draw(self, world_from_camera: Pose, intrinsics: Intrinsics) -> None:
        """Draw into the framebuffer in use."""
        rotation = world_from_camera.rotation
        eye = world_from_camera.translation - self._center
        width, height = intrinsics.width, intrinsics.height
        camera = np.array([intrinsics.fx, intrinsics.fy, intrinsics.cx, intrinsics.cy])
        size = np.array([width, height])
        lens = np.concatenate([2.0 * camera[:2] / size, (2.0 * camera[2:] + 1.0) / size - 1.0])
        # A matrix is handed over column by column: the rotation as it is, is its transpose there.
        self._set("camera_from_world", rotation)
        self._set("center", -rotation.T @ eye)
        self._set("eye", eye)
        self._set("lens", lens)
        self._texels.use(0)
        self._context.cull_face = "front"  # rows run downward: what is turned left, turns right
        start, waiting = self._cells.start, 0
        hidden = self._cells.backs_hidden(world_from_camera.translation)
        for cell in self._cells.in_view(world_from_camera, intrinsics):
            switch = self._context.enable if hidden[cell] else self._context.disable
            switch(self._context.CULL_FACE)
            first, end = 3 * int(start[cell]), 3 * int(start[cell + 1])
            self._triangles.render(vertices=end - first, first=first)
            waiting += end - first
            if waiting > 3 * FACES_AT_A_TIME:
                start_drawing()
                waiting = 0

    def _set(self, name: str, value: NDArray[np.float64] | np.float32) -> None:
        """Set a uniform, unless the compiler has found that it is not needed."""
        if name in self._program:
            self._program[name].write(np.ascontiguousarray(value, np.float32).tobytes())


def _corners(
    surfaces: Surfaces, order: NDArray[np.int64], center: NDArray[np.float64]
) -> tuple[NDArray[np.void], NDArray[np.int32]]:
    """(C,) corners, and (F, 3) those of each face in the order of drawing."""
    normals = np.round(surfaces.normals * UNIT_NORMAL).astype(np.int16)
    # A texture repeats: near 0, single precision is finest.
    uv = surfaces.uv - np.floor(surfaces.uv[:, :1])
    place = [surfaces.faces, *np.moveaxis(uv, -1, 0), *np.moveaxis(surfaces.corner_colors, -1, 0)]
    shared = share_corners(
        number_rows([column.reshape(-1) for column in place if column.size]).reshape(-1, 3),
        number_rows([*normals.T, surfaces.material, surfaces.instance]),
        order,
    )
    f, k = np.divmod(shared.origin, 3)
    corners = np.zeros(len(f), CORNER)
    corners["position"] = surfaces.vertices[surfaces.faces[f, k]] - center
    corners["uv"] = uv[f, k]
    if len(surfaces.corner_colors):
        corners["tint"][:, :3] = surfaces.corner_colors[f, k]
    face = np.maximum(shared.face, 0)  # a corner without a look gets any
    material = surfaces.material[face]
    corners["normal"][:, :3] = normals[face]
    corners["first_texel"] = surfaces.offset[material]
    corners["rows"], corners["columns"] = surfaces.size[material].T
    corners["instance"] = surfaces.instance[face]
    return corners, shared.of_face


def _column_bits(context: Any, texels: int) -> int:
    """The table of texels is 2 to the power of this wide."""
    most = int(context.info["GL_MAX_TEXTURE_SIZE"]).bit_length() - 1
    if texels > 1 << (2 * most):
        raise SceneError(
            f"textures of {texels / 1e6:.0f} million texels are more than this OpenGL's "
            f"{(1 << (2 * most)) / 1e6:.0f} million: take another renderer than gl"
        )
    return min(most, (texels - 1).bit_length())


def _upload_texels(context: Any, texels: NDArray[np.uint8], columns: int) -> Any:
    """A texture that holds (T, 3) texels one after the other."""
    rows = -(-len(texels) // columns)
    filled = np.zeros((rows * columns, 3), np.uint8)
    filled[: len(texels)] = texels
    table = context.texture((columns, rows), 3, filled, alignment=1)
    table.filter = (context.NEAREST, context.NEAREST)
    return table
