"""What a scene holds, for people who choose one."""

from __future__ import annotations

from collections import Counter
from typing import Any

from toponav.envs.simulator import HouseEnv
from toponav.scenes.mesh import Scene
from toponav.types import STRUCTURE_CATEGORIES


def scene_info(scene: Scene) -> dict[str, Any]:
    """Name, triangles, floors, rooms, objects by category, navigable area, targets, episodes.

    Raises:
        SceneError: The scene has nowhere to stand.
    """
    env = HouseEnv(scene)
    objects = Counter(
        instance.category
        for instance in scene.mesh.instances
        if instance.category not in STRUCTURE_CATEGORIES
    )
    return {
        "name": scene.name,
        "triangles": len(scene.mesh.faces),
        "floors": list(scene.floors),
        "rooms": [room_type for room_type, _, _ in scene.room_types],
        "objects": dict(sorted(objects.items())),
        "navigable_m2": env.surface.area,
        "targets": list(env.oracle.categories()),
        "episodes": [
            {"target": episode.target, "start": list(episode.start), "yaw": episode.yaw}
            for episode in scene.episodes
        ],
    }
