"""What can go wrong with `eval` and `study`: one line, the right exit code, nothing lost."""

from __future__ import annotations

import gzip
import json
import shutil
import socket
from pathlib import Path
from typing import Any

import pytest

from shared_data import shared_data
from small_house import SMALL
from toponav.cli.main import main

QUICK = ("--method", "random", "--max-steps", "3", "--no-record", *SMALL)


def fails(capsys: pytest.CaptureFixture[str], *arguments: object, says: str, code: int = 2) -> None:
    """The command must fail with one line that contains `says`, and nothing on stdout."""
    assert main([str(argument) for argument in arguments]) == code
    captured = capsys.readouterr()
    assert captured.out == ""
    error = [line for line in captured.err.splitlines() if line.startswith("toponav: ")]
    assert len(error) == 1
    assert says in error[0], error[0]
    assert "Traceback" not in captured.err


@pytest.mark.parametrize(
    ("options", "says"),
    [
        (("--method", "magic"), "unknown method 'magic'; known: cow, esc, frontier, "),
        (("--shard", "3/2"), "--shard"),
        (("--shard", "half"), "--shard"),
        (("--workers", "0"), "--workers"),
        (("--episodes", "0"), "--episodes"),
        (("--set", "perception.recall=2"), "perception.recall"),
        (("--labels", "nowhere.json", "--set", "nonsense"), "key=value"),
    ],
)
def test_wrong_options(
    capsys: pytest.CaptureFixture[str],
    house: Path,
    tmp_path: Path,
    options: tuple[str, ...],
    says: str,
) -> None:
    out = tmp_path / "out"
    rest = QUICK[2:] if "--method" in options else QUICK
    assert main(["eval", str(house), *rest, *options, "--out", str(out)]) == 2
    captured = capsys.readouterr()
    assert says in captured.err
    assert not (out / "episodes.jsonl").exists()


@pytest.mark.parametrize("options", [("--preset", "best"), ("--episodes", "many")])
def test_what_the_parser_refuses(
    capsys: pytest.CaptureFixture[str], house: Path, tmp_path: Path, options: tuple[str, str]
) -> None:
    with pytest.raises(SystemExit) as ended:
        main(["eval", str(house), *options, "--out", str(tmp_path / "out")])
    assert ended.value.code == 2
    assert options[0] in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("source", ["nowhere.json", "generated:5-2", "generated:x", "nowhere"])
def test_a_source_that_is_none(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, source: str
) -> None:
    out = tmp_path / "out"
    fails(capsys, "eval", source, *QUICK, "--out", out, says=source.rsplit(":", maxsplit=1)[-1])
    assert not (out / "episodes.jsonl").exists()


def test_one_bad_house_of_a_folder_is_named_before_anything_runs(
    capsys: pytest.CaptureFixture[str], house: Path, tmp_path: Path
) -> None:
    homes = tmp_path / "homes"
    homes.mkdir()
    shutil.copy(house, homes / "a.json")
    (homes / "b.json").write_text("{not json")
    fails(capsys, "eval", homes, *QUICK, "--out", tmp_path / "out", says="b.json")
    assert not (tmp_path / "out" / "episodes.jsonl").exists()


def test_an_output_that_is_a_file(
    capsys: pytest.CaptureFixture[str], house: Path, tmp_path: Path
) -> None:
    (tmp_path / "out").write_text("mine")
    fails(capsys, "eval", house, *QUICK, "--out", tmp_path / "out", says="output folder")
    assert (tmp_path / "out").read_text() == "mine"


def test_results_are_neither_overwritten_nor_mixed(
    capsys: pytest.CaptureFixture[str], house: Path, tmp_path: Path
) -> None:
    out = tmp_path / "out"
    assert main(["eval", str(house), *QUICK, "--out", str(out)]) == 0
    before = (out / "episodes.jsonl").read_bytes()
    capsys.readouterr()
    fails(capsys, "eval", house, *QUICK, "--out", out, says="--resume")
    changed = ("--set", "navigator.memory.d_merge=4", "--resume")
    fails(capsys, "eval", house, *QUICK, *changed, "--out", out, says="navigator.memory.d_merge")
    assert (out / "episodes.jsonl").read_bytes() == before


def test_a_cluster_that_does_not_answer_is_said_at_once(
    capsys: pytest.CaptureFixture[str], house: Path, tmp_path: Path
) -> None:
    pytest.importorskip("ray", reason="needs the extra `ray`")
    with socket.socket() as closed:
        closed.bind(("127.0.0.1", 0))
        address = f"127.0.0.1:{closed.getsockname()[1]}"
    asked = ("eval", house, *QUICK, "--workers", 2, "--out", tmp_path / "out", "--ray-address")
    fails(capsys, *asked, address, says=f"{address}: nothing answers there")
    fails(capsys, *asked, "somewhere", says="HOST:PORT")


def episode_file(path: Path, **changes: Any) -> Path:
    """An ObjectNav file of one episode in a scene that is not here."""
    episode = {
        "episode_id": "0",
        "scene_id": "hm3d/val/00800-x/x.basis.glb",
        "start_position": [0.0, 0.0, 0.0],
        "start_rotation": [0.0, 0.0, 0.0, 1.0],
        "object_category": "chair",
        "info": {"geodesic_distance": 2.0},
        "goals": [],
        **changes,
    }
    text = json.dumps({"episodes": [episode], "goals_by_category": {"x.basis.glb_chair": []}})
    path.write_bytes(gzip.compress(text.encode()))
    return path


@pytest.mark.parametrize("kept", [0, 5, 40, 120])
def test_an_episode_file_that_is_cut_short(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, kept: int
) -> None:
    path = episode_file(tmp_path / "val.json.gz")
    path.write_bytes(path.read_bytes()[:kept])
    fails(capsys, "eval", path, *QUICK, "--out", tmp_path / "out", says="val.json.gz")
    assert not (tmp_path / "out" / "episodes.jsonl").exists()


def test_an_episode_file_with_a_wrong_field_names_it(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    path = episode_file(tmp_path / "val.json.gz", start_position=[0.0, "high"])
    fails(capsys, "eval", path, *QUICK, "--out", tmp_path / "out", says="start_position")


def test_a_missing_scene_of_a_published_file_is_named_with_its_place(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    path = shared_data("objectnav/hm3d/v2/val_mini/val_mini.json.gz")
    data = tmp_path / "data"
    options = ("--data", data, "--out", tmp_path / "out")
    fails(capsys, "eval", path, *QUICK, *options, says=str(data / "scene_datasets"))


def test_an_unknown_study_lists_those_known(
    capsys: pytest.CaptureFixture[str], house: Path, tmp_path: Path
) -> None:
    fails(
        capsys, "study", "magic", house, "--out", tmp_path / "out",
        says="unknown study 'magic'; known: goal-detection, node-information, ",
    )  # fmt: skip
    assert not (tmp_path / "out").exists()
