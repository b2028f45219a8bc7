"""`kill -9` at random moments: of workers, and of the command itself, which is then resumed.

However often something is killed, the episodes end up as those of a run that nobody disturbed.
`TOPONAV_KILL_SEED` repeats the moments of a failed test, as far as the machine repeats itself.
"""

from __future__ import annotations

import contextlib
import importlib.util
import json
import os
import random
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from small_house import SMALL

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="needs Linux's /proc"),
]
needs_ray = pytest.mark.skipif(
    importlib.util.find_spec("ray") is None, reason="needs the extra `ray`"
)

EPISODES = 12
COMMAND = (
    sys.executable, "-c", "import sys; from toponav.cli.main import main; sys.exit(main())",
    "eval", "generated:6", "--episodes", str(EPISODES), "--method", "random", "--preset", "paper",
    "--max-steps", "120", *SMALL,
)  # fmt: skip
PATIENCE_S = 120.0


@pytest.fixture
def chance() -> random.Random:
    """Draws the moments; a failed test shows the seed."""
    seed = int(os.environ.get("TOPONAV_KILL_SEED", random.SystemRandom().randrange(10**6)))
    print(f"TOPONAV_KILL_SEED={seed}")  # noqa: T201 - shown when the test fails
    return random.Random(seed)


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("undisturbed") / "out"
    subprocess.run([*COMMAND, "--out", str(out)], check=True, capture_output=True)
    return out


class Runs:
    """Starts the command, each time in a session of its own, by which its processes are known."""

    def __init__(self, out: Path, *options: str) -> None:
        self.out, self._options = out, options
        self._sessions: list[int] = []

    def start(self, *more: str) -> subprocess.Popen[str]:
        process = subprocess.Popen(
            [*COMMAND, *self._options, *more, "--out", str(self.out)],
            stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, start_new_session=True,
        )  # fmt: skip
        self._sessions.append(process.pid)
        return process

    def finish(self, process: subprocess.Popen[str]) -> None:
        _, error = process.communicate(timeout=PATIENCE_S)
        assert process.returncode == 0, error

    def lines(self) -> int:
        """Episodes on the disk."""
        path = self.out / "episodes.jsonl"
        return path.read_bytes().count(b"\n") if path.exists() else 0

    def actors(self) -> list[int]:
        """Worker processes of all runs, also of those that were killed."""
        found = processes(self._sessions)
        return sorted(pid for pid, name in found.items() if name.startswith("ray::_Actor"))

    def reap(self) -> None:
        """End what a killed Ray leaves: two of its helpers stay for a minute."""
        for pid in processes(self._sessions):
            with_luck(lambda pid=pid: os.kill(pid, signal.SIGKILL))


def processes(sessions: list[int]) -> dict[int, str]:
    """Name by process id of what lives in these sessions."""
    found = {}
    for folder in Path("/proc").iterdir():
        if not folder.name.isdecimal():
            continue
        try:
            session = int((folder / "stat").read_text().rpartition(")")[2].split()[3])
            name = (folder / "cmdline").read_bytes().decode(errors="replace")
        except OSError:  # it has just ended
            continue
        if session in sessions and name:
            found[int(folder.name)] = name
    return found


def with_luck(end: Callable[[], None]) -> None:
    """End a process that may have ended by itself."""
    with contextlib.suppress(ProcessLookupError):
        end()


def wait_until(condition: Callable[[], Any], process: subprocess.Popen[str] | None = None) -> None:
    """Wait for something, or for a process to end."""
    deadline = time.monotonic() + PATIENCE_S
    while not condition() and (process is None or process.poll() is None):
        assert time.monotonic() < deadline
        time.sleep(0.02)


@pytest.fixture
def in_one_process(tmp_path: Path) -> Runs:
    return Runs(tmp_path / "out")


@pytest.fixture
def with_ray(tmp_path: Path) -> Iterator[Runs]:
    runs = Runs(tmp_path / "out", "--workers", "2")
    yield runs
    runs.reap()


def records(folder: Path) -> list[dict[str, Any]]:
    """The results but for their times, in the order of the episodes."""
    lines = (folder / "episodes.jsonl").read_text().splitlines()
    results = [{**json.loads(line), "seconds": None} for line in lines]
    return sorted(results, key=lambda result: result["index"])


def recordings(folder: Path) -> dict[str, bytes]:
    """All that was recorded of the episodes; also what should not be there."""
    root = folder / "episodes"
    return {
        str(path.relative_to(root)): path.read_bytes() for path in root.rglob("*") if path.is_file()
    }


def assert_same(out: Path, undisturbed: Path) -> None:
    """Nothing tells of the kills: no episode is missing, double or different, no file left over."""
    assert records(out) == records(undisturbed)
    assert recordings(out) == recordings(undisturbed)
    assert (out / "summary.json").read_text() == (undisturbed / "summary.json").read_text()
    assert {path.name for path in out.iterdir()} == {path.name for path in undisturbed.iterdir()}


def kill_driver_after(runs: Runs, lines: int, wait_s: float, *options: str) -> None:
    """Run until so many more episodes are written and a while longer, then kill the command."""
    process = runs.start(*options)
    goal = runs.lines() + lines
    wait_until(lambda: runs.lines() >= goal, process)
    time.sleep(wait_s)
    with_luck(process.kill)
    process.communicate()


def test_a_run_of_one_process_is_killed_and_resumed(
    in_one_process: Runs, undisturbed: Path, chance: random.Random
) -> None:
    runs = in_one_process
    kill_driver_after(runs, 0, chance.uniform(0.0, 2.5))
    for _ in range(3):
        kill_driver_after(runs, chance.randint(1, 3), chance.uniform(0.0, 0.3), "--resume")
    runs.finish(runs.start("--resume"))
    assert_same(runs.out, undisturbed)


@needs_ray
def test_workers_are_killed_and_the_run_goes_on(
    with_ray: Runs, undisturbed: Path, chance: random.Random
) -> None:
    runs = with_ray
    process = runs.start()
    for lines in (1, 4):  # twice at most: an episode that kills three workers would be given up
        wait_until(lambda lines=lines: runs.lines() >= lines and runs.actors(), process)
        time.sleep(chance.uniform(0.0, 0.4))
        os.kill(chance.choice(runs.actors()), signal.SIGKILL)
    runs.finish(process)
    assert_same(runs.out, undisturbed)
    wait_until(lambda: not runs.actors())


@needs_ray
def test_a_run_of_many_processes_is_killed_and_resumed_at_once(
    with_ray: Runs, undisturbed: Path, chance: random.Random
) -> None:
    runs = with_ray
    for _ in range(2):
        kill_driver_after(runs, chance.randint(1, 3), chance.uniform(0.0, 0.4), "--resume")
    runs.finish(runs.start("--resume"))
    wait_until(lambda: not runs.actors())  # also those of the killed runs end by themselves
    assert_same(runs.out, undisturbed)
