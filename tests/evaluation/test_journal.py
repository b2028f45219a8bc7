"""`episodes.jsonl` against kills, damage, full disks and a second writer."""

from __future__ import annotations

import errno
import io
from pathlib import Path
from typing import Any

import pytest

from small_house import SMALL
from toponav.cli.main import main
from toponav.errors import InputError
from toponav.evaluation.blank_worker import BlankWorker
from toponav.evaluation.journal import Journal, read_results
from toponav.evaluation.results import EpisodeResult, to_json
from toponav.evaluation.tasks import Task

RESULTS = [BlankWorker().run(Task("spec", "scène", index)) for index in range(3)]


def journal(folder: Path, results: list[EpisodeResult] = RESULTS) -> Journal:
    made = Journal(folder)
    for result in results:
        made.append(result)
    return made


def test_what_is_appended_is_read_back_whole(tmp_path: Path) -> None:
    assert journal(tmp_path).results() == RESULTS
    assert read_results(tmp_path) == RESULTS


def test_a_last_line_cut_off_at_any_byte_is_no_result_and_is_repaired(tmp_path: Path) -> None:
    made = journal(tmp_path)
    whole = made.path.read_bytes()
    kept = len(whole) - len(to_json(RESULTS[-1])) - 1
    for cut in range(kept + 1, len(whole)):
        made.path.write_bytes(whole[:cut])
        assert made.results() == RESULTS[:-1]
        assert made.repair()
        assert made.path.read_bytes() == whole[:kept]
    assert not made.repair()
    made.append(RESULTS[-1])
    assert made.path.read_bytes() == whole


def test_a_first_line_that_was_never_finished_is_repaired_too(tmp_path: Path) -> None:
    made = journal(tmp_path, RESULTS[:1])
    made.path.write_bytes(made.path.read_bytes()[:7])
    assert made.begun()
    assert made.repair()
    assert made.results() == []
    assert not made.begun()


@pytest.mark.parametrize(
    ("damage", "says"),
    [
        (b"{half a line\n", "line 2: not a JSON record"),
        (b"\x00\x00\xff\n", "line 2: not a JSON record"),
        (b"\n", "line 2: not a JSON record"),
        (b"[1]\n", "line 2: "),
        (b"{}\n", r"line 2: scene: Field required; not a result of toponav eval"),
        (to_json(RESULTS[0]).encode() + b"\n", r"line 2: episode scène #0 is there twice"),
        (to_json(RESULTS[1]).replace('"steps": 500', '"steps": "x"').encode() + b"\n",
         "line 2: steps: "),
    ],
)  # fmt: skip
def test_a_line_in_the_middle_that_is_no_result_is_named_by_its_number(
    tmp_path: Path, damage: bytes, says: str
) -> None:
    made = journal(tmp_path)
    first, _, third = made.path.read_bytes().splitlines(keepends=True)
    made.path.write_bytes(first + damage + third)
    with pytest.raises(InputError, match=rf"episodes\.jsonl, {says}"):
        made.results()


def test_a_folder_without_a_run_is_said_to_be_one(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="give the --out folder of a toponav eval"):
        read_results(tmp_path)
    assert not Journal(tmp_path).begun()


def test_a_second_writer_is_refused_and_the_lock_ends_with_its_holder(tmp_path: Path) -> None:
    made = journal(tmp_path)
    with made.locked():
        with pytest.raises(InputError, match="another toponav eval is writing here"):
            Journal(tmp_path).locked().__enter__()
        assert made.results() == RESULTS  # reading is free
    with Journal(tmp_path).locked():
        pass


class FullDisk:
    """Takes so many bytes in all and then has no room; stands for an unbuffered file."""

    def __init__(self, stream: io.RawIOBase, room: int) -> None:
        self._stream, self._room = stream, room

    def __enter__(self) -> FullDisk:
        return self

    def __exit__(self, *_: object) -> None:
        self._stream.close()

    def tell(self) -> int:
        return self._stream.tell()

    def fileno(self) -> int:
        return self._stream.fileno()

    def write(self, data: memoryview) -> int:
        part = bytes(data)[: min(self._room, 100)]
        if not part:
            raise OSError(errno.ENOSPC, "No space left on device")
        self._room -= len(part)
        written = self._stream.write(part)
        assert written is not None
        return written


def fill_disk(monkeypatch: pytest.MonkeyPatch, room: int) -> None:
    """From now on, `episodes.jsonl` can take `room` bytes a time that it is opened to append."""
    really_open = Path.open

    def opened(path: Path, mode: str = "r", *more: Any, **options: Any) -> Any:
        stream = really_open(path, mode, *more, **options)
        appends = path.name == "episodes.jsonl" and options.get("buffering") == 0
        return FullDisk(stream, room) if appends else stream

    monkeypatch.setattr(Path, "open", opened)


@pytest.mark.parametrize("room", [0, 1, 99, 100, 555])
def test_a_full_disk_leaves_the_file_as_it_was(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, room: int
) -> None:
    made = journal(tmp_path, RESULTS[:2])
    before = made.path.read_bytes()
    with monkeypatch.context() as patch:
        fill_disk(patch, room)
        with pytest.raises(OSError, match="No space left") as caught:
            made.append(RESULTS[2])
    assert caught.value.filename == str(made.path)
    assert made.path.read_bytes() == before
    made.append(RESULTS[2])
    assert made.results() == RESULTS


def test_a_disk_that_takes_a_line_in_pieces_gets_it_whole(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    fill_disk(monkeypatch, room=10**6)
    assert journal(tmp_path).results() == RESULTS


def run_small(folder: Path, *more: str) -> int:
    return main(
        ["eval", "generated:6", "--episodes", "2", "--method", "random", "--max-steps", "3",
         *SMALL, "--no-record", "--out", str(folder), *more]
    )  # fmt: skip


def error_line(capsys: pytest.CaptureFixture[str]) -> str:
    [line] = [line for line in capsys.readouterr().err.splitlines() if line.startswith("toponav: ")]
    return line


def test_the_command_says_that_the_disk_is_full_and_goes_on_once_it_is_not(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    with monkeypatch.context() as patch:
        fill_disk(patch, room=50)
        assert run_small(tmp_path) == 1
    path = tmp_path / "episodes.jsonl"
    said = error_line(capsys)
    assert said == f"toponav: cannot read or write {path}: No space left on device"
    assert path.read_bytes() == b""
    assert not list(tmp_path.glob(".*"))
    assert run_small(tmp_path, "--resume") == 0
    assert len(read_results(tmp_path)) == 2


def test_the_command_refuses_a_folder_that_another_one_writes_into(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with journal(tmp_path, []).locked():
        assert run_small(tmp_path) == 2
        assert "another toponav eval is writing here" in error_line(capsys)
        assert [path.name for path in tmp_path.iterdir()] == ["episodes.jsonl"]


@pytest.mark.skipif(not Path("/proc/self/task").is_dir(), reason="needs Linux's /proc")
def test_the_command_says_which_folder_it_cannot_write_into(
    capsys: pytest.CaptureFixture[str],
) -> None:
    unwritable = Path("/proc/self/task")  # not even the superuser writes here
    assert run_small(unwritable) == 1
    assert error_line(capsys).startswith(
        f"toponav: cannot read or write {unwritable}/episodes.jsonl"
    )
