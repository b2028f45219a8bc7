"""The simulator's renderers by name: what `env.renderer` chooses from."""

from __future__ import annotations

from typing import Literal

from toponav.envs.simulator.raycaster import RayCaster
from toponav.envs.simulator.renderer import CameraRenderer, Renderer
from toponav.errors import MissingExtraError
from toponav.scenes.mesh import SceneMesh

RendererName = Literal["raster", "embree", "gl"]

RENDERERS: tuple[RendererName, ...] = ("raster", "embree", "gl")


def make_renderer(name: RendererName, mesh: SceneMesh) -> CameraRenderer:
    """A renderer of a scene, on all cores that this process may use.

    Raises:
        MissingExtraError: OpenGL is asked for, and moderngl is not installed.
    """
    if name == "gl":
        from toponav.envs.simulator.opengl.context import import_moderngl
        from toponav.envs.simulator.opengl.renderer import GlRenderer

        import_moderngl()
        return GlRenderer(mesh)
    return Renderer(mesh, RayCaster(mesh) if name == "embree" else None)


def why_missing(name: RendererName) -> str | None:
    """What keeps a renderer from working here, in one line; None for nothing."""
    if name == "gl":
        from toponav.envs.simulator.opengl.context import thread_context

        try:
            thread_context()
        except MissingExtraError as error:
            return str(error)
    return None
