"""A search tried out: the simulated robot and the node, two processes over DDS on one machine."""

from __future__ import annotations

import csv
import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from toponav.errors import TopoNavError

FOUND_M = 0.25
"""A robot that stops this near to a place from which the target is seen within 1 m has found it:
the protocol's 0.1 m, and the step that a walking agent of the protocol is exact to."""

CLOSING_S = 60.0
"""A process that does not end within so long of being asked to is killed, seconds."""

STARTING_S = 300.0
"""A simulated robot that does not publish within so long has failed: a busy machine is slow."""

COMMAND = (sys.executable, "-c", "from toponav.cli.main import entry_point; entry_point()")
"""The command line, whatever the PATH."""


@dataclass(frozen=True)
class TrialConfig:
    """One search.

    Attributes:
        house: The scene.
        target: What to find.
        robot: Profile or YAML file.
        drive: cmd_vel or goal_pose.
        camera: WIDTHxHEIGHT.
        camera_hz: Images a second.
        faults: Further options of sim-robot.
        node: Further options of ros2.
        timeout_s: For the search.
        domain: Of DDS.
    """

    house: str
    target: str
    robot: str = "generic"
    drive: str = "cmd_vel"
    camera: str = "320x240"
    camera_hz: float = 15.0
    faults: tuple[str, ...] = ()
    node: tuple[str, ...] = ()
    timeout_s: float = 300.0
    domain: int = field(default_factory=lambda: 20 + os.getpid() % 80)

    @property
    def environment(self) -> dict[str, str]:
        """Of the processes: DDS that keeps to this machine."""
        range_ = {"ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST", "ROS_DOMAIN_ID": str(self.domain)}
        return {**os.environ, **range_}


@dataclass(frozen=True, eq=False)
class TrialResult:
    """What came of it.

    Attributes:
        node: The last status of the node; empty where it failed.
        failure: The node's last words, where it failed.
        sim: The simulated robot's result.
        trace: (N, 7) the body over time, as `TracePoint`.
    """

    node: dict[str, Any]
    failure: str
    sim: dict[str, Any]
    trace: NDArray[np.float64]

    @property
    def found(self) -> bool:
        """Whether the search ended at the target."""
        return bool(self.node) and self.sim["distance_to_goal"] <= FOUND_M


class Process:
    """One process of a trial, whose output goes to files."""

    def __init__(
        self, arguments: Sequence[str], folder: Path, name: str, trial: TrialConfig
    ) -> None:
        """Start `toponav` with some arguments."""
        self._files: list[IO[bytes]] = [
            (folder / f"{name}.{kind}").open("wb") for kind in ("out", "err")
        ]
        self._folder, self._name = folder, name
        out, err = self._files
        self.process = subprocess.Popen(
            (*COMMAND, *arguments), stdout=out, stderr=err, env=trial.environment
        )

    def wait(self, timeout_s: float) -> None:
        """Let it end by itself, or by force."""
        try:
            self.process.wait(timeout_s)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        for file in self._files:
            file.close()

    def end(self, number: signal.Signals = signal.SIGINT) -> None:
        """Ask it to end, and wait until it has."""
        self.process.send_signal(number)
        self.wait(CLOSING_S)

    def said(self, text: str) -> bool:
        """Whether it has said something on stderr."""
        return text in (self._folder / f"{self._name}.err").read_text(errors="replace")

    def result(self) -> dict[str, Any]:
        """Its JSON on stdout; empty where it printed none."""
        text = (self._folder / f"{self._name}.out").read_text(errors="replace")
        return dict(json.loads(text)) if text.strip() else {}

    def last_words(self) -> str:
        """The last line that it said on stderr."""
        text = (self._folder / f"{self._name}.err").read_text(errors="replace").strip()
        return text.splitlines()[-1] if text else ""


@contextmanager
def sim_robot(trial: TrialConfig, folder: Path) -> Iterator[Process]:
    """The robot of a trial, while it publishes; ended and asked for its result afterwards.

    Raises:
        TopoNavError: It does not start.
    """
    folder.mkdir(parents=True, exist_ok=True)
    arguments = [
        *("sim-robot", trial.house, "--target", trial.target, "--robot", trial.robot),
        *("--camera", trial.camera, "--camera-hz", str(trial.camera_hz), "--json"),
        *("--seconds", "3600", "--trace", str(folder / "trace.csv"), *trial.faults),
    ]
    process = Process(arguments, folder, "sim", trial)
    try:
        until_s = time.monotonic() + STARTING_S
        while not process.said("to find"):
            if process.process.poll() is not None or time.monotonic() > until_s:
                raise TopoNavError(f"the simulated robot did not start: {process.last_words()}")
            time.sleep(0.1)
        yield process
    finally:
        process.end()


def search_node(trial: TrialConfig, folder: Path, name: str = "node") -> Process:
    """The node of a trial, on its way."""
    arguments = [
        *("ros2", "--target", trial.target, "--robot", trial.robot, "--drive", trial.drive),
        *("--timeout-s", str(trial.timeout_s), "--json", *trial.node),
    ]
    return Process(arguments, folder, name, trial)


def run_trial(trial: TrialConfig, folder: Path) -> TrialResult:
    """Search until the node ends.

    Raises:
        TopoNavError: The simulated robot does not start.
    """
    with sim_robot(trial, folder) as robot:
        node = search_node(trial, folder)
        node.wait(trial.timeout_s + CLOSING_S)
    return trial_result(robot, node, folder)


def trial_result(robot: Process, node: Process, folder: Path) -> TrialResult:
    """What two processes that have ended left behind."""
    sim = robot.result()
    if not sim:
        raise TopoNavError(f"the simulated robot failed: {robot.last_words()}")
    data = node.result()
    failure = "" if data else node.last_words() or "it said nothing"
    return TrialResult(data, failure, sim, read_trace(folder / "trace.csv"))


def read_trace(path: Path) -> NDArray[np.float64]:
    """(N, 7) what sim-robot --trace wrote."""
    with path.open(newline="") as file:
        rows = list(csv.reader(file))[1:]
    numbers = [[*map(float, row[:6]), float(row[6] == "True")] for row in rows]
    return np.array(numbers, np.float64).reshape(-1, 7)


def stop_time(trace: NDArray[np.float64], event_s: float, until_s: float | None = None) -> float:
    """Seconds from an event until the body stands still; infinite if it never does.

    Args:
        trace: (N, 7) the body over time.
        event_s: By the trace's clock.
        until_s: The body must not move again before this; by default it may at once.
    """
    after = trace[trace[:, 0] >= event_s]
    moving = (after[:, 4] != 0.0) | (after[:, 5] != 0.0)
    if until_s is not None:
        within = after[:, 0] < until_s
        moves = np.flatnonzero(moving & within)
        first = int(moves[-1]) + 1 if len(moves) else 0
        return float(after[first, 0] - event_s) if first < within.sum() else float("inf")
    still = np.flatnonzero(~moving)
    return float(after[still[0], 0] - event_s) if len(still) else float("inf")


def speed_at(trace: NDArray[np.float64], time_s: float) -> float:
    """Speed (m/s) of the body at a time."""
    return float(np.interp(time_s, trace[:, 0], trace[:, 4]))


def moves_after(trace: NDArray[np.float64], time_s: float) -> float:
    """Metres that the body drives after a time."""
    after = trace[trace[:, 0] >= time_s]
    return float(np.hypot(*np.diff(after[:, 1:3], axis=0).T).sum())
