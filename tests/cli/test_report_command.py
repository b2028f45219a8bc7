"""`toponav report`: where the page goes, what is printed, what is refused."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from made_results import made_result, missed, write_run
from small_house import SMALL
from toponav.cli.main import BAD_USAGE, OK, main
from toponav.evaluation.explanation_file import EXPLANATION_FILE


@pytest.fixture
def run(tmp_path: Path) -> Path:
    return write_run(tmp_path / "run", [made_result(), missed(index=1)])


def test_the_page_lies_in_the_first_folder(run: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["report", str(run), "--resamples", "100"]) == OK
    assert (run / "report.html").stat().st_size > 10_000
    printed = capsys.readouterr()
    assert printed.out.startswith(f"{run / 'report.html'}: 2 episodes")
    assert "2 episodes have no maps" in printed.err


def test_json_is_one_object(run: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = run.parent / "page.html"
    assert main(["report", str(run), "--out", str(out), "--json", "--names", "mine"]) == OK
    data = json.loads(capsys.readouterr().out)
    assert data == {"path": str(out), "size": out.stat().st_size, "episodes": 2, "explained": 0,
                    "pictures": 0}  # fmt: skip
    assert "mine" in out.read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("options", "word"),
    [(["nowhere"], "no such folder"), (["{run}", "--max-mb", "0"], "positive"),
     (["{run}", "--names", "a,b"], "2 names for 1 runs"), (["{run}", "{run}"], "given twice")],
)  # fmt: skip
def test_bad_usage_is_one_line(
    run: Path, options: list[str], word: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["report", *(option.format(run=run) for option in options)]) == BAD_USAGE
    error = capsys.readouterr().err
    assert word in error
    assert error.count("\n") == 1


def test_a_single_episode_has_a_page_and_a_table_too(
    house: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "one"
    assert main(["run", str(house), "--out", str(out), *SMALL, "--max-steps", "40"]) == OK
    assert (out / EXPLANATION_FILE).exists()
    assert main(["report", str(out), "--json"]) == OK
    data = json.loads(capsys.readouterr().out.splitlines()[-1])
    assert data["episodes"] == data["explained"] == 1
    assert main(["table", str(out)]) == OK
    assert "one" in capsys.readouterr().out
