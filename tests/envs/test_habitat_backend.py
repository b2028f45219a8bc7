"""habitat-sim behind the environment seam, against the embedded simulator; skips without it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from toponav.envs.simulator import HouseEnvConfig
from toponav.errors import SceneError
from toponav.evaluation.objectnav_export import DatasetPlan, export_dataset
from toponav.scenes.loading import load_scene
from toponav.scenes.mesh import Scene
from toponav.types import Action

pytest.importorskip("habitat_sim", reason="habitat-sim is not installed (docs/habitat.md)")

from toponav.envs.habitat.env import HabitatEnv
from toponav.evaluation.bench_habitat import bench_habitat

CONFIG = HouseEnvConfig(width=160, height=120, max_steps=501)


@pytest.fixture(scope="module")
def exported(tmp_path_factory: pytest.TempPathFactory) -> Scene:
    """A generated house as Habitat has it."""
    folder = tmp_path_factory.mktemp("habitat") / "data"
    files = export_dataset([load_scene("generated:1")], DatasetPlan(folder, episodes=1))
    return load_scene(str(next(path for path in files if path.suffix == ".glb")))


def test_both_simulators_agree(exported: Scene) -> None:
    figures = bench_habitat(exported, CONFIG, poses=50, pairs=100, actions=500)
    assert figures["depth_m"] < 0.01
    assert figures["ids"] >= 0.99
    assert figures["rgb"] < 10.0
    assert figures["geodesic_ok"] == 1.0
    assert figures["walk"] == 500
    assert figures["walk_m"] < 0.05
    assert figures["collisions"] >= 0.998
    areas = figures["area_m2"]
    assert areas["habitat"] == pytest.approx(areas["embedded"], rel=0.005)


def test_habitat_keeps_to_the_protocol(exported: Scene) -> None:
    env = HabitatEnv(exported, CONFIG)
    try:
        env.reset(seed=0, options={"target": exported_target(exported)})
        start, heading = env.position, env.yaw
        env.step(Action.TURN_LEFT)
        assert env.yaw == pytest.approx(heading + np.radians(30.0))
        env.step(Action.TURN_RIGHT)
        before = env.observe().world_from_camera
        env.step(Action.LOOK_DOWN)
        after = env.observe().world_from_camera
        np.testing.assert_allclose(env.position, start)
        ahead = (before.rotation[:, 2], after.rotation[:, 2])
        assert np.degrees(np.arccos(ahead[0] @ ahead[1])) == pytest.approx(30.0, abs=0.1)
        assert env.observe().depth.max() <= CONFIG.max_depth_m
        env.step(Action.MOVE_FORWARD)
        assert np.linalg.norm(env.position - start) <= 0.25 + 1e-4
    finally:
        env.close()


def exported_target(scene: Scene) -> str:
    return "chair" if any(i.category == "chair" for i in scene.mesh.instances) else "bed"


def test_a_scene_without_a_file_is_refused() -> None:
    with pytest.raises(SceneError, match=r"scenes export --format habitat"):
        HabitatEnv(load_scene("generated:6"), CONFIG)


def test_a_missing_stage_is_an_error_of_ours(exported: Scene, tmp_path: Path) -> None:
    from dataclasses import replace

    with pytest.raises(SceneError, match="cannot load"):
        HabitatEnv(replace(exported, stage=tmp_path / "none.glb"), CONFIG)
