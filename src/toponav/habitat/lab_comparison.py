"""This package's agents inside habitat-lab's own ObjectNav task, and both sides' scores.

Every episode runs in `habitat.Env` by `ChallengeAgent`; the same actions then run in this package's
environment and are scored by its metrics. Labels come from the task's semantic sensor.
"""

from __future__ import annotations

import contextlib
import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from toponav.datasets import ObjectNavEpisode, load_objectnav
from toponav.envs.habitat.simulator import gpu_device, import_habitat_sim
from toponav.errors import InputError, MissingExtraError
from toponav.evaluation.results import Score, score_episode
from toponav.evaluation.run_config import RunConfig
from toponav.evaluation.runner import SceneRunner
from toponav.evaluation.sources import ObjectNavSource
from toponav.habitat.challenge_agent import ChallengeAgent
from toponav.types import Action, Instance

TASK = "benchmark/nav/objectnav/objectnav_hm3d.yaml"
"""habitat-lab's own configuration of ObjectNav."""


@dataclass(frozen=True)
class LabEpisode:
    """One episode as habitat-lab saw it.

    Attributes:
        scene: The scene's name.
        index: Index among the scene's episodes.
        actions: What the agent did.
        success: habitat-lab's.
        spl: habitat-lab's.
        soft_spl: habitat-lab's.
        distance_to_goal: habitat-lab's, metres.
    """

    scene: str
    index: int
    actions: tuple[int, ...]
    success: bool
    spl: float
    soft_spl: float
    distance_to_goal: float


@dataclass(frozen=True)
class Comparison:
    """An episode's scores on both sides."""

    lab: LabEpisode
    ours: Score
    distance_to_goal: float

    @property
    def difference(self) -> float:
        """The largest difference of success, SPL, SoftSPL and DTG (metres)."""
        pairs = (
            (float(self.lab.success), float(self.ours.success["0.1"])),
            (self.lab.spl, self.ours.spl),
            (self.lab.soft_spl, self.ours.soft_spl),
            (self.lab.distance_to_goal, self.distance_to_goal),
        )
        return max(0.0 if a == b else abs(a - b) for a, b in pairs)


def compare_with_habitat_lab(
    path: Path, data: Path, episodes: int, config: RunConfig
) -> list[Comparison]:
    """Run the first episodes of a file in habitat-lab, and again here.

    Args:
        path: A split's episode file.
        data: Habitat's data folder.
        episodes: How many.
        config: The agent; its `backend` runs the actions again.

    Raises:
        MissingExtraError: habitat-sim or habitat-lab is not installed.
        InputError: The file has fewer episodes.
    """
    source = ObjectNavSource(path, data)
    source.outlines()  # a missing scene is named before Habitat looks for it
    known = {(e.scene, e.index): e for e in load_objectnav(path).episodes}
    if episodes > len(known):
        raise InputError(f"{path}: holds {len(known)} episodes, not {episodes}")
    lab = list(_in_habitat_lab(source, path.resolve(), data.resolve(), episodes, config))
    compared = []
    for scene in dict.fromkeys(episode.scene for episode in lab):
        spec = next(e.scene_id for e in known.values() if e.scene == scene)
        runner = SceneRunner(source.load(spec), config)
        mine = [episode for episode in lab if episode.scene == scene]
        compared += [_replayed(runner, e, known[scene, e.index]) for e in mine]
        runner.close()
    return compared


def _replayed(runner: SceneRunner, lab: LabEpisode, episode: ObjectNavEpisode) -> Comparison:
    """Carry out an episode's actions here and score them."""
    env = runner.env
    env.reset(options={"target": episode.target, "start": (*episode.start, episode.yaw)})
    shortest, walked = env.oracle.distance_to_goal(), 0.0
    for action in lab.actions:
        before = env.position
        env.step(action)
        walked += float(np.linalg.norm(env.position - before))
    distance = env.oracle.distance_to_goal()
    stopped = bool(lab.actions) and lab.actions[-1] == Action.STOP
    return Comparison(lab, score_episode(stopped, distance, shortest, walked), distance)


def _in_habitat_lab(
    source: ObjectNavSource, path: Path, data: Path, episodes: int, config: RunConfig
) -> Iterator[LabEpisode]:
    """Run episodes in `habitat.Env`."""
    habitat = _import_habitat()
    scenes: dict[str, tuple[Instance, ...]] = {}
    # Episode files name their dataset's configuration from the folder that holds `data`.
    with contextlib.chdir(data.parent):
        env = habitat.Env(config=_task(habitat, path, data, config))
        place = {id(e): k for k, e in enumerate(env.episodes)}
        first: dict[str, int] = {}
        for k, episode in enumerate(env.episodes):
            first.setdefault(episode.scene_id, k)

        def annotations() -> tuple[Instance, ...]:
            scene_id = str(Path(env.current_episode.scene_id).relative_to(data / "scene_datasets"))
            if scene_id not in scenes:
                scenes[scene_id] = source.load(scene_id).mesh.instances
            return scenes[scene_id]

        agent = ChallengeAgent(
            config.detector,
            config,
            tuple(env._dataset.category_to_task_category_id),
            annotations=annotations,
        )
        for _ in range(episodes):
            observations = env.reset()
            agent.reset()
            actions = []
            while not env.episode_over:
                action = agent.act(observations)
                actions.append(action["action"])
                observations = env.step(action)
            metrics, now = env.get_metrics(), env.current_episode
            yield LabEpisode(
                scene=Path(now.scene_id).name.split(".")[0],
                index=place[id(now)] - first[now.scene_id],
                actions=tuple(actions),
                success=bool(metrics["success"]),
                spl=float(metrics["spl"]),
                soft_spl=float(metrics["soft_spl"]),
                distance_to_goal=float(metrics["distance_to_goal"]),
            )
        agent.close()
        env.close()


def _task(habitat: Any, path: Path, data: Path, config: RunConfig) -> Any:
    """habitat-lab's ObjectNav on a dataset, with a semantic sensor beside the agent's own."""
    from habitat.config.default_structured_configs import HabitatSimSemanticSensorConfig
    from omegaconf import OmegaConf, open_dict

    camera = config.env
    task = habitat.get_config(
        TASK,
        overrides=[
            f"habitat.dataset.data_path={path}",
            f"habitat.dataset.split={path.name.split('.')[0]}",
            f"habitat.dataset.scenes_dir={data / 'scene_datasets'}",
            "habitat.environment.iterator_options.shuffle=False",
            f"habitat.environment.max_episode_steps={camera.max_steps}",
            f"habitat.seed={config.seed}",
        ],
    )
    OmegaConf.set_readonly(task, False)
    with open_dict(task):
        simulator = task.habitat.simulator
        simulator.habitat_sim_v0.gpu_device_id = gpu_device()
        sensors = simulator.agents.main_agent.sim_sensors
        sensors.semantic_sensor = HabitatSimSemanticSensorConfig(
            type=_semantic_sensor(),
            hfov=round(camera.hfov_deg),
            position=[0.0, camera.camera_height_m, 0.0],
        )
        for sensor in sensors.values():
            sensor.width, sensor.height = camera.width, camera.height
            # Its sensors take positions of floats alone.
            sensor.position = [float(v) for v in sensor.position]
    return task


def _semantic_sensor() -> str:
    """The name of habitat-lab's semantic sensor with a space that numpy 2 takes too."""
    from gym import spaces
    from habitat.core.registry import registry
    from habitat.sims.habitat_simulator.habitat_simulator import HabitatSimSemanticSensor

    def space(sensor: Any, *args: Any, **kwargs: Any) -> Any:
        shape = (sensor.config.height, sensor.config.width, 1)
        return spaces.Box(low=0, high=np.iinfo(np.int32).max, shape=shape, dtype=np.int32)

    labels = type("Labels", (HabitatSimSemanticSensor,), {"_get_observation_space": space})
    registry.register_sensor(labels, name=labels.__name__)
    return labels.__name__


def _import_habitat() -> Any:
    import_habitat_sim()
    try:
        import habitat
    except ImportError as error:
        raise MissingExtraError(
            "habitat-lab is not installed: pip install 'toponav[habitat]', then "
            "pip install --no-deps habitat-lab (docs/habitat.md)"
        ) from error
    return habitat


def mean_scores(compared: list[Comparison]) -> dict[str, Any]:
    """Means of both sides, and the largest difference in any episode."""
    return {
        "episodes": len(compared),
        "habitat_lab": {
            "success": _mean([float(c.lab.success) for c in compared]),
            "spl": _mean([c.lab.spl for c in compared]),
            "soft_spl": _mean([c.lab.soft_spl for c in compared]),
            "dtg": _mean([c.lab.distance_to_goal for c in compared]),
        },
        "toponav": {
            "success": _mean([float(c.ours.success["0.1"]) for c in compared]),
            "spl": _mean([c.ours.spl for c in compared]),
            "soft_spl": _mean([c.ours.soft_spl for c in compared]),
            "dtg": _mean([c.distance_to_goal for c in compared]),
        },
        "largest_difference": max(c.difference for c in compared),
    }


def _mean(values: list[float]) -> float:
    return math.fsum(values) / len(values)
