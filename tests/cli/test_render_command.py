"""Pictures and videos of a recorded episode."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from small_house import SMALL
from toponav.cli.main import main
from toponav.evaluation.replay import open_episode


@pytest.fixture(scope="module")
def recorded(house: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("recorded")
    assert main(["run", str(house), *SMALL, "--quiet", "--out", str(out)]) == 0
    return out


def test_a_replay_decides_as_the_recorded_search(recorded: Path) -> None:
    episode = open_episode(recorded)
    again = episode.replay()
    assert (again.steps, again.path_length) == (episode.result.steps, episode.result.path_length)


@pytest.mark.parametrize(
    ("name", "magic"), [("a.png", b"\x89PNG"), ("a.svg", b"<?xml"), ("a.pdf", b"%PDF")]
)
def test_top_down_maps(recorded: Path, tmp_path: Path, name: str, magic: bytes) -> None:
    path = tmp_path / name
    assert main(["render", str(recorded), "--out", str(path), "--decision", "0"]) == 0
    assert path.read_bytes().startswith(magic)


def test_a_panorama(recorded: Path, tmp_path: Path) -> None:
    path = tmp_path / "p.png"
    arguments = ["render", str(recorded), "--what", "panorama", "--decision", "0"]
    assert main([*arguments, "--out", str(path)]) == 0
    with Image.open(path) as drawn, Image.open(recorded / "panorama_00.jpg") as written:
        assert drawn.size == written.size
        difference = np.asarray(drawn.convert("L"), int) - np.asarray(written.convert("L"), int)
    assert np.abs(difference).mean() < 3.0


def test_a_video_has_a_frame_a_step_and_the_map_grows(
    recorded: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "v.gif"
    assert main(["render", str(recorded), "--what", "video", "--out", str(path), "--json"]) == 0
    steps = open_episode(recorded).result.steps
    assert json.loads(capsys.readouterr().out)["frames"] == steps
    with Image.open(path) as film:
        known = []
        for k in (0, film.n_frames - 1):
            film.seek(k)
            page = np.asarray(film.convert("RGB"))[:540, 360:]
            known.append(np.count_nonzero(page.min(axis=2) < 250))
    assert known[1] > 1.5 * known[0]


def test_an_mp4(recorded: Path, tmp_path: Path) -> None:
    ffmpeg = pytest.importorskip("imageio_ffmpeg", reason="needs the extra viz")
    path = tmp_path / "v.mp4"
    arguments = ["render", str(recorded), "--what", "video", "--every", "5", "--out", str(path)]
    assert main(arguments) == 0
    frames, seconds = ffmpeg.count_frames_and_secs(str(path))
    assert frames >= open_episode(recorded).result.steps // 5
    assert seconds > 0.0


def test_another_course_is_an_error(
    recorded: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "changed"
    shutil.copytree(recorded, folder)
    path = folder / "trajectory.jsonl"
    lines = path.read_text().splitlines()
    step = json.loads(lines[20])
    step["position"][0] += 0.5
    path.write_text("\n".join([*lines[:20], json.dumps(step), *lines[21:]]) + "\n")
    # An error that an agent or a watcher raises on purpose must not end in a picture.
    assert main(["render", str(folder), "--out", str(tmp_path / "x.png")]) == 1
    assert "step 20" in capsys.readouterr().err
    assert not (tmp_path / "x.png").exists()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--what", "video", "--out", "a.avi"], ".gif, .mp4"),
        (["--decision", "99"], "decisions 0 to"),
        (["--every", "0"], "positive"),
    ],
)
def test_bad_usage_is_said(
    recorded: Path, arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["render", str(recorded), *arguments]) == 2
    assert message in capsys.readouterr().err


def test_a_folder_without_an_episode(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["render", str(tmp_path)]) == 2
    assert "no recorded episode" in capsys.readouterr().err
