"""What an evaluation runs on: scenes, and a dataset's episodes in scenes of its own."""

from __future__ import annotations

import gzip
import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import ArrayLike

from small_house import small_config, small_runner
from toponav.errors import InputError, SceneError
from toponav.evaluation.evaluate import evaluate
from toponav.evaluation.journal import read_results
from toponav.evaluation.run_folder import RunRequest
from toponav.evaluation.sources import ObjectNavSource, SceneSource, open_source
from toponav.geometry.conventions import WORLD_FROM_HABITAT
from toponav.scenes.export import export_house
from toponav.scenes.generate import generate_house

SCENE_ID = "mine/small/small.glb"


def in_habitat(point: ArrayLike) -> list[float]:
    return [float(v) for v in WORLD_FROM_HABITAT.inverse().apply(point)]


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A data folder with the small house as a mesh, and its episodes in Habitat's format."""
    folder = tmp_path_factory.mktemp("data")
    scene = folder / "scene_datasets" / SCENE_ID
    scene.parent.mkdir(parents=True)
    export_house(generate_house(6), scene)
    runner = small_runner("random", max_steps=30)
    episodes: list[dict[str, Any]] = []
    goals: dict[str, Any] = {}
    for index in range(2):
        spec = runner.episode(index)
        runner.check(spec)
        turn = spec.episode.yaw - math.pi / 2
        episodes.append(
            {
                "episode_id": str(index), "scene_id": SCENE_ID,
                "start_position": in_habitat(spec.episode.start),
                "start_rotation": [0.0, math.sin(turn / 2), 0.0, math.cos(turn / 2)],
                "info": {"geodesic_distance": runner.env.oracle.distance_to_goal(),
                         "euclidean_distance": 0.0},
                "object_category": spec.episode.target,
            }
        )  # fmt: skip
        viewpoints = [
            {"agent_state": {"position": in_habitat(point), "rotation": [0, 0, 0, 1]}}
            for point in runner.env.oracle.viewpoints(spec.episode.target)
        ]
        goals[f"small.glb_{spec.episode.target}"] = [
            {"position": [0, 0, 0], "object_id": index, "object_category": spec.episode.target,
             "view_points": viewpoints}
        ]  # fmt: skip
    content = {
        "episodes": episodes, "goals_by_category": goals, "category_to_task_category_id": {},
    }  # fmt: skip
    (folder / "val.json.gz").write_bytes(gzip.compress(json.dumps(content).encode()))
    return folder


def test_a_dataset_s_episodes_run_in_its_scenes(data: Path, tmp_path: Path) -> None:
    """The same starts, goals and walks as in the house itself: the same numbers."""
    config = small_config("random", max_steps=30)
    request = RunRequest(source=str(data / "val.json.gz"), data=data)
    evaluate(request, config, tmp_path)
    results = read_results(tmp_path)
    runner = small_runner("random", max_steps=30)
    assert [result.key for result in results] == [("small", 0), ("small", 1)]
    for result in results:
        runner.check(runner.episode(result.index))
        assert result.shortest_path == pytest.approx(runner.env.oracle.distance_to_goal(), abs=0.1)
        assert result.steps == 30


def test_the_start_pose_is_that_of_the_file(data: Path) -> None:
    source = ObjectNavSource(data / "val.json.gz", data)
    [outline] = source.outlines()
    assert (outline.name, outline.episodes) == ("small", 2)
    scene, own = source.load(outline.spec), small_runner("random", max_steps=30)
    for index, episode in enumerate(scene.episodes):
        expected = own.episode(index).episode
        assert episode.target == expected.target
        np.testing.assert_allclose(episode.start, expected.start, atol=1e-6)
        assert math.remainder(episode.yaw - expected.yaw, math.tau) == pytest.approx(0.0, abs=1e-6)
        np.testing.assert_allclose(
            scene.viewpoints[episode.target], own.env.oracle.viewpoints(expected.target), atol=1e-6
        )


def test_a_scene_that_is_not_there_stops_the_run_before_it_begins(
    data: Path, tmp_path: Path
) -> None:
    request = RunRequest(source=str(data / "val.json.gz"), data=tmp_path / "elsewhere")
    with pytest.raises(SceneError, match=r"elsewhere/scene_datasets/mine/small/small.glb: no such"):
        evaluate(request, small_config("random"), tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_sources_are_told_apart(data: Path) -> None:
    assert isinstance(open_source(str(data / "val.json.gz"), None, data), ObjectNavSource)
    assert isinstance(open_source("generated:0-3", None, data), SceneSource)


def test_outlines_know_names_and_episodes_without_building(tmp_path: Path) -> None:
    spec = "generated:6-7?episodes=3"
    outlines = SceneSource(spec).outlines()
    assert [(o.name, o.episodes) for o in outlines] == [("generated_6", 3), ("generated_7", 3)]
    assert [SceneSource(spec).load(o.spec).name for o in outlines] == [o.name for o in outlines]
    with pytest.raises(InputError, match="no such file"):
        SceneSource(str(tmp_path / "absent.json")).outlines()
