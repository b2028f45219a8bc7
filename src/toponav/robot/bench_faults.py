"""Faults injected into searches: whether the robot stops when it must, how soon, and goes on."""

from __future__ import annotations

import math
import signal
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

from toponav.robot.sim_faults import FaultConfig
from toponav.robot.trial import (
    CLOSING_S,
    TrialConfig,
    moves_after,
    run_trial,
    search_node,
    sim_robot,
    speed_at,
    stop_time,
    trial_result,
)
from toponav.robot.witness import Witness

CRUISE = 0.3
"""A robot at this speed is moving: m/s."""

SETTING_OUT_S = 180.0
"""Within so long the robot has started to walk, seconds."""


SILENT_S = FaultConfig().silent_s
"""How long the camera is silent, seconds."""


@dataclass(frozen=True)
class FaultOutcome:
    """What a fault did.

    Attributes:
        fault: Its name.
        passed: Whether the robot did what it must.
        stop_s: From the fault to standing still; None where it need not stop.
        bump_speed: Fastest speed at which it ran into something, m/s.
        detail: In words.
    """

    fault: str
    passed: bool
    stop_s: float | None
    bump_speed: float
    detail: str


def survives(name: str, options: tuple[str, ...], trial: TrialConfig, folder: Path) -> FaultOutcome:
    """A fault during which the search goes on, or that it gets over."""
    result = run_trial(replace(trial, faults=(*trial.faults, *options)), folder)
    begun: dict[str, float] = result.sim["faults"]
    at_s, stop_s = next(iter(begun.values()), None), None
    detail = f"{result.sim['distance_to_goal']:.2f} m from the {trial.target}"
    detail += f" after {result.node['seconds']:.0f} s" if result.node else f": {result.failure}"
    if at_s is not None:
        # While the camera is silent the robot must not set out again.
        lasts = at_s + SILENT_S if "silent" in begun else None
        stop_s = stop_time(result.trace, at_s, lasts)
        detail = f"from {speed_at(result.trace, at_s):.2f} m/s; {detail}"
    passed = result.found and (stop_s is None or math.isfinite(stop_s))
    return FaultOutcome(name, passed, stop_s, result.sim["bump_speed"], detail)


def cancelled(trial: TrialConfig, folder: Path) -> FaultOutcome:
    """The goal cancelled while the robot drives."""
    with Witness(trial.domain) as witness, sim_robot(trial, folder) as robot:
        node = search_node(trial, folder)
        witness.wait_for_speed(CRUISE, SETTING_OUT_S)
        called_s = witness.call("Trigger", "toponav/cancel")
        node.wait(CLOSING_S)
        time.sleep(1.0)
    result = trial_result(robot, node, folder)
    stop_s = stop_time(result.trace, called_s)
    after = moves_after(result.trace, called_s + stop_s)
    passed = after < 0.01 and "cancelled" in result.failure
    detail = (
        f"from {speed_at(result.trace, called_s):.2f} m/s; {after:.2f} m driven after standing; "
        f"{result.failure}"
    )
    return FaultOutcome("cancel", passed, stop_s, result.sim["bump_speed"], detail)


def killed(trial: TrialConfig, folder: Path) -> FaultOutcome:
    """The node killed while the robot drives, and started again with its memory."""
    memory = folder / "memory.npz"
    trial = replace(trial, node=("--memory", str(memory)))
    with Witness(trial.domain) as witness, sim_robot(trial, folder) as robot:
        node = search_node(trial, folder, "killed")
        witness.wait(memory.exists, SETTING_OUT_S, "a memory")
        witness.wait_for_speed(CRUISE, SETTING_OUT_S)
        killed_s = time.time()
        node.end(signal.SIGKILL)
        again = search_node(trial, folder)
        again.wait(trial.timeout_s + CLOSING_S)
    result = trial_result(robot, again, folder)
    remembered = result.node.get("remembered", 0)
    detail = (
        f"from {speed_at(result.trace, killed_s):.2f} m/s; {remembered} map points remembered; "
        f"{result.sim['distance_to_goal']:.2f} m from the "
        f"{trial.target}" + (f": {result.failure}" if result.failure else "")
    )
    stop_s = stop_time(result.trace, killed_s)
    return FaultOutcome(
        "node killed", result.found and remembered > 0, stop_s, result.sim["bump_speed"], detail
    )


Case = Callable[[TrialConfig, Path], FaultOutcome]


def _surviving(name: str, *options: str) -> Case:
    return lambda trial, folder: survives(name, options, trial, folder)


FAULTS: dict[str, Case] = {
    "drop": _surviving("20 % of images lost", "--drop", "0.2"),
    "latency": _surviving("images 300 ms late", "--latency-s", "0.3"),
    "jump": _surviving("pose jump", "--jump-at-s", "20"),
    "silent": _surviving("camera silent for 3 s", "--silent-at-s", "20"),
    "cancel": cancelled,
    "kill": killed,
}
"""What can go wrong, by name."""
