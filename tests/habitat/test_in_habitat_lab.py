"""Agents in habitat-lab's own task on an exported house; skips without habitat-sim and -lab."""

from __future__ import annotations

import math

import pytest

from small_house import small_config, small_scene
from toponav.envs.backends import EMBEDDED, HABITAT
from toponav.evaluation.objectnav_export import DatasetPlan, export_dataset
from toponav.habitat.lab_comparison import compare_with_habitat_lab, mean_scores

pytest.importorskip("habitat_sim", reason="habitat-sim is not installed (docs/habitat.md)")
habitat = pytest.importorskip("habitat", reason="habitat-lab is not installed (docs/habitat.md)")

EPISODES = 2


@pytest.fixture(scope="module")
def plan(tmp_path_factory: pytest.TempPathFactory) -> DatasetPlan:
    """Episodes of the small house as a dataset."""
    plan = DatasetPlan(tmp_path_factory.mktemp("lab") / "data", episodes=EPISODES)
    export_dataset([small_scene()], plan)
    return plan


@pytest.mark.parametrize("backend", [EMBEDDED, HABITAT])
def test_habitat_labs_scores_are_ours(plan: DatasetPlan, backend: str) -> None:
    config = small_config(preset="default").model_copy(update={"backend": backend})
    compared = compare_with_habitat_lab(plan.file, plan.data, EPISODES, config)
    assert [one.lab.index for one in compared] == list(range(EPISODES))
    assert all(math.isfinite(one.lab.distance_to_goal) for one in compared)
    assert mean_scores(compared)["largest_difference"] < 1e-3
