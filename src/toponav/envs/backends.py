"""What can simulate a scene, by name."""

from __future__ import annotations

from collections.abc import Callable

from toponav.envs.simulator.env import HouseEnv, HouseEnvConfig
from toponav.registry import Registry
from toponav.scenes.mesh import Scene

BackendFactory = Callable[[Scene, HouseEnvConfig], HouseEnv]

backends: Registry[BackendFactory] = Registry("backend")

EMBEDDED, HABITAT = "embedded", "habitat"


@backends.register(EMBEDDED)
def _embedded(scene: Scene, config: HouseEnvConfig) -> HouseEnv:
    return HouseEnv(scene, config)


@backends.register(HABITAT)
def _habitat(scene: Scene, config: HouseEnvConfig) -> HouseEnv:
    from toponav.envs.habitat.env import HabitatEnv

    return HabitatEnv(scene, config)
