"""`toponav bench robot` and `bench faults`: searches over DDS on this machine, timed."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from toponav.cli.options import JsonFlag, OffFlag
from toponav.errors import InputError, TopoNavError

if TYPE_CHECKING:
    from toponav.robot.trial import TrialResult

HOUSES = "generated:0=chair,generated:1=bed,generated:2=toilet"
"""What is searched for, and where, unless told otherwise."""


@dataclass(frozen=True)
class RobotBench:
    """Searches by the node on the simulated robot, two processes over DDS on this machine."""

    houses: str = HOUSES
    """HOUSE=TARGET, separated by commas."""

    drives: str = "cmd_vel,goal_pose"
    """How the robot is driven, each in every house."""

    robot: str = "generic"
    """Profile or YAML file."""

    camera: str = "320x240"
    """Image size, WIDTHxHEIGHT."""

    camera_hz: float = 15.0
    """Images a second."""

    drift: OffFlag = False
    """Let the pose drift and the depth be noisy, as sim-robot --drift does."""

    bump_speed: float = 0.1
    """A collision above this speed (m/s) fails the run."""

    timeout_s: float = 400.0
    """For each search."""

    out: Path = Path("runs/bench_robot")
    """Folder for the processes' output and the robot's traces."""

    json: JsonFlag = False
    """Print the figures as one JSON object on stdout."""

    def run(self) -> None:
        """Search everywhere in both ways, and print how it went."""
        from toponav.cli.console import Output
        from toponav.robot.ros2_import import import_ros
        from toponav.robot.trial import TrialConfig, run_trial

        import_ros("rclpy")
        output = Output(self.json)
        lines, rows, failed = [], [], 0
        for drive in self.drives.split(","):
            for house, target in _pairs(self.houses):
                trial = TrialConfig(
                    house,
                    target,
                    self.robot,
                    drive,
                    self.camera,
                    self.camera_hz,
                    faults=("--drift",) if self.drift else (),
                    timeout_s=self.timeout_s,
                )
                folder = self.out / f"{drive}_{house.replace(':', '_')}_{target}"
                result = run_trial(trial, folder)
                good = result.found and result.sim["bump_speed"] <= self.bump_speed + 1e-6
                failed += not good
                line = f"{drive:9s} {house} {target}: {_trial_line(result)}"
                output.say(line)
                lines.append(line)
                data = {"house": house, "target": target, "drive": drive, "found": result.found}
                rows.append({**data, "node": result.node, "sim": result.sim})
        output.result("\n".join(lines), {"trials": rows, "failed": failed})
        if failed:
            raise TopoNavError(f"{failed} of {len(rows)} searches failed")


def _pairs(text: str) -> list[tuple[str, str]]:
    """Houses and targets.

    Raises:
        InputError: One lacks its target.
    """
    pairs = []
    for entry in text.split(","):
        house, equals, target = entry.partition("=")
        if not (house and equals and target):
            raise InputError(f"--houses takes HOUSE=TARGET,..., not {entry!r}")
        pairs.append((house, target))
    return pairs


def _trial_line(result: TrialResult) -> str:
    sim = result.sim
    where = (
        f"{sim['distance_to_goal']:.2f} m from it, {sim['travelled']:.1f} m driven, "
        f"{sim['bumps']} bumps (fastest {sim['bump_speed']:.2f} m/s)"
    )
    if not result.node:
        return f"FAILED ({result.failure}); {where}"
    verdict = "found" if result.found else "stopped elsewhere"
    node = result.node
    process, timings = node["process"], node["timings"]
    parts = [
        f"{verdict} in {node['seconds']:.0f} s, {node['steps']} steps; {where}; node "
        f"{100.0 * process['cpu_s'] / process['wall_s']:.0f} % of a core, "
        f"{process['peak_mb']:.0f} MB"
    ]
    for name in ("image to command", "image to intent", "control period"):
        if name in timings:
            taken: dict[str, Any] = timings[name]
            parts.append(f"{name} {taken['median_ms']:.0f} ms (99 % {taken['p99_ms']:.0f} ms)")
    return "; ".join(parts)


@dataclass(frozen=True)
class FaultBench:
    """Faults injected while the node searches on the simulated robot: stop times and recovery."""

    faults: str = "drop,latency,jump,silent,cancel,kill"
    """Which, separated by commas."""

    house: str = "generated:0"
    """Where."""

    target: str = "chair"
    """What is searched for."""

    robot: str = "generic"
    """Profile or YAML file."""

    camera: str = "320x240"
    """Image size, WIDTHxHEIGHT."""

    drift: OffFlag = False
    """Let the pose drift and the depth be noisy beside each fault."""

    longest_stop_s: float = 1.5
    """A robot that takes longer to stand still fails."""

    timeout_s: float = 400.0
    """For each search."""

    out: Path = Path("runs/bench_faults")
    """Folder for the processes' output and the robot's traces."""

    json: JsonFlag = False
    """Print the figures as one JSON object on stdout."""

    def run(self) -> None:
        """Inject each fault, and print what it did."""
        from toponav.cli.console import Output
        from toponav.robot.bench_faults import FAULTS
        from toponav.robot.ros2_import import import_ros
        from toponav.robot.trial import TrialConfig

        import_ros("rclpy")
        names = self.faults.split(",")
        unknown = [name for name in names if name not in FAULTS]
        if unknown:
            raise InputError(f"unknown fault {unknown[0]!r}; known: {', '.join(FAULTS)}")
        output = Output(self.json)
        trial = TrialConfig(
            self.house,
            self.target,
            self.robot,
            camera=self.camera,
            faults=("--drift",) if self.drift else (),
            timeout_s=self.timeout_s,
        )
        lines, outcomes, failed = [], [], 0
        for name in names:
            outcome = FAULTS[name](trial, self.out / name)
            late = outcome.stop_s is not None and outcome.stop_s > self.longest_stop_s
            failed += late or not outcome.passed
            stopped = "" if outcome.stop_s is None else f"stands after {outcome.stop_s:.2f} s; "
            line = (
                f"{'passed' if outcome.passed and not late else 'FAILED'}  {outcome.fault}: "
                f"{stopped}{outcome.detail}; fastest bump {outcome.bump_speed:.2f} m/s"
            )
            output.say(line)
            lines.append(line)
            outcomes.append(asdict(outcome))
        output.result("\n".join(lines), {"faults": outcomes, "failed": failed})
        if failed:
            raise TopoNavError(f"{failed} of {len(names)} faults were not dealt with")
