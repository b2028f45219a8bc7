"""Many episodes: what is kept, what is resumed, what an impossible one becomes."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from small_house import small_config
from toponav.config import load_config
from toponav.errors import ConfigError, InputError
from toponav.evaluation.evaluate import RunProgress, evaluate, summary_line
from toponav.evaluation.run_config import RunConfig
from toponav.evaluation.run_folder import RunRequest
from toponav.scenes.generate import generate_house
from toponav.scenes.house_io import save_house

CONFIG = small_config("random", max_steps=4)
"""Short episodes: what they do does not matter here."""


def request(source: str = "generated:6", **changes: Any) -> RunRequest:
    return RunRequest(source=source, **{"record": False, **changes})


def records(folder: Path) -> list[dict[str, Any]]:
    return [json.loads(line) for line in (folder / "episodes.jsonl").read_text().splitlines()]


def timeless(folder: Path) -> list[dict[str, Any]]:
    """The records but for their times, in the order of the episodes."""
    untimed = [{**record, "seconds": None} for record in records(folder)]
    return sorted(untimed, key=lambda record: (record["scene"], record["index"]))


def run(folder: Path, asked: RunRequest, **options: Any) -> dict[str, Any]:
    folder.mkdir(exist_ok=True)
    return evaluate(asked, CONFIG, folder, **options)


def stop_after(count: int) -> Any:
    """A listener that interrupts a run once so many episodes are done."""

    def interrupt(progress: RunProgress) -> None:
        if progress.done == count and progress.outcome is not None:
            raise KeyboardInterrupt

    return interrupt


def test_episodes_are_written_before_anyone_hears_of_them(tmp_path: Path) -> None:
    told: list[tuple[int, int]] = []

    def on_progress(progress: RunProgress) -> None:
        told.append((progress.done, progress.total))
        assert (progress.outcome is None) == (progress.done == 0)
        assert len(records(tmp_path)) == progress.done == len(progress.results)

    summary = run(tmp_path, request("generated:6-7", episodes=3), on_progress=on_progress)
    keys = [(record["scene"], record["index"]) for record in records(tmp_path)]
    assert keys == [("generated_6", 0), ("generated_6", 1), ("generated_7", 0)]
    assert told == [(0, 3), (1, 3), (2, 3), (3, 3)]
    assert summary["all"]["n"] == 3
    assert summary["same_floor"]["n"] + summary["floor_change"]["n"] == 3
    assert json.loads((tmp_path / "summary.json").read_text()) == summary
    assert load_config(RunConfig, tmp_path / "config.json") == CONFIG


def test_by_default_the_scenes_own_episodes_are_run(tmp_path: Path) -> None:
    run(tmp_path, request())
    assert [record["target"] for record in records(tmp_path)] == ["toilet", "tv_monitor"]


def test_the_same_run_gives_the_same_records_but_for_the_time(tmp_path: Path) -> None:
    for name in ("first", "again"):
        run(tmp_path / name, request(episodes=3))
    assert timeless(tmp_path / "first") == timeless(tmp_path / "again")


def test_an_episode_that_its_scene_cannot_host_is_a_failure_that_says_why(tmp_path: Path) -> None:
    house = generate_house(6)
    good = house.episodes[0]
    lost = good.model_copy(update={"start": (good.start[0], good.start[1], 40.0)})
    save_house(house.model_copy(update={"episodes": [lost, good]}), tmp_path / "house.json")
    summary = run(tmp_path / "out", request(str(tmp_path / "house.json")))
    impossible, possible = records(tmp_path / "out")
    assert impossible["ended"].startswith("error: nobody can stand at")
    assert impossible["failure"] == "error"
    assert impossible["distance_to_goal"] is None
    assert not any(impossible["success"].values())
    assert possible["ended"] == "step-limit"
    assert summary["all"]["n"] == 2
    assert summary["all"]["unreachable"] == 1
    assert summary["all"]["dtg"] == pytest.approx(possible["distance_to_goal"])
    assert not (tmp_path / "out" / "errors.log").exists()  # it is no defect


def test_an_older_run_is_never_overwritten(tmp_path: Path) -> None:
    run(tmp_path, request(episodes=1))
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    with pytest.raises(InputError, match=r"episodes\.jsonl exists"):
        run(tmp_path, request(episodes=1))
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before


def test_an_interrupted_run_keeps_what_was_finished_and_goes_on_from_there(tmp_path: Path) -> None:
    whole, parts = tmp_path / "whole", tmp_path / "parts"
    complete = run(whole, request(episodes=4))
    with pytest.raises(KeyboardInterrupt):
        run(parts, request(episodes=4), on_progress=stop_after(2))
    assert timeless(parts) == timeless(whole)[:2]
    assert not (parts / "summary.json").exists()
    assert not list(parts.glob(".*"))
    before = records(parts)
    told: list[int] = []
    resumed = run(
        parts, request(episodes=4), resume=True, on_progress=lambda p: told.append(p.done)
    )
    assert told == [2, 3, 4]
    assert records(parts)[:2] == before
    assert timeless(parts) == timeless(whole)
    assert resumed == complete


def test_a_complete_run_can_be_resumed_extended_and_shortened(tmp_path: Path) -> None:
    first = run(tmp_path, request(episodes=2))
    assert run(tmp_path, request(episodes=2), resume=True) == first
    assert len(records(tmp_path)) == 2
    assert run(tmp_path, request(episodes=4), resume=True)["all"]["n"] == 4
    assert [record["index"] for record in records(tmp_path)] == [0, 1, 2, 3]
    assert run(tmp_path, request(episodes=1), resume=True)["all"]["n"] == 4


def test_resuming_with_another_configuration_is_refused(tmp_path: Path) -> None:
    run(tmp_path, request(episodes=1))
    with pytest.raises(ConfigError, match="seed was 0, is 5"):
        evaluate(request(), CONFIG.model_copy(update={"seed": 5}), tmp_path, resume=True)
    assert len(records(tmp_path)) == 1


def test_shards_together_are_the_whole_run(tmp_path: Path) -> None:
    run(tmp_path / "whole", request("generated:6-7", episodes=5))
    for k in (1, 2, 3):
        run(tmp_path / f"part{k}", request("generated:6-7", episodes=5, shard=f"{k}/3"))
    parts = [record for k in (1, 2, 3) for record in timeless(tmp_path / f"part{k}")]
    assert parts == timeless(tmp_path / "whole")


def test_the_summary_does_not_depend_on_the_order_in_which_episodes_finished(
    tmp_path: Path,
) -> None:
    complete = run(tmp_path, request(episodes=4))
    path = tmp_path / "episodes.jsonl"
    path.write_text("".join(reversed(path.read_text().splitlines(keepends=True))))
    assert run(tmp_path, request(episodes=4), resume=True) == complete


def test_what_was_recorded_of_an_episode_is_there_once_it_is_run_again(tmp_path: Path) -> None:
    run(tmp_path, request(episodes=1, record=True))
    folder = tmp_path / "episodes" / "generated_6_0"
    recorded = {path.name: path.read_bytes() for path in folder.iterdir()}
    assert recorded["trajectory.jsonl"].count(b"\n") == 4
    (tmp_path / "episodes.jsonl").write_text("{")  # a kill while it ran
    (folder / "trajectory.jsonl").write_text("half of an earlier attempt")
    (folder / ".memory.77.tmp.json").touch()
    run(tmp_path, request(episodes=1, record=True), resume=True)
    assert {path.name: path.read_bytes() for path in folder.iterdir()} == recorded


def test_no_worker_is_too_few(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="--workers takes a positive number, not 0"):
        run(tmp_path, request(workers=0))
    assert not list(tmp_path.iterdir())


def test_the_summary_in_plain_words(tmp_path: Path) -> None:
    summary = run(tmp_path, request(episodes=1))
    first, all_episodes, same_floor = summary_line(summary).splitlines()
    assert first == "random (preset paper) on generated:6"
    assert all_episodes.split()[:3] == ["all", "n", "1,"]
    assert "SR@0.1 0.0 % [0.0, 79.3]" in all_episodes
    assert same_floor.split()[:2] == ["same", "floor"]
