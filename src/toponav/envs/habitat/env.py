"""The protocol's agent in a scene that habitat-sim renders and moves in."""

from __future__ import annotations

from toponav.envs.habitat.simulator import HabitatSimulator
from toponav.envs.habitat.surface import HabitatSurface
from toponav.envs.simulator.env import HouseEnv
from toponav.envs.simulator.renderer import CameraRenderer
from toponav.envs.surface import Surface
from toponav.errors import SceneError


class HabitatEnv(HouseEnv):
    """`HouseEnv` with habitat-sim's images, navmesh, steps and distances.

    Habitat loads the file that the scene was read from; the scene itself still says which objects
    there are, and the ids of Habitat's semantic sensor are those of its instances.
    """

    def _load_world(self) -> tuple[Surface, CameraRenderer]:
        if self.scene.stage is None:
            raise SceneError(
                f"{self.scene.name}: habitat-sim loads .glb files; write one with toponav scenes "
                "export --format habitat"
            )
        self._simulator = HabitatSimulator(self.scene.stage, self.config.body, self.intrinsics)
        return HabitatSurface(self._simulator, self.scene.floors), self._simulator

    def close(self) -> None:
        """Let Habitat's scene go."""
        self._simulator.close()
