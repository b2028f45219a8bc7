"""What a user can get wrong: one clear line, the right exit code, nothing half-written."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from PIL import Image

from small_house import SMALL
from toponav.cli.main import main

SQUARE = [[0, 0], [4, 0], [4, 4], [0, 4]]


def house_text(**changes: Any) -> str:
    room = {"id": "r1", "type": "bedroom", "polygon": SQUARE, "height": 2.6}
    bed = {"id": "o1", "category": "bed", "position": [2, 3, 0], "size": [1.4, 1.4, 0.8]}
    room.update(changes.pop("room", {}))
    bed.update(changes.pop("object", {}))
    level = {"floor": 0.0, "rooms": [room], "objects": [bed]}
    return json.dumps({"format": "toponav-house/1", "name": "t", "levels": [level], **changes})


def recording(folder: Path, frames: int = 2) -> Path:
    folder.mkdir()
    np.savetxt(folder / "camera-intrinsics.txt", [[20, 0, 16], [0, 20, 12], [0, 0, 1]])
    (folder / "recording.json").write_text('{"floor_z": -1.0, "gravity_aligned": true}')
    for k in range(frames):
        stem = folder / f"frame-{k:06d}"
        Image.new("RGB", (32, 24), (90, 90, 90)).save(f"{stem}.color.png")
        Image.fromarray(np.full((24, 32), 1500, np.uint16)).save(f"{stem}.depth.png")
        np.savetxt(f"{stem}.pose.txt", np.eye(4))
    return folder


def fails(capsys: pytest.CaptureFixture[str], *arguments: str, says: str, code: int = 2) -> None:
    """The command must fail with one line that contains `says`."""
    assert main(list(arguments)) == code
    error = [line for line in capsys.readouterr().err.splitlines() if line.startswith("toponav: ")]
    assert len(error) == 1
    assert says in error[0], error[0]


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (house_text(room={"polygon": [[0, 0], [4, 4], [4, 0], [0, 4]]}), "polygon"),
        (house_text(colour="red"), "colour"),
        (house_text(object={"mesh": "missing.glb"}), "missing.glb"),
        (house_text(object={"size": [1, -1, 1]}), "levels[0].objects[0].size"),
        ("{not json", "JSON"),
        (house_text(format="toponav-house/9"), "format"),
    ],
)
def test_wrong_houses(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, text: str, says: str
) -> None:
    path = tmp_path / "house.json"
    path.write_text(text)
    fails(capsys, "run", str(path), "--out", str(tmp_path / "out"), says=says)
    assert not (tmp_path / "out").exists()


def test_an_empty_folder(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    empty = tmp_path / "empty"
    empty.mkdir()
    fails(capsys, "eval", str(empty), "--out", str(tmp_path / "out"), says="no scene")


@pytest.mark.parametrize("count", ["0", "-1"])
def test_counts_that_leave_nothing_to_do(
    capsys: pytest.CaptureFixture[str], house: Path, tmp_path: Path, count: str
) -> None:
    out = tmp_path / "out"
    fails(capsys, "eval", str(house), "--episodes", count, "--out", str(out), says="--episodes")
    fails(capsys, "bench", "sim", str(house), "--frames", count, says="--frames")
    assert not out.exists()


def test_a_mesh_without_floor(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    wall = trimesh.creation.box(extents=(0.05, 2.0, 2.0))
    path = tmp_path / "wall.glb"
    trimesh.Scene({"wall": wall}).export(path)
    fails(capsys, "scenes", "info", str(path), says="floor")


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["--target", "unicorn"], "no reachable unicorn; it has"),
        (["--start", "99,99,0,0"], "nobody can stand at 99.00"),
        (["--start", "1,2"], "--start takes x,y,z,yaw"),
        (["--max-steps", "0"], "max_steps"),
        (["--seed", "-1"], "seed"),
        (["--start", "nan,0,0,0"], "NaN"),
        (["--camera", "big"], "WIDTHxHEIGHT"),
        (["--method", "magic"], "unknown method 'magic'; known: cow, "),
        (["--detector", "magic"], "unknown detector 'magic'; known: noisy, onnx, oracle"),
        (["--reasoner", "magic"], "unknown reasoner 'magic'; known: noisy, openai, prior"),
        (["--set", "navigator.memory.nonsense=1"], "navigator.memory.nonsense"),
        (["--set", "navigator.memory.d_merge=far"], "d_merge"),
        (["--set", "nonsense"], "key=value"),
        (["--labels", "labels.json"], "label table"),
    ],
)
def test_wrong_options(
    capsys: pytest.CaptureFixture[str], house: Path, tmp_path: Path, arguments: list[str], says: str
) -> None:
    out = tmp_path / "out"
    fails(capsys, "run", str(house), *arguments, "--out", str(out), says=says)
    assert not out.exists() or not list(out.iterdir())


@pytest.mark.parametrize(
    "spec", ["generated:x", "generated:5-2", "generated:1?rooms=99", "no.json"]
)
def test_wrong_scenes(capsys: pytest.CaptureFixture[str], tmp_path: Path, spec: str) -> None:
    fails(capsys, "run", spec, "--out", str(tmp_path / "out"), says=spec.partition("?")[0])


def test_an_output_that_is_a_file(
    capsys: pytest.CaptureFixture[str], house: Path, tmp_path: Path
) -> None:
    (tmp_path / "out").write_text("mine")
    fails(capsys, "run", str(house), "--out", str(tmp_path / "out"), says="output folder")
    assert (tmp_path / "out").read_text() == "mine"


def test_an_unknown_option_is_usage(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as exit_info:
        main(["demo", "--sed", "3"])
    assert exit_info.value.code == 2
    assert "--sed" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["dmeo"], "unknown command 'dmeo' (did you mean 'demo'?)"),
        (["help"], "unknown command 'help'"),
        ([], "give a command: demo, run, eval"),
    ],
)
def test_what_is_no_command_is_said_in_one_line(
    capsys: pytest.CaptureFixture[str], words: list[str], says: str
) -> None:
    fails(capsys, *words, says=says)


def truncate(path: Path) -> None:
    path.write_bytes(path.read_bytes()[:60])


@pytest.mark.parametrize(
    ("name", "damage", "says"),
    [
        ("frame-000001.pose.txt", Path.unlink, "frame-000001.color.png has no .pose file"),
        ("frame-000001.depth.png", truncate, "frame-000001.depth.png"),
        ("frame-000001.color.png", truncate, "frame-000001.color.png"),
        (
            "frame-000001.pose.txt",
            lambda path: np.savetxt(path, np.diag([2.0, 1, 1, 1])),
            "not a rotation",
        ),
        (
            "frame-000001.pose.txt",
            lambda path: np.savetxt(path, np.full((4, 4), np.nan)),
            "frame-000001.pose.txt",
        ),
    ],
)
def test_damaged_recordings(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, name: str, damage: Any, says: str
) -> None:
    folder = recording(tmp_path / "recording")
    damage(folder / name)
    out = tmp_path / "out"
    fails(capsys, "map", str(folder), "--world", "y-down", "--out", str(out), says=says)
    assert not out.exists() or not list(out.iterdir())


def test_interrupting_an_evaluation_leaves_readable_results(house: Path, tmp_path: Path) -> None:
    code = "import sys; from toponav.cli.main import main; sys.exit(main())"
    process = subprocess.Popen(
        [sys.executable, "-c", code, "eval", str(house), "--episodes", "80", "--max-steps", "8",
         *SMALL, "--out", str(tmp_path)],
        stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    results = tmp_path / "episodes.jsonl"
    deadline = time.monotonic() + 120.0
    while not (results.exists() and results.read_text().count("\n") >= 2):
        assert process.poll() is None
        assert time.monotonic() < deadline
        time.sleep(0.05)
    process.send_signal(signal.SIGINT)
    _, error = process.communicate(timeout=60)
    assert process.returncode == 130
    assert "interrupted" in error
    assert "Traceback" not in error
    lines = results.read_text().splitlines()
    assert len(lines) >= 2
    assert all(json.loads(line)["scene"] for line in lines)
