"""The live view: what a recording holds, and that watching changes nothing."""

from __future__ import annotations

import builtins
import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from drawn_map import observation_at
from small_house import SMALL
from toponav.cli.main import main
from toponav.errors import InputError, MissingExtraError
from toponav.scenes.generate import generate_house
from toponav.scenes.house_io import save_house
from toponav.types import Action
from toponav.viz.live.stream import LiveOptions, check, watching
from toponav.viz.live.watcher import MOST_PATH, LiveWatcher

pytest.importorskip("rerun", reason="needs the extra viz")

ENTITIES = {
    "/world/agent/body", "/world/agent/camera", "/world/agent/camera/depth",
    "/world/agent/camera/rgb", "/world/agent/path", "/world/graph/nodes", "/world/map/frontiers",
    "/world/map/occupancy", "/world/map/scene", "/world/affordances/dir",
    "/world/affordances/total", "/world/plan/waypoint", "/panorama", "/reasoner/answer",
    "/reasoner/memory", "/metrics/walked_m", "/metrics/free_m2",
}  # fmt: skip


@pytest.fixture(scope="module")
def searched(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The same search twice, in `plain` and, recorded, in `watched`."""
    folder = tmp_path_factory.mktemp("live")
    save_house(generate_house(6), folder / "small.json")
    arguments = ["run", str(folder / "small.json"), "--preset", "paper", *SMALL, "--quiet"]
    assert main([*arguments, "--out", str(folder / "plain")]) == 0
    record = ["--record", str(folder / "search.rrd")]
    assert main([*arguments, "--out", str(folder / "watched"), *record]) == 0
    return folder


def rerun(*arguments: str) -> str:
    """Rerun's own command."""
    command = [sys.executable, "-m", "rerun", *arguments]
    result = subprocess.run(command, capture_output=True, text=True, check=False, timeout=120)
    assert result.returncode == 0, result.stderr
    return result.stdout


def test_watching_changes_no_action(searched: Path) -> None:
    plain, watched = (searched / name / "trajectory.jsonl" for name in ("plain", "watched"))
    assert plain.read_bytes() == watched.read_bytes()


def test_reruns_own_tools_open_the_file_and_list_it(searched: Path) -> None:
    file = str(searched / "search.rrd")
    rerun("rrd", "verify", file)
    listing = rerun("rrd", "print", "-vv", file)
    for entity in ENTITIES:
        assert entity in listing, entity
    decisions = (searched / "watched" / "decisions.jsonl").read_text().splitlines()
    seen = {item[0] for line in decisions for v in json.loads(line)["views"] for item in v["seen"]}
    assert any(f"/world/map/objects/{label}" in listing for label in seen)
    for timeline in ("step", "decision"):
        assert timeline in listing


class KeepingStream:
    """Takes the place of a recording, and keeps what was logged last."""

    def __init__(self) -> None:
        self.last: dict[str, Any] = {}

    def set_time(self, timeline: str, sequence: int) -> None:
        pass

    def log(self, entity: str, value: Any, static: bool = False) -> None:
        self.last[entity] = value


def test_a_step_of_a_long_search_logs_no_more_than_one_of_a_short_one() -> None:
    import rerun

    stream = KeepingStream()
    watcher = LiveWatcher(rerun, stream, "bed")
    for step in range(MOST_PATH + 300):
        watcher.on_step(observation_at(0.01 * step, 0.0, step=step), Action.MOVE_FORWARD)
    (path,) = stream.last["world/agent/path"].strips.as_arrow_array().to_pylist()
    assert len(path) <= MOST_PATH + 1
    assert path[-1][0] == pytest.approx(0.01 * step)
    assert path[0][0] == pytest.approx(0.0)


def test_nothing_is_logged_unasked() -> None:
    with watching(LiveOptions(), "bed", "test") as watcher:
        assert watcher is None


def test_another_kind_of_file_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"call it search\.rrd"):
        check(LiveOptions(record=tmp_path / "search.txt"))


def test_a_viewer_without_a_display_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "platform", "linux")
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    with pytest.raises(InputError, match="--record"):
        check(LiveOptions(view=True))


def test_without_rerun_the_extra_is_named(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    importing = builtins.__import__

    def absent(name: str, *arguments: Any, **options: Any) -> Any:
        if name.startswith("rerun"):
            raise ImportError(name)
        return importing(name, *arguments, **options)

    monkeypatch.setattr(builtins, "__import__", absent)
    with pytest.raises(MissingExtraError, match=r"toponav\[viz\]"):
        check(LiveOptions(record=tmp_path / "a.rrd"))
