"""Many episodes: how they are shared out, what is kept, what an impossible one becomes."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from small_house import small_config
from toponav.config import load_config
from toponav.errors import InputError
from toponav.evaluation.evaluate import evaluate, summary_line
from toponav.evaluation.results import EpisodeResult
from toponav.evaluation.run_config import RunConfig
from toponav.scenes.generate import generate_house
from toponav.scenes.house_io import save_house

CONFIG = small_config("random", max_steps=4)
"""Short episodes: what they do does not matter here."""


def records(folder: Path) -> list[dict[str, Any]]:
    return [json.loads(line) for line in (folder / "episodes.jsonl").read_text().splitlines()]


def test_episodes_are_spread_evenly_and_the_first_scenes_get_the_remainder(tmp_path: Path) -> None:
    told: list[tuple[int, int | None]] = []

    def on_result(done: int, total: int | None, result: EpisodeResult) -> None:
        told.append((done, total))
        assert len(records(tmp_path)) == done  # on the disk before anyone hears of it

    summary = evaluate("generated:6-7", CONFIG, tmp_path, episodes=3, on_result=on_result)
    keys = [(record["scene"], record["index"]) for record in records(tmp_path)]
    assert keys == [("generated_6", 0), ("generated_6", 1), ("generated_7", 0)]
    assert told == [(1, 3), (2, 3), (3, 3)]
    assert summary["all"]["n"] == 3
    assert summary["same_floor"]["n"] + summary["floor_change"]["n"] == 3
    assert json.loads((tmp_path / "summary.json").read_text()) == summary
    assert load_config(RunConfig, tmp_path / "config.json") == CONFIG


def test_by_default_the_scenes_own_episodes_are_run(tmp_path: Path) -> None:
    evaluate("generated:6", CONFIG, tmp_path)
    assert [record["target"] for record in records(tmp_path)] == ["toilet", "tv_monitor"]


def test_the_same_run_gives_the_same_records_but_for_the_time(tmp_path: Path) -> None:
    for name in ("first", "again"):
        evaluate("generated:6", CONFIG, tmp_path / name, episodes=3)
    first, again = (
        [{**r, "seconds": 0} for r in records(tmp_path / n)] for n in ("first", "again")
    )
    assert first == again


def test_an_episode_that_its_scene_cannot_host_is_a_failure_that_says_why(tmp_path: Path) -> None:
    house = generate_house(6)
    good = house.episodes[0]
    lost = good.model_copy(update={"start": (good.start[0], good.start[1], 40.0)})
    save_house(house.model_copy(update={"episodes": [lost, good]}), tmp_path / "house.json")
    summary = evaluate(str(tmp_path / "house.json"), CONFIG, tmp_path / "out")
    impossible, run = records(tmp_path / "out")
    assert impossible["ended"].startswith("error: nobody can stand at")
    assert impossible["distance_to_goal"] is None
    assert not any(impossible["success"].values())
    assert run["ended"] == "step-limit"
    assert summary["all"]["n"] == 2
    assert summary["all"]["unreachable"] == 1
    assert summary["all"]["dtg"] == pytest.approx(run["distance_to_goal"])


def test_an_older_run_is_never_overwritten(tmp_path: Path) -> None:
    evaluate("generated:6", CONFIG, tmp_path, episodes=1)
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    with pytest.raises(InputError, match=r"episodes\.jsonl exists"):
        evaluate("generated:6", CONFIG, tmp_path, episodes=1)
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before


def test_an_interrupted_run_keeps_what_was_finished(tmp_path: Path) -> None:
    def interrupt(done: int, total: int | None, result: EpisodeResult) -> None:
        if done == 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        evaluate("generated:6", CONFIG, tmp_path, episodes=4, on_result=interrupt)
    assert [record["index"] for record in records(tmp_path)] == [0, 1]
    assert not (tmp_path / "summary.json").exists()
    assert not list(tmp_path.glob(".*"))


def test_the_summary_in_plain_words(tmp_path: Path) -> None:
    summary = evaluate("generated:6", CONFIG, tmp_path, episodes=1)
    first, all_episodes, same_floor = summary_line(summary).splitlines()
    assert first == "random (preset paper) on generated:6"
    assert all_episodes.split()[:3] == ["all", "n", "1,"]
    assert "SR@0.1 0.0 % [0.0, 79.3]" in all_episodes
    assert same_floor.split()[:2] == ["same", "floor"]
