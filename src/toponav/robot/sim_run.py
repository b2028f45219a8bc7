"""One run of the simulated robot, and what came of it."""

from __future__ import annotations

import csv
import io
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from toponav.envs.simulator import HouseEnv
from toponav.files import write_atomic
from toponav.robot.ros2_import import import_ros
from toponav.robot.ros2_run import interrupts
from toponav.robot.sim_base import TracePoint
from toponav.robot.sim_robot import SimRobot


def play(make: Callable[[], SimRobot], seconds: float, line: str) -> SimRobot:
    """Publish and obey until the time is up or the process is interrupted.

    Args:
        make: Makes the node.
        seconds: How long to play.
        line: Said on stderr once the robot publishes.
    """
    rclpy = import_ros("rclpy")
    handlers = import_ros("rclpy.signals").SignalHandlerOptions
    rclpy.init(signal_handler_options=handlers.NO)
    stopped = threading.Event()
    with interrupts(stopped):
        robot = make()
        sys.stderr.write(line + "\n")
        sys.stderr.flush()
        executor = import_ros("rclpy.executors").SingleThreadedExecutor()
        executor.add_node(robot.node)
        until_s = time.monotonic() + seconds
        try:
            while not stopped.is_set() and time.monotonic() < until_s:
                executor.spin_once(timeout_sec=0.1)
        finally:
            executor.shutdown(timeout_sec=1.0)
            rclpy.try_shutdown()
    return robot


def sim_result(env: HouseEnv, robot: SimRobot, trace: Path | None) -> dict[str, Any]:
    """Where the robot ended, and how it went; writes its trace."""
    base = robot.base
    if trace is not None:
        text = io.StringIO()
        writer = csv.writer(text)
        writer.writerow(TracePoint._fields)
        writer.writerows(base.trace)
        write_atomic(trace, text.getvalue())
    return {
        "scene": env.scene.name,
        "target": env.target,
        "distance_to_goal": env.oracle.distance_to_goal(),
        "position": env.position.tolist(),
        "travelled": base.travelled_m,
        "bumps": base.bumps,
        "bump_speed": base.bump_speed,
        "frames": robot.frames,
        "faults": robot.faults.times(),
    }
