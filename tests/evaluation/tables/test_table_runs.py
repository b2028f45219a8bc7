"""Runs read from folders: which ones, under which names, and what is refused."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import get_args

import pytest

from made_results import made_config, made_result, made_run, missed, write_run
from toponav.errors import InputError
from toponav.evaluation.results import to_json
from toponav.evaluation.statistics import Resampling
from toponav.evaluation.tables.formats import Format, render
from toponav.evaluation.tables.report import ReportOptions, SplitKind, report
from toponav.evaluation.tables.report_data import report_data
from toponav.evaluation.tables.report_tables import report_tables
from toponav.evaluation.tables.runs import ORACLE_FOLLOWER_MARK, load_runs

RESULTS = [made_result(index=1), missed(index=0)]


def test_a_run_is_read_as_it_was_written_in_the_order_of_its_keys(tmp_path: Path) -> None:
    (run,) = load_runs([write_run(tmp_path / "a", RESULTS)])
    assert run.name == "a"
    assert run.episodes == (RESULTS[1], RESULTS[0])
    assert run.config == made_config()


def test_a_folder_of_runs_stands_for_them_in_order(tmp_path: Path) -> None:
    for name in ("b", "a", "c"):
        write_run(tmp_path / "all" / name, RESULTS)
    (tmp_path / "all" / "empty").mkdir()
    single = write_run(tmp_path / "z", RESULTS)
    assert [run.name for run in load_runs([single, tmp_path / "all"])] == ["z", "a", "b", "c"]


def test_names_are_as_long_as_it_takes_to_tell_runs_apart(tmp_path: Path) -> None:
    folders = [write_run(tmp_path / part / "run", RESULTS) for part in ("first", "second")]
    assert [run.name for run in load_runs(folders)] == ["first/run", "second/run"]
    assert [run.name for run in load_runs(folders, ["x", "y"])] == ["x", "y"]


@pytest.mark.parametrize("form", get_args(Format))
@pytest.mark.parametrize("by", [None, "category", "failure"])
def test_the_oracle_follower_is_named_in_every_table(
    by: SplitKind | None, form: Format, tmp_path: Path
) -> None:
    folders = [write_run(tmp_path / "map", RESULTS)]
    folders.append(write_run(tmp_path / "navmesh", RESULTS, follower="oracle"))
    told = report(load_runs(folders), ReportOptions(by, 0, Resampling(resamples=100)))
    named = f"navmesh{ORACLE_FOLLOWER_MARK}"
    assert [run["name"] for run in report_data(told)["runs"]] == ["map", named]
    for table in report_tables(told):
        bare = replace(table, notes=())
        assert named in " ".join(render([bare], form).split()), table.title


@pytest.mark.parametrize("names", [["x"], ["x", "x"], ["x", ""], ["x", "y", "z"]])
def test_names_that_do_not_fit(tmp_path: Path, names: list[str]) -> None:
    folders = [write_run(tmp_path / name, RESULTS) for name in "ab"]
    with pytest.raises(InputError, match="name"):
        load_runs(folders, names)


def test_what_is_no_run(tmp_path: Path) -> None:
    run = write_run(tmp_path / "a", RESULTS)
    nothing = write_run(tmp_path / "b", [])
    (tmp_path / "c").mkdir()
    for folders, says in (
        ([], "no run given"),
        ([tmp_path / "missing"], "no such folder"),
        ([tmp_path / "c"], r"no episodes\.jsonl"),
        ([nothing], "no finished episode"),
        ([run, tmp_path / "x" / ".." / "a"], "given twice"),
        ([run, run], "given twice"),
    ):
        (tmp_path / "x").mkdir(exist_ok=True)
        with pytest.raises(InputError, match=says):
            load_runs(folders)


def test_a_damaged_line_is_named_and_an_unfinished_one_left_out(tmp_path: Path) -> None:
    folder = write_run(tmp_path / "a", RESULTS)
    journal = folder / "episodes.jsonl"
    whole = journal.read_text()
    journal.write_text(whole + to_json(made_result(index=7))[:40])
    assert len(load_runs([folder])[0].episodes) == 2
    journal.write_text(whole + '{"scene": 3}\n')
    with pytest.raises(InputError, match="line 3"):
        load_runs([folder])
    journal.write_text(whole + whole)
    with pytest.raises(InputError, match="twice"):
        load_runs([folder])


def test_a_configuration_may_be_missing_but_not_damaged(tmp_path: Path) -> None:
    folder = write_run(tmp_path / "a", RESULTS)
    (folder / "config.json").unlink()
    (run,) = load_runs([folder])
    assert "protocol unknown" in run.settings()
    assert run.protocol_difference(made_run("b", RESULTS)) == ""
    for text in ("{", "[1]", '{"env": 3}'):
        (folder / "config.json").write_text(text)
        with pytest.raises(InputError, match=r"config\.json"):
            load_runs([folder])


def test_settings_state_the_protocol() -> None:
    config = made_config()
    config["env"] = {**config["env"], "width": 320, "height": 240, "max_steps": 250}
    assert made_run("a", RESULTS, **config).settings() == (
        "toponav (preset default), detector oracle, reasoner prior, camera 320 x 240, no noise, "
        "250 steps, seed 0"
    )
    config["env"]["noise"] = {**config["env"]["noise"], "depth": True}
    assert ", noise, " in made_run("a", RESULTS, **config).settings()


def test_protocols_are_compared_by_all_but_what_is_studied() -> None:
    config = json.loads(json.dumps(made_config()))
    config["method"], config["preset"] = "frontier", "paper"
    config["navigator"]["memory"]["d_merge"] = 9.0
    base = made_run("base", RESULTS)
    assert made_run("other", RESULTS, **config).protocol_difference(base) == ""
    config["env"]["max_steps"] = 7
    config["detector"] = "noisy"
    said = made_run("other", RESULTS, **config).protocol_difference(base)
    assert said == (
        "other: protocol differs from base: detector (oracle there, noisy here), "
        "env.max_steps (500 there, 7 here)"
    )
