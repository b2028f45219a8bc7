"""Ground truth of the running episode: viewpoints, geodesic distances, labels."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from toponav.categories import canonical
from toponav.envs.simulator.raycaster import RayCaster
from toponav.envs.simulator.viewpoints import viewpoints
from toponav.envs.surface import Distances, Surface
from toponav.scenes.mesh import Scene
from toponav.types import STRUCTURE_CATEGORIES, SemanticFrame


class Episode(Protocol):
    """What the oracle knows of the environment that it belongs to."""

    target: str
    position: NDArray[np.float64]

    def semantic_frame(self) -> SemanticFrame:
        """Labels of the image last observed."""
        ...


class SceneOracle:
    """Answers from the scene's geometry; viewpoints and distances are computed once a category."""

    def __init__(self, scene: Scene, surface: Surface, caster: RayCaster, episode: Episode) -> None:
        """Know the scene; `episode` is where the agent's state is read."""
        self._episode = episode
        self.learn(scene, surface, caster)

    def learn(self, scene: Scene, surface: Surface, caster: RayCaster) -> None:
        """Know another scene, or another state of the same, from now on."""
        self._scene = scene
        self._surface = surface
        self._caster = caster
        self._viewpoints = dict(scene.viewpoints)
        self._fields: dict[str, Distances] = {}
        self._categories: tuple[str, ...] | None = None

    @property
    def target(self) -> str:
        """Category that the running episode searches for."""
        return self._episode.target

    def semantic_frame(self) -> SemanticFrame:
        """Labels of the image last observed."""
        return self._episode.semantic_frame()

    def categories(self) -> tuple[str, ...]:
        """Categories that have at least one viewpoint, sorted; structure left out."""
        if self._categories is None:
            named = {instance.category for instance in self._scene.mesh.instances}
            candidates = (named - STRUCTURE_CATEGORIES - {"unknown"}) | set(self._scene.viewpoints)
            self._categories = tuple(c for c in sorted(candidates) if len(self.viewpoints(c)))
        return self._categories

    def viewpoints(self, category: str) -> NDArray[np.float64]:
        """(N, 3) viewpoints of all instances of a category (PROTOCOL: within 1 m, seeing it)."""
        name = canonical(category)
        if name not in self._viewpoints:
            instances = self._scene.mesh.instances
            ids = [instance.id for instance in instances if instance.category == name]
            found = viewpoints(self._surface, self._caster, self._scene.mesh, ids)
            self._viewpoints[name] = found
        return self._viewpoints[name]

    def instance_viewpoints(self, instance: int) -> NDArray[np.float64]:
        """(N, 3) viewpoints of one instance, found from the scene's geometry."""
        return viewpoints(self._surface, self._caster, self._scene.mesh, [instance])

    def distance_to_goal(self) -> float:
        """DTG: geodesic distance from the agent to the nearest viewpoint, metres; may be inf."""
        target = self._episode.target
        if target not in self._fields:
            self._fields[target] = self._surface.distance_field(self.viewpoints(target))
        return self._fields[target].at(self._episode.position)

    def geodesic_distance(self, start: NDArray[np.float64], goal: NDArray[np.float64]) -> float:
        """Shortest path on the navigable surface between two points, metres; may be infinite."""
        return self._surface.geodesic_distance(start, goal)
