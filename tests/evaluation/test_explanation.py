"""What explains decisions: the same actions with and without it, and a file that reads back."""

from __future__ import annotations

import base64
import gzip
import io
import json
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from PIL import Image

from chat_server import GOOD, chat_server
from small_house import small_config, small_runner
from toponav.errors import InputError
from toponav.evaluation.evaluate import evaluate
from toponav.evaluation.explanation import HEAT_LEVELS, ExplanationRecorder
from toponav.evaluation.explanation_file import (
    EXPLANATION_FILE,
    Explanation,
    load_explanation,
    runs_of,
    save_explanation,
    values_of,
)
from toponav.evaluation.run_folder import RunRequest
from toponav.mapping.view import FREE, OCCUPIED, UNKNOWN, MapView
from toponav.memory.graph import TopologicalMemory
from toponav.policy.decision import Decision, DecisionListener
from toponav.types import Action, Observation


@dataclass
class Watcher:
    """Every action and decision of an episode."""

    actions: list[Action] = field(default_factory=list)
    decisions: list[Decision] = field(default_factory=list)

    def on_step(self, observation: Observation, action: Action) -> None:
        self.actions.append(action)

    def on_decision(self, decision: Decision) -> None:
        self.decisions.append(decision)

    def on_close(self, map_view: MapView | None, memory: TopologicalMemory | None) -> None:
        """Nothing is kept."""


SIDES = st.tuples(st.integers(1, 9), st.integers(1, 9))


def watched(preset: str, folder: Path | None = None) -> Watcher:
    runner, watcher = small_runner(preset=preset), Watcher()
    spec = runner.episode(1)
    listeners: list[DecisionListener] = [watcher]
    if folder is not None:
        listeners.append(ExplanationRecorder(folder, spec.episode.target))
    runner.run(spec, (watcher,), listeners)
    return watcher


@cache
def explained(preset: str, folder: Path) -> tuple[Watcher, Explanation]:
    folder.mkdir(exist_ok=True)
    watcher = watched(preset, folder)
    return watcher, load_explanation(folder / EXPLANATION_FILE)


@pytest.fixture(params=["default", "paper"])
def episode(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> tuple[Watcher, Explanation]:
    base = tmp_path_factory.getbasetemp()
    return explained(request.param, base / f"explained_{request.param}")


@pytest.mark.parametrize("preset", ["default", "paper"])
def test_recording_changes_no_action(preset: str, tmp_path: Path) -> None:
    assert watched(preset, tmp_path).actions == watched(preset).actions


def test_every_decision_is_explained_with_the_map_as_it_was(
    episode: tuple[Watcher, Explanation],
) -> None:
    watcher, explanation = episode
    assert len(explanation.decisions) == len(watcher.decisions) > 1
    for decision, record in zip(watcher.decisions, explanation.decisions, strict=True):
        cells = values_of(record.map.cells, record.map.shape)
        grid = decision.map_view.grid.cells
        np.testing.assert_array_equal(cells == 0, grid == UNKNOWN)
        np.testing.assert_array_equal(cells == 2, grid == OCCUPIED)
        np.testing.assert_array_equal((cells == 1) | (cells == 3), grid == FREE)
        assert np.count_nonzero(cells == 3) == len(decision.map_view.frontiers)


def test_objects_lie_where_they_are_mapped(episode: tuple[Watcher, Explanation]) -> None:
    watcher, explanation = episode
    view, record = watcher.decisions[-1].map_view, explanation.decisions[-1].map
    layer = values_of(record.objects, record.shape)
    assert record.categories
    for index, category in enumerate(record.categories):
        cells = np.argwhere(layer == index + 1)
        own = {tuple(cell) for cell in view.grid.index_of(view.objects[category].points[:, :2])}
        assert {tuple(cell) for cell in cells} <= own


def test_the_memory_is_that_of_the_decision(episode: tuple[Watcher, Explanation]) -> None:
    watcher, explanation = episode
    for decision, record in zip(watcher.decisions, explanation.decisions, strict=True):
        assert decision.memory is not None
        assert [n.model_dump() for n in record.nodes] == [vars(n) for n in decision.memory.nodes]
        assert record.history == decision.memory.history


def test_each_panorama_is_a_strip_of_its_views(episode: tuple[Watcher, Explanation]) -> None:
    watcher, explanation = episode
    for decision, record in zip(watcher.decisions, explanation.decisions, strict=True):
        assert record.panorama is not None
        image = Image.open(io.BytesIO(base64.b64decode(record.panorama)))
        assert image.format == "WEBP"
        assert image.width % len(decision.panorama) == 0


def test_the_plan_is_told_in_its_order(tmp_path_factory: pytest.TempPathFactory) -> None:
    base = tmp_path_factory.getbasetemp()
    watcher, explanation = explained("default", base / "explained_default")
    planned = [
        (decision, record)
        for decision, record in zip(watcher.decisions, explanation.decisions, strict=True)
        if record.frontiers
    ]
    assert planned
    for decision, record in planned:
        assert decision.waypoint is not None
        assert record.frontiers[0].at == pytest.approx(decision.waypoint[:2], abs=1e-3)
        ranks = [frontier.rank for frontier in record.frontiers if frontier.rank is not None]
        assert ranks == list(range(len(ranks)))
        assert record.map.heat is None


def test_the_affordances_peak_at_the_waypoint(tmp_path_factory: pytest.TempPathFactory) -> None:
    base = tmp_path_factory.getbasetemp()
    watcher, explanation = explained("paper", base / "explained_paper")
    decision, record = watcher.decisions[0], explanation.decisions[0]
    assert record.map.heat is not None
    assert decision.waypoint is not None
    assert decision.affordances is not None
    heat = values_of(record.map.heat, record.map.shape)
    i, j = decision.map_view.grid.index_of(decision.waypoint)
    assert heat[i, j] > 1
    assert heat.max() == 2 + HEAT_LEVELS
    assert {term.name for term in record.terms} == set(decision.affordances.terms)


def test_an_accepted_target_is_among_the_candidates(
    tmp_path_factory: pytest.TempPathFactory,
) -> None:
    base = tmp_path_factory.getbasetemp()
    _, explanation = explained("default", base / "explained_default")
    chosen = [c for record in explanation.decisions for c in record.candidates if c.chosen]
    assert chosen
    for candidate in chosen:
        said = sum(side.log_odds for side in candidate.sides)
        assert candidate.log_odds == pytest.approx(said + candidate.verdict)
        assert all(low <= high for low, high in zip(candidate.low, candidate.high, strict=True))


def test_the_last_map_is_there(episode: tuple[Watcher, Explanation]) -> None:
    _, explanation = episode
    assert explanation.end is not None
    known = [np.count_nonzero(values_of(m.cells, m.shape)) for m in
             (explanation.decisions[-1].map, explanation.end)]  # fmt: skip
    assert known[1] >= known[0] > 0


def test_the_picture_shows_the_last_floor(episode: tuple[Watcher, Explanation]) -> None:
    _, explanation = episode
    picture = explanation.picture
    assert picture is not None
    image = Image.open(io.BytesIO(base64.b64decode(picture.image)))
    width, height = (h - low for low, h in zip(picture.low, picture.high, strict=True))
    assert image.width / image.height == pytest.approx(width / height, rel=1e-3)


def test_the_same_episode_makes_the_same_file(tmp_path: Path) -> None:
    for name in ("a", "b"):
        (tmp_path / name).mkdir()
        watched("default", tmp_path / name)
    first, second = (tmp_path / name / EXPLANATION_FILE for name in ("a", "b"))
    assert first.read_bytes() == second.read_bytes()


@given(arrays(np.int64, SIDES, elements=st.integers(0, 3)))
def test_runs_read_back(values: np.ndarray[Any, Any]) -> None:
    shape = (values.shape[0], values.shape[1])
    np.testing.assert_array_equal(values_of(runs_of(values), shape), values)


def damaged(path: Path, **changes: Any) -> Path:
    data = json.loads(Explanation(target="bed").model_dump_json())
    path.write_bytes(gzip.compress(json.dumps({**data, **changes}).encode()))
    return path


def test_what_is_no_explanation_is_refused_in_one_line(tmp_path: Path) -> None:
    path = tmp_path / EXPLANATION_FILE
    save_explanation(Explanation(target="bed"), path)
    assert load_explanation(path).target == "bed"
    cell = {"origin": [0, 0], "resolution": 0.1, "shape": [2, 2], "objects": [0, 4],
            "categories": [], "cells": [0, 3]}  # fmt: skip
    decision = {"index": 0, "floor": 0, "map": cell}
    for changes in ({"format": "x/2"}, {"target": 3}, {"decisions": [decision]}):
        with pytest.raises(InputError, match="explanation") as raised:
            load_explanation(damaged(path, **changes))
        assert "\n" not in str(raised.value)
    path.write_bytes(path.read_bytes()[:20])
    with pytest.raises(InputError, match="cannot be read"):
        load_explanation(path)


def test_a_decision_tells_how_many_questions_a_model_has_answered(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("OPENAI_API_KEY", "sk-test")
    with chat_server(lambda body: json.dumps({**GOOD, "direction": 0})) as server:
        overrides = {"reasoner": "openai", "reasoning.openai.base_url": server.url,
                     "reasoning.openai.price_per_million": "[1, 1]"}  # fmt: skip
        config = small_config(max_steps=40, overrides=overrides)
        evaluate(RunRequest(source="generated:6", episodes=1), config, tmp_path)
    (explained,) = tmp_path.rglob(EXPLANATION_FILE)
    told = [record.exchanges for record in load_explanation(explained).decisions]
    (calls,) = (tmp_path / "calls").glob("*.jsonl")
    asked = [json.loads(line) for line in calls.read_text().splitlines()]
    lines = (explained.parent / "decisions.jsonl").read_text().splitlines()
    for first, last, line in zip([0, *told], told, lines, strict=False):
        place = json.loads(line)["node"]
        texts = [call["text"] for call in asked[first:last] if call["prompt"] == "guidance"]
        assert len(texts) == 1
        assert f"the robot is at place {place}" in texts[0]
