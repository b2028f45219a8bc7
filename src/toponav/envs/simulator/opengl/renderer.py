"""Renders a scene with OpenGL: colour, depth and ids into three targets in one pass."""

from __future__ import annotations

import threading
from typing import Any

import numpy as np

from toponav.envs.simulator.opengl.context import fill_integers, thread_context
from toponav.envs.simulator.opengl.drawn_scene import DrawnScene
from toponav.envs.simulator.renderer import RenderedFrame, pack
from toponav.envs.simulator.shading import NO_INSTANCE
from toponav.geometry import Intrinsics, Pose
from toponav.scenes.mesh import SceneMesh

DEPTHS, IDS = 1, 2
"""Where the fragment shader puts them, after the colours."""


class GlRenderer:
    """Renders one scene; on a CPU with Mesa's software renderer, else on a GPU.

    A context belongs to one thread of one process: contexts and what they hold are created when a
    thread first renders, so that a renderer can be made before its process is forked.
    """

    def __init__(self, mesh: SceneMesh) -> None:
        """Pack textures and normals; nothing is asked of OpenGL yet."""
        self._surfaces = pack(mesh)
        self._of_thread = threading.local()

    def render(self, world_from_camera: Pose, intrinsics: Intrinsics) -> RenderedFrame:
        """The scene as a camera sees it; the optical axis is the camera's +z.

        Raises:
            MissingExtraError: There is no OpenGL to be had.
            SceneError: The scene is too large for it.
        """
        context = thread_context()
        with context:
            scene, targets = self._on_device(context, intrinsics)
            targets.clear()
            scene.draw(world_from_camera, intrinsics)
            return targets.read()

    def _on_device(self, context: Any, intrinsics: Intrinsics) -> tuple[DrawnScene, _Targets]:
        """The scene and the images of a camera, uploaded by whoever comes first."""
        mine, size = self._of_thread, (intrinsics.width, intrinsics.height)
        if not hasattr(mine, "scene"):
            context.gc()  # frees what other scenes left
            mine.scene = DrawnScene(context, self._surfaces)
        if getattr(mine, "size", None) != size:
            mine.targets, mine.size = _Targets(context, size), size
        return mine.scene, mine.targets


class _Targets:
    """The images that are drawn into."""

    def __init__(self, context: Any, size: tuple[int, int]) -> None:
        self._context = context
        self._shape = (size[1], size[0])
        colors, depths = context.texture(size, 4), context.texture(size, 1, dtype="f4")
        ids = context.texture(size, 1, dtype="i4")
        self._framebuffer = context.framebuffer(
            [colors, depths, ids], context.depth_renderbuffer(size)
        )

    def clear(self) -> None:
        """Make them the target of what is drawn, and empty."""
        self._framebuffer.use()
        self._context.enable_only(self._context.DEPTH_TEST)
        self._context.depth_func = "<"  # of surfaces at the same depth the first stays
        self._framebuffer.clear()
        fill_integers(IDS, NO_INSTANCE)

    def read(self) -> RenderedFrame:
        """What has been drawn, row 0 at the top."""
        frame = RenderedFrame(
            np.empty((*self._shape, 3), np.uint8),
            np.empty(self._shape, np.float32),
            np.empty(self._shape, np.int32),
        )
        read = self._framebuffer.read_into
        read(frame.rgb, components=3, alignment=1)
        read(frame.depth, components=1, attachment=DEPTHS, dtype="f4")
        read(frame.instance_ids, components=1, attachment=IDS, dtype="i4")
        return frame
