"""What one search teaches the next: in the same process, from a file, and in an evaluation."""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from small_house import SMALL, small_config, small_runner
from toponav.cli.main import main
from toponav.errors import InputError
from toponav.evaluation.recollection import Recollection
from toponav.evaluation.results import EpisodeResult
from toponav.knowledge import load_knowledge, save_knowledge
from toponav.mapping.view import MapView
from toponav.memory.graph import TopologicalMemory
from toponav.policy.affordances import Phase
from toponav.policy.decision import Decision

TOILET, TV = 0, 1
MAP = small_config(preset="default").navigator.map


class Decisions:
    def __init__(self) -> None:
        self.all: list[Decision] = []

    def on_decision(self, decision: Decision) -> None:
        self.all.append(decision)

    def on_close(self, map_view: MapView | None, memory: TopologicalMemory | None) -> None:
        """Nothing to do."""


def searched(episode: int, known: Recollection | None) -> tuple[EpisodeResult, list[Decision]]:
    runner, decisions = small_runner(preset="default"), Decisions()
    result = runner.run(runner.episode(episode), (), (decisions,), known=known)
    return result, decisions.all


@cache
def learnt() -> bytes:
    """The file that a search for the toilet leaves."""
    known = Recollection()
    searched(TOILET, known)
    assert known.knowledge is not None
    path = Path(__file__).with_name(".knowledge.npz")
    try:
        save_knowledge(known.knowledge, path)
        return path.read_bytes()
    finally:
        path.unlink()


def test_a_known_target_is_gone_to_from_the_first_decision(tmp_path: Path) -> None:
    file = tmp_path / "building.npz"
    file.write_bytes(learnt())
    cold, cold_decisions = searched(TOILET, None)
    warm, warm_decisions = searched(TOILET, Recollection(load_knowledge(file, MAP)))
    assert warm.succeeded
    assert warm_decisions[0].phase is Phase.TARGET_ACQUISITION
    assert cold_decisions[0].phase is Phase.EXPLORATION
    assert warm.steps < cold.steps
    assert warm.path_length <= cold.path_length


def test_what_is_not_what_it_was_taken_for_is_searched_for_on(tmp_path: Path) -> None:
    file = tmp_path / "building.npz"
    file.write_bytes(learnt())
    knowledge = load_knowledge(file, MAP)
    objects = knowledge.semantic_map.parts().objects
    knowledge.semantic_map.restore_object("tv_monitor", objects["toilet"])
    result, _ = searched(TV, Recollection(knowledge))
    assert result.succeeded


@pytest.mark.parametrize("content", [b"", b"PK\x03\x04 no archive", b"{}"])
def test_a_file_that_is_none_is_said(tmp_path: Path, content: bytes) -> None:
    file = tmp_path / "building.npz"
    file.write_bytes(content)
    with pytest.raises(InputError, match=str(file)):
        load_knowledge(file, MAP)
    np.savez(file, scene=np.zeros(3))
    with pytest.raises(InputError, match="format"):
        load_knowledge(file, MAP)


def test_a_method_that_forgets_says_so() -> None:
    runner = small_runner(method="frontier")
    with pytest.raises(InputError, match="toponav"):
        runner.run(runner.episode(TV), known=Recollection())


def test_a_revisit_is_the_same_every_time_and_told_apart_by_its_configuration() -> None:
    results = []
    for _ in range(2):
        runner = small_runner(preset="default", overrides={"revisit": "2"})
        results.append(runner.run(runner.episode(TV)))
    assert results[0].steps == results[1].steps
    assert results[0].path_length == results[1].path_length
    assert results[0].config_sha != searched(TV, None)[0].config_sha


def test_several_goals_on_the_command_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file, out = tmp_path / "building.npz", tmp_path / "run"
    command = ["run", "generated:6", *SMALL, "--memory", str(file), "--json"]
    assert main([*command, "--target", "tv_monitor,toilet", "--out", str(out)]) == 0
    goals = json.loads(capsys.readouterr().out)["goals"]
    assert [goal["target"] for goal in goals] == ["tv_monitor", "toilet"]
    assert (out / "2_toilet" / "topdown.png").is_file()
    assert load_knowledge(file, MAP).memory.nodes
    assert main([*command, "--target", "tv_monitor,", "--out", str(out)]) == 2
