"""`toponav table` on folders as `toponav eval` writes them."""

from __future__ import annotations

import csv
import io
import json
from pathlib import Path

import pytest

from made_results import made_config, made_result, missed, write_run
from small_house import SMALL
from toponav.cli.main import main

QUICK = ("--resamples", "200")


@pytest.fixture
def runs(tmp_path: Path) -> tuple[Path, Path]:
    first = [made_result("a", k, target=t) for k, t in enumerate(["bed", "sofa", "bed"])]
    second = [made_result("a", 0), missed("a", 1, target="sofa"), made_result("a", 2)]
    return write_run(tmp_path / "first", first), write_run(tmp_path / "second", second)


def printed(capsys: pytest.CaptureFixture[str], *arguments: object) -> str:
    assert main(["table", *map(str, arguments), *QUICK]) == 0
    return capsys.readouterr().out


def fails(capsys: pytest.CaptureFixture[str], *arguments: object, says: str) -> None:
    """Bad usage: one line that contains `says`."""
    assert main(["table", *map(str, arguments)]) == 2
    error = capsys.readouterr().err.splitlines()
    assert len(error) == 1
    assert error[0].startswith("toponav: ")
    assert says in error[0]


def test_two_runs_side_by_side(capsys: pytest.CaptureFixture[str], runs: tuple[Path, Path]) -> None:
    text = printed(capsys, *runs)
    assert "100.0 [43.9, 100.0]" in text
    assert "66.7 [20.8, 93.9]" in text
    assert "Difference from first on the common episodes" in text
    assert "\x1b" not in text


def test_json_is_one_object_with_the_promised_keys(
    capsys: pytest.CaptureFixture[str], runs: tuple[Path, Path]
) -> None:
    data = json.loads(printed(capsys, *runs, "--by", "category", "--json"))
    first, second = data["runs"]
    assert (first["n"], first["sr"]["0.1"]["rate"], second["sr"]["0.1"]["rate"]) == (3, 1.0, 2 / 3)
    assert len(first["spl"]["interval"]) == len(first["dtg"]["interval"]) == 2
    assert data["comparisons"][0]["sr"]["difference"] == pytest.approx(-1 / 3)
    assert {group["group"] for group in data["groups"]} == {"bed", "sofa"}


def test_the_same_command_prints_the_same(
    capsys: pytest.CaptureFixture[str], runs: tuple[Path, Path]
) -> None:
    first, again = (printed(capsys, *runs, "--json", "--cluster") for _ in range(2))
    assert first == again


def test_against_a_run_that_is_given_or_another_one(
    capsys: pytest.CaptureFixture[str], runs: tuple[Path, Path]
) -> None:
    first, second = runs
    for arguments in ((first, second, "--against", second), (first, "--against", second)):
        (comparison,) = json.loads(printed(capsys, *arguments, "--json"))["comparisons"]
        assert (comparison["run"], comparison["against"]) == ("first", "second")
    fails(capsys, first, "--against", first.parent, says="several runs")


def test_a_folder_of_runs_and_their_names(
    capsys: pytest.CaptureFixture[str], runs: tuple[Path, Path]
) -> None:
    data = json.loads(printed(capsys, runs[0].parent, "--names", "ours, theirs", "--json"))
    assert [run["name"] for run in data["runs"]] == ["ours", "theirs"]


def test_tables_go_into_a_file_of_the_format_that_its_name_asks_for(
    capsys: pytest.CaptureFixture[str], runs: tuple[Path, Path], tmp_path: Path
) -> None:
    out = tmp_path / "new" / "t.csv"
    assert printed(capsys, runs[0], "--out", out) == ""
    (row,) = csv.DictReader(io.StringIO(out.read_text()))
    assert (row["run"], row["n"], row["SR@0.1 [%]"]) == ("first", "3", "100.0")
    printed(capsys, runs[0], "--out", out, "--format", "latex")
    assert out.read_text().startswith("\\begin{table*}")
    assert json.loads(printed(capsys, runs[0], "--out", out, "--json"))["runs"]


def test_failures_and_their_picture(
    capsys: pytest.CaptureFixture[str], runs: tuple[Path, Path], tmp_path: Path
) -> None:
    text = printed(capsys, *runs, "--by", "failure", "--plot", tmp_path / "f.svg")
    line = next(line for line in text.splitlines() if line.strip().startswith("step limit"))
    assert line.split()[2] == "0"
    assert "How far the searches got" in text
    assert (tmp_path / "f.svg").read_text().startswith("<?xml")


def test_what_a_user_can_get_wrong(
    capsys: pytest.CaptureFixture[str], runs: tuple[Path, Path], tmp_path: Path
) -> None:
    first, second = runs
    fails(capsys, says="no run given")
    fails(capsys, tmp_path / "missing", says="no such folder")
    fails(capsys, first, first, says="given twice")
    fails(capsys, *runs, "--names", "only", says="1 names for 2 runs")
    fails(capsys, first, "--plot", "x.png", says="--by")
    fails(capsys, first, "--by", "scene", "--plot", "x.jpg", says=".png, .svg, .pdf")
    fails(capsys, first, "--resamples", "3", says="resamples")
    (second / "episodes.jsonl").write_text('{"scene": 1}\n')
    fails(capsys, *runs, says="line 1")
    (second / "episodes.jsonl").write_text("")
    fails(capsys, *runs, says="no finished episode")


def test_names_with_markup_are_shown_as_they_are(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    folder = write_run(tmp_path / "[red]a", [made_result("[bold]")])
    assert "[bold]" in printed(capsys, folder, "--by", "scene")
    assert "[red]a" in printed(capsys, folder)


def test_what_eval_wrote_is_what_table_reads(
    capsys: pytest.CaptureFixture[str], house: Path, tmp_path: Path
) -> None:
    out = tmp_path / "run"
    options = ("--method", "random", "--max-steps", "5", "--out", str(out), "--json")
    assert main(["eval", str(house), *options, *SMALL]) == 0
    summary = json.loads(capsys.readouterr().out)["all"]
    (run,) = json.loads(printed(capsys, out, "--json"))["runs"]
    assert run["n"] == summary["n"]
    assert run["dtg"]["value"] == summary["dtg"]
    assert run["sr"]["1.0"]["interval"] == summary["sr"]["1.0"]["interval"]
    assert run["protocol"]["env"]["max_steps"] == 5
    assert run["protocol"].keys() >= made_config().keys() - {"method", "preset", "navigator"}
