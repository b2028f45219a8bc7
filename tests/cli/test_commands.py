"""The commands as a user runs them: results, files, JSON, determinism."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest
from PIL import Image

import toponav
from small_house import SMALL
from toponav.cli.main import COMMANDS, main
from toponav.config import load_config
from toponav.evaluation.run_config import RunConfig
from toponav.memory.serialization import load_memory
from toponav.scenes.house_io import load_house

RESULT_KEYS = {
    "scene", "index", "target", "method", "seed", "stop_called", "distance_to_goal",
    "shortest_path", "path_length", "success", "spl", "soft_spl", "steps", "collisions",
    "decisions", "vlm", "seconds", "ended", "config_sha",
}  # fmt: skip


def run_json(capsys: pytest.CaptureFixture[str], *arguments: str) -> dict[str, Any]:
    """Run a command that must succeed; stdout must be one JSON object and nothing else."""
    assert main([*arguments, "--json"]) == 0
    data = json.loads(capsys.readouterr().out)
    assert isinstance(data, dict)
    return data


@pytest.fixture(scope="module")
def searched(house: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("run")
    assert main(["run", str(house), "--preset", "paper", *SMALL, "--out", str(out)]) == 0
    return out


def test_run_leaves_everything_behind(searched: Path) -> None:
    result = json.loads((searched / "result.json").read_text())
    assert set(result) >= RESULT_KEYS
    assert set(result["success"]) == {"0.1", "0.2", "0.25", "1.0"}
    assert result["success"]["0.1"] is True
    assert result["ended"] == "stop"
    config = load_config(RunConfig, searched / "config.json")
    assert config.preset == "paper"
    assert load_memory(searched / "memory.json").nodes
    with Image.open(searched / "topdown.png") as picture:
        assert picture.format == "PNG"
    decisions = [json.loads(line) for line in (searched / "decisions.jsonl").open()]
    assert len(decisions) == result["decisions"] == len(list(searched.glob("panorama_*.jpg")))
    assert len(decisions[0]["views"]) == 12
    assert decisions[0]["memory_text"]


def test_the_trajectory_and_the_result_agree(searched: Path) -> None:
    result = json.loads((searched / "result.json").read_text())
    steps = [json.loads(line) for line in (searched / "trajectory.jsonl").open()]
    assert [step["step"] for step in steps] == list(range(result["steps"]))
    assert steps[-1]["action"] == "stop"
    moved = sum(
        sum((a - b) ** 2 for a, b in zip(now["position"], then["position"], strict=True)) ** 0.5
        for then, now in pairwise(steps)
    )
    assert moved == pytest.approx(result["path_length"], abs=1e-4)
    assert sum(step["collided"] for step in steps) == result["collisions"]


def test_the_same_seed_gives_the_same_bytes_also_in_a_fresh_process(
    searched: Path, house: Path, tmp_path: Path
) -> None:
    again, fresh = tmp_path / "again", tmp_path / "fresh"
    arguments = ["run", str(house), "--preset", "paper", *SMALL, "--out"]
    assert main([*arguments, str(again)]) == 0
    code = "import sys; from toponav.cli.main import main; sys.exit(main())"
    subprocess.run(
        [sys.executable, "-c", code, *arguments, str(fresh)],
        check=True,
        capture_output=True,
        env={**os.environ, "PYTHONHASHSEED": "12345"},
    )
    first = (searched / "trajectory.jsonl").read_bytes()
    assert first
    assert (again / "trajectory.jsonl").read_bytes() == first
    assert (fresh / "trajectory.jsonl").read_bytes() == first


def test_demo_finds_its_object(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    result = run_json(capsys, "demo", "--seed", "6", "--out", str(tmp_path / "demo"))
    assert result["success"]["0.1"] is True
    assert (tmp_path / "demo" / "topdown.png").exists()


@pytest.mark.parametrize("method", ["frontier", "random"])
def test_baselines_run(
    capsys: pytest.CaptureFixture[str], house: Path, tmp_path: Path, method: str
) -> None:
    result = run_json(
        capsys, "run", str(house), "--method", method, "--max-steps", "60", *SMALL,
        "--out", str(tmp_path),
    )  # fmt: skip
    assert result["method"] == method
    assert result["ended"] in ("stop", "step-limit")
    assert not (tmp_path / "memory.json").exists()


def test_a_start_and_a_setting_are_obeyed(
    capsys: pytest.CaptureFixture[str], house: Path, tmp_path: Path
) -> None:
    episode = load_house(house).episodes[0]
    x, y, z = episode.start
    run_json(
        capsys, "run", str(house), "--start", f"{x},{y},{z},1.5", "--max-steps", "3", *SMALL,
        "--set", "navigator.memory.d_merge=2.5", "--out", str(tmp_path),
    )  # fmt: skip
    first = json.loads((tmp_path / "trajectory.jsonl").open().readline())
    assert first["position"] == pytest.approx([x, y, z], abs=1e-6)
    assert first["yaw"] == pytest.approx(1.5)
    config = load_config(RunConfig, tmp_path / "config.json")
    assert config.navigator.memory.d_merge == 2.5


def test_eval_appends_every_episode_and_sums_up(
    capsys: pytest.CaptureFixture[str], house: Path, tmp_path: Path
) -> None:
    out = tmp_path / "eval"
    summary = run_json(
        capsys, "eval", str(house.parent), "--episodes", "3", "--max-steps", "15", *SMALL,
        "--out", str(out),
    )  # fmt: skip
    episodes = [json.loads(line) for line in (out / "episodes.jsonl").open()]
    assert [episode["index"] for episode in episodes] == [0, 1, 2]
    assert summary["all"]["n"] == 3
    assert summary["all"]["steps"] == sum(episode["steps"] for episode in episodes) / 3
    assert json.loads((out / "summary.json").read_text()) == summary
    assert main(["eval", str(house), "--out", str(out)]) == 2  # never over an older run
    assert "episodes.jsonl exists" in capsys.readouterr().err


def test_scenes_generate_info_and_export(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    made = run_json(capsys, "scenes", "generate", "generated:6-7", "--out", str(tmp_path))
    assert len(made["files"]) == 2
    info = run_json(capsys, "scenes", "info", made["files"][0])
    assert info["navigable_m2"] > 10.0
    assert set(info["targets"]) <= set(info["objects"])
    exported = tmp_path / "house.glb"
    run_json(capsys, "scenes", "export", made["files"][0], str(exported))
    reloaded = run_json(capsys, "scenes", "info", str(exported))
    assert reloaded["objects"] == info["objects"]


def test_bench_prints_frames_per_second(capsys: pytest.CaptureFixture[str]) -> None:
    size = ("--camera", "80x60", "--frames", "3")
    figures = run_json(capsys, "bench", "sim", "generated:6", *size)
    assert {"raster", "embree"} <= set(figures["sim_fps"])
    assert min(figures["sim_fps"].values()) > 0.0
    assert figures["cores"] >= 1
    options = ("--renderer", "embree", "--cores", "1")
    figures = run_json(capsys, "bench", "sim", "generated:6", *size, *options)
    assert set(figures["sim_fps"]) == {"embree"}
    assert figures["cores"] == 1


def test_the_version(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--version"]) == 0
    assert capsys.readouterr().out == f"toponav {toponav.__version__}\n"


def test_every_command_has_a_name(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["--help"])
    listed = re.search(r"\{([\w,-]+)\}", capsys.readouterr().out)
    assert listed is not None
    assert listed[1].split(",") == list(COMMANDS)


@pytest.mark.parametrize(
    "command",
    [(), *((name,) for name in COMMANDS), ("scenes", "info"), ("scenes", "generate"),
     ("scenes", "export")],
)  # fmt: skip
def test_help_everywhere(capsys: pytest.CaptureFixture[str], command: tuple[str, ...]) -> None:
    with pytest.raises(SystemExit) as exit_info:
        main([*command, "--help"])
    assert exit_info.value.code == 0
    assert "usage: toponav" in capsys.readouterr().out
