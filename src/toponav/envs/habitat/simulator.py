"""One scene in habitat-sim: loaded, looked at from any pose, with its navmesh.

Poses and points come and go in this project's frames; what Habitat sees of them is made here.
"""

from __future__ import annotations

import atexit
import os
import weakref
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from toponav.envs.simulator.agent_body import AgentBody
from toponav.envs.simulator.renderer import RenderedFrame
from toponav.envs.simulator.shading import NO_INSTANCE
from toponav.errors import InputError, MissingExtraError, SceneError
from toponav.geometry import Intrinsics, Pose
from toponav.geometry.conventions import HABITAT_FROM_WORLD, OPTICAL_FROM_OPENGL
from toponav.scenes.habitat.layout import dataset_config

FIRST_EGL_DEVICE = -1
"""The device on which Habitat renders: any that EGL offers, which may be Mesa's software."""

GPU_VARIABLE = "TOPONAV_HABITAT_GPU"
"""Environment variable with the number of another device, for a machine with CUDA."""

_COLOR, _DEPTH, _SEMANTIC = "rgb", "depth", "semantic"


_open: weakref.WeakSet[HabitatSimulator] = weakref.WeakSet()
"""Simulators that hold a GL context, which must be let go before the interpreter ends."""


@atexit.register
def _close_all() -> None:
    for simulator in list(_open):
        simulator.close()


def import_habitat_sim() -> Any:
    """The library.

    Raises:
        MissingExtraError: It is not installed.
    """
    # Habitat's loggers tell of every file they touch.
    os.environ.setdefault("MAGNUM_LOG", "quiet")
    os.environ.setdefault("HABITAT_SIM_LOG", "quiet")
    try:
        import habitat_sim
    except ImportError as error:
        raise MissingExtraError(
            "the backend habitat needs habitat-sim 0.3, which is on no Python package index: "
            "install it with conda or from its sources (docs/habitat.md), or leave --backend at "
            "embedded"
        ) from error
    return habitat_sim


def gpu_device() -> int:
    """The number of the device on which Habitat renders.

    Raises:
        InputError: The environment variable holds no number.
    """
    text = os.environ.get(GPU_VARIABLE, str(FIRST_EGL_DEVICE))
    try:
        return int(text)
    except ValueError:
        raise InputError(f"{GPU_VARIABLE}={text!r}: give the number of a device") from None


class HabitatSimulator:
    """Renders one scene, as `Renderer` does, and knows its navmesh."""

    def __init__(self, stage: Path, body: AgentBody, intrinsics: Intrinsics) -> None:
        """Load a scene and compute the navmesh of a body, unless the scene brings that one.

        Args:
            stage: A `.glb`, in a dataset's folder.
            body: Who moves.
            intrinsics: A centred camera with square pixels.

        Raises:
            MissingExtraError: habitat-sim is not installed.
            SceneError: Habitat cannot load the scene, or finds nowhere to stand in it.
        """
        self._habitat = import_habitat_sim()
        config = self._habitat.Configuration(
            self._backend(stage, body), [self._agent(body, intrinsics)]
        )
        try:
            self._sim = self._habitat.Simulator(config)
        except (AssertionError, RuntimeError, ValueError) as error:
            reason = " ".join(str(error).split()) or "it says no more"
            raise SceneError(f"{stage}: habitat-sim cannot load the scene: {reason}") from error
        if not self._sim.pathfinder.is_loaded:
            self._sim.close()
            raise SceneError(f"{stage}: habitat-sim finds no floor on which the agent has room")
        self._intrinsics = intrinsics
        _open.add(self)

    @property
    def habitat(self) -> Any:
        """The library's module."""
        return self._habitat

    @property
    def sim(self) -> Any:
        """The `habitat_sim.Simulator`."""
        return self._sim

    @property
    def pathfinder(self) -> Any:
        """The `habitat_sim.PathFinder`."""
        return self._sim.pathfinder

    def render(self, world_from_camera: Pose, intrinsics: Intrinsics) -> RenderedFrame:
        """The scene as the camera sees it; the optical axis is the camera's +z."""
        if intrinsics != self._intrinsics:
            raise ValueError("a Habitat simulator renders with the camera that it was made with")
        self._look_from(world_from_camera)
        images = self._sim.get_sensor_observations()
        depth = np.ascontiguousarray(images[_DEPTH], np.float32)
        ids = images[_SEMANTIC].astype(np.int32)
        return RenderedFrame(
            rgb=np.ascontiguousarray(images[_COLOR][..., :3]),
            depth=depth,
            instance_ids=np.where(depth > 0.0, ids, NO_INSTANCE).astype(np.int32),
        )

    def close(self) -> None:
        """Let the scene go."""
        self._sim.close()
        _open.discard(self)

    def _look_from(self, world_from_camera: Pose) -> None:
        """Put every sensor at a pose."""
        camera = HABITAT_FROM_WORLD @ world_from_camera @ OPTICAL_FROM_OPENGL
        state = self._habitat.AgentState()
        state.position = camera.translation.astype(np.float32)
        # The sensors sit at the agent's own origin, so its pose is theirs.
        state.rotation = camera.quaternion_xyzw.tolist()
        self._sim.get_agent(0).set_state(state)

    def _backend(self, stage: Path, body: AgentBody) -> Any:
        backend = self._habitat.SimulatorConfiguration()
        backend.scene_id = str(stage)
        config = dataset_config(stage)
        if config is not None:
            backend.scene_dataset_config_file = str(config)
        backend.gpu_device_id = gpu_device()
        backend.enable_physics = False
        backend.load_semantic_mesh = True
        backend.allow_sliding = False
        settings = self._habitat.NavMeshSettings()
        settings.set_defaults()
        settings.agent_radius = body.radius
        settings.agent_height = body.height
        settings.agent_max_climb = body.max_climb
        settings.agent_max_slope = body.max_slope_deg
        settings.cell_size = body.cell_size
        backend.navmesh_settings = settings
        return backend

    def _agent(self, body: AgentBody, intrinsics: Intrinsics) -> Any:
        kinds = self._habitat.SensorType
        agent = self._habitat.AgentConfiguration()
        agent.radius, agent.height = body.radius, body.height
        agent.sensor_specifications = [
            self._sensor(name, kind, intrinsics)
            for name, kind in (
                (_COLOR, kinds.COLOR), (_DEPTH, kinds.DEPTH), (_SEMANTIC, kinds.SEMANTIC),
            )
        ]  # fmt: skip
        return agent

    def _sensor(self, name: str, kind: Any, intrinsics: Intrinsics) -> Any:
        spec = self._habitat.CameraSensorSpec()
        spec.uuid = name
        spec.sensor_type = kind
        spec.resolution = [intrinsics.height, intrinsics.width]
        spec.hfov = float(np.degrees(intrinsics.hfov))
        spec.position = [0.0, 0.0, 0.0]
        return spec


def habitat_points(points: NDArray[np.float64]) -> NDArray[np.float32]:
    """(..., 3) points of our world in Habitat's frame, as precise as Habitat takes them."""
    return HABITAT_FROM_WORLD.apply(points).astype(np.float32)
