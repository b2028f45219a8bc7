"""Houses as an ObjectNav dataset that Habitat runs: scenes, episodes, goals and viewpoints.

Laid out below Habitat's data folder as HM3D and its episodes are:

    DATA/scene_datasets/<name>/<name>.scene_dataset_config.json
    DATA/scene_datasets/<name>/<scene>/<scene>.glb  .semantic.glb  .semantic.txt  .navmesh
    DATA/datasets/objectnav/<name>/v1/<split>/<split>.json.gz
    DATA/datasets/objectnav/<name>/v1/<split>/content/<scene>.json.gz
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from toponav.categories import HM3D_TARGETS, canonical
from toponav.datasets.objectnav import CONTENT
from toponav.datasets.objectnav_file import ObjectNavFile, write_file
from toponav.datasets.scene_files import SCENES_FOLDER
from toponav.envs.habitat.navmesh_file import navmesh_bytes
from toponav.envs.simulator import HouseEnv
from toponav.envs.simulator.agent_body import AgentBody
from toponav.envs.simulator.convex_mesh import convex_mesh
from toponav.envs.simulator.navigation import NavigableSurface
from toponav.envs.simulator.span_graph import subset
from toponav.errors import EpisodeError, InputError
from toponav.evaluation.run_config import run_config
from toponav.evaluation.runner import SceneRunner
from toponav.files import write_atomic
from toponav.geometry.conventions import HABITAT_FROM_WORLD, habitat_rotation
from toponav.scenes.habitat.export import (
    FIRST_ID,
    as_stored,
    scene_dataset_config,
    write_habitat_scene,
)
from toponav.scenes.mesh import Scene, SceneEpisode

VERSION = "v1"
_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_-]*")


@dataclass(frozen=True)
class DatasetPlan:
    """What to write, and where.

    Attributes:
        data: Habitat's data folder, `data` by custom.
        name: Of the dataset.
        split: Of the episodes.
        episodes: Of each scene; None takes those that it brings, or one that is drawn.
        seed: Draws what a scene does not bring.
    """

    data: Path
    name: str = "toponav"
    split: str = "val"
    episodes: int | None = None
    seed: int = 0

    def __post_init__(self) -> None:
        for what in (self.name, self.split):
            if not _NAME.fullmatch(what):
                raise InputError(f"{what!r} cannot name a dataset's folder: use letters, digits, _")
        if self.episodes is not None and self.episodes < 1:
            raise InputError(f"--episodes takes a positive number, not {self.episodes}")

    @property
    def scenes(self) -> Path:
        """Where the scenes lie."""
        return self.data / SCENES_FOLDER / self.name

    @property
    def config(self) -> Path:
        """The scene dataset's configuration."""
        return self.scenes / f"{self.name}.scene_dataset_config.json"

    @property
    def file(self) -> Path:
        """The split's episode file."""
        folder = self.data / "datasets" / "objectnav" / self.name / VERSION / self.split
        return folder / f"{self.split}.json.gz"

    @property
    def config_from_parent(self) -> str:
        """The configuration's path as Habitat wants it, from the folder that holds `data`."""
        inside = self.config.relative_to(self.data)
        return f"./{PurePosixPath(self.data.resolve().name, *inside.parts)}"


def export_dataset(scenes: Iterable[Scene], plan: DatasetPlan) -> list[Path]:
    """Write scenes and their episodes as one dataset.

    Args:
        scenes: With names of their own.
        plan: What and where.

    Returns:
        The files, the split's episode file last.

    Raises:
        InputError: No scene, or two of one name.
        EpisodeError: A scene has no target that can be reached.
        OSError: The folder cannot be written.
    """
    written: list[Path] = []
    stages: list[PurePosixPath] = []
    contents: dict[str, dict[str, Any]] = {}
    for scene in scenes:
        if scene.name in contents:
            raise InputError(f"two scenes are called {scene.name!r}: give each its own name")
        stored = as_stored(scene)
        runner = SceneRunner(stored, run_config("default", seed=plan.seed))
        contents[scene.name] = _scene_content(runner, plan)
        stage = write_habitat_scene(stored, plan.scenes / scene.name, scene.name)
        write_atomic(stage.with_suffix(".navmesh"), _navmesh(stored, runner.env.config.body))
        stages.append(PurePosixPath(scene.name, stage.name))
        written.append(stage)
    if not contents:
        raise InputError("there is no scene to export")
    ids = _task_ids(contents)
    for name, content in contents.items():
        written.append(plan.file.parent / CONTENT / f"{name}.json.gz")
        _write(written[-1], content, ids)
    written.append(plan.config)
    write_atomic(plan.config, scene_dataset_config(stages))
    written.append(plan.file)
    _write(plan.file, {"episodes": [], "goals_by_category": {}}, ids)
    return written


def _write(path: Path, content: dict[str, Any], ids: dict[str, int]) -> None:
    tables = {"category_to_task_category_id": ids, "category_to_scene_annotation_category_id": ids}
    write_file(path, ObjectNavFile.model_validate({**content, **tables}))


def _task_ids(contents: dict[str, dict[str, Any]]) -> dict[str, int]:
    """HM3D's ids for its six categories; further ones follow by name."""
    used = {e["object_category"] for content in contents.values() for e in content["episodes"]}
    names = (*HM3D_TARGETS, *sorted(used - set(HM3D_TARGETS)))
    return {name: number for number, name in enumerate(names)}


def _navmesh(scene: Scene, body: AgentBody) -> bytes:
    """The main island of the navigable surface: no roofs, no table tops."""
    surface = NavigableSurface.build(scene.mesh, body, scene.floors)
    floor = subset(surface.graph, surface.graph.island == surface.main_island)
    return navmesh_bytes(convex_mesh(floor), body)


def _scene_content(runner: SceneRunner, plan: DatasetPlan) -> dict[str, Any]:
    """`episodes` and `goals_by_category` of one scene."""
    scene = runner.scene
    count = len(scene.episodes) or 1 if plan.episodes is None else plan.episodes
    drawn = [runner.episode(index).episode for index in range(count)]
    goals = {
        target: _goals(runner.env, target)
        for target in dict.fromkeys(canonical(episode.target) for episode in drawn)
    }
    file_name = f"{scene.name}.glb"
    return {
        "goals_by_category": {f"{file_name}_{target}": found for target, found in goals.items()},
        "episodes": [
            {
                "episode_id": str(number),
                "scene_id": f"{plan.name}/{scene.name}/{file_name}",
                "scene_dataset_config": plan.config_from_parent,
                "additional_obj_config_paths": [],
                **_start(runner.env, episode, goals[canonical(episode.target)]),
                "goals": [],
                "start_room": None,
                "shortest_paths": None,
                "object_category": canonical(episode.target),
            }
            for number, episode in enumerate(drawn)
        ],
    }


def _start(env: HouseEnv, episode: SceneEpisode, goals: list[dict[str, Any]]) -> dict[str, Any]:
    """Start pose and distances, as Habitat's files give them."""
    env.reset(options={"target": episode.target, "start": (*episode.start, episode.yaw)})
    position = _habitat(env.position)
    gaps = [np.linalg.norm(np.subtract(goal["position"], position)) for goal in goals]
    nearest = int(np.argmin(gaps))
    return {
        "start_position": position,
        "start_rotation": _rotation(episode.yaw),
        "info": {
            "geodesic_distance": env.oracle.distance_to_goal(),
            "euclidean_distance": float(gaps[nearest]),
            "closest_goal_object_id": goals[nearest]["object_id"],
        },
    }


def _goals(env: HouseEnv, target: str) -> list[dict[str, Any]]:
    """Every instance of a category that has a viewpoint.

    Raises:
        EpisodeError: None has.
    """
    found = []
    for instance in env.scene.mesh.instances:
        points = env.oracle.instance_viewpoints(instance.id) if instance.category == target else ()
        if not len(points):
            continue
        corners = env.scene.mesh.vertices[
            env.scene.mesh.faces[env.scene.mesh.face_instance == instance.id]
        ].reshape(-1, 3)
        middle = (corners.min(axis=0) + corners.max(axis=0)) / 2.0
        found.append(
            {
                "position": _habitat(middle),
                "radius": None,
                "object_id": instance.id + FIRST_ID,
                "object_name": instance.name,
                "object_name_id": None,
                "object_category": target,
                "room_id": None,
                "room_name": None,
                "view_points": [_view_point(point, middle) for point in points],
            }
        )
    if not found:
        raise EpisodeError(f"{env.scene.name}: no {target} can be reached")
    return found


def _view_point(point: ArrayLike, middle: ArrayLike) -> dict[str, Any]:
    """A viewpoint that faces the object's middle; how much of it is seen there is not measured."""
    ahead = np.subtract(middle, point)
    state = {
        "position": _habitat(point),
        "rotation": _rotation(float(np.arctan2(ahead[1], ahead[0]))),
    }
    return {"agent_state": state, "iou": None}


def _habitat(point: ArrayLike) -> list[float]:
    """A point in Habitat's frame, to a hundredth of a millimetre."""
    return [round(float(v), 5) for v in HABITAT_FROM_WORLD.apply(point)]


def _rotation(yaw: float) -> list[float]:
    """The quaternion (x, y, z, w) of an agent in Habitat's frame whose heading here is `yaw`."""
    return [round(v, 7) for v in habitat_rotation(yaw)]
