"""One run of the node: until the search is over, or until it is interrupted."""

from __future__ import annotations

import signal
import threading
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from toponav.knowledge import RecallingAgent
from toponav.robot.memory_file import MemoryKeeper
from toponav.robot.ros2_import import import_ros
from toponav.robot.ros2_lifecycle import start_by_itself
from toponav.robot.ros2_node import SearchNode, Task
from toponav.robot.search import Status


@dataclass(frozen=True)
class RunOptions:
    """How the node is run, and what it writes.

    Attributes:
        memory: File of what is known of the building.
        out: Folder of the map's clouds.
        watchers: Each called with the node before it starts, to watch it.
        managed: Whether a lifecycle manager configures and activates the node.
    """

    memory: Path | None = None
    out: Path | None = None
    watchers: Sequence[Callable[[SearchNode], object]] = ()
    managed: bool = False


def run_node(
    task: Task,
    target: str | None,
    timeout_s: float,
    options: RunOptions,
    say: Callable[[str], None],
) -> dict[str, Any]:
    """Search for a target, or wait for goals; the last status, with the seconds it took.

    Raises:
        TopoNavError: A thread of the node failed.
    """
    rclpy = import_ros("rclpy")
    handlers = import_ros("rclpy.signals").SignalHandlerOptions
    rclpy.init(signal_handler_options=handlers.NO)
    stopped = threading.Event()
    with interrupts(stopped):
        node = SearchNode(task)
        keeper = None
        if options.memory is not None and isinstance(task.agent, RecallingAgent):
            keeper = MemoryKeeper(options.memory, task.agent, node.senses)
            node.search.watchers.append(keeper)
        for watch in options.watchers:
            watch(node)
        executor = import_ros("rclpy.executors").SingleThreadedExecutor()
        executor.add_node(node.node)
        begun_s = time.monotonic()
        node.start()
        if not options.managed:
            start_by_itself(node.node)
        if target is not None:
            node.search.start(target)
        told = ""
        try:
            while not (stopped.is_set() or node.ended.is_set()):
                executor.spin_once(timeout_sec=0.1)
                node.raise_failure()
                line = _line(node)
                if line != told:
                    say(line)
                    told = line
                over = node.search.status not in (Status.SEARCHING, Status.IDLE)
                late = time.monotonic() - begun_s > timeout_s
                if target is not None and (over or late):
                    break
            status = _finish(node, executor, stopped.is_set())
        finally:
            node.close()
            executor.shutdown(timeout_sec=1.0)
            rclpy.try_shutdown()
    if keeper is not None:
        keeper.write()
    if options.out is not None and isinstance(task.agent, RecallingAgent):
        from toponav.evaluation.mapping_run import write_clouds

        write_clouds(task.agent.knowledge.semantic_map.view(), options.out)
    return {
        **status,
        "seconds": time.monotonic() - begun_s,
        "remembered": task.remembered,
    }


def _finish(node: SearchNode, executor: Any, interrupted: bool) -> dict[str, Any]:
    """Say the last things, and give the middleware a moment to send them."""
    if node.search.status is Status.SEARCHING:
        why = "interrupted" if interrupted else "the time is up"
        node.search.cancel(f"{why}: {node.search.reason}" if node.search.reason else why)
    node.tell()
    status = node.status()
    until_s = time.monotonic() + 0.3
    while time.monotonic() < until_s:
        executor.spin_once(timeout_sec=0.05)
    return status


def _line(node: SearchNode) -> str:
    search = node.search
    about = f" for {search.goal}" if search.goal else ""
    why = f": {search.reason}" if search.reason else ""
    return f"{search.status.value}{about}{why}"


class interrupts:  # noqa: N801
    """While it lasts, Ctrl-C and SIGTERM set an event instead of breaking off."""

    def __init__(self, event: threading.Event) -> None:
        """Set `event`."""
        self._event = event
        self._before: dict[int, Any] = {}

    def __enter__(self) -> None:
        """Take the signals over, where this is the main thread."""
        with suppress(ValueError):
            for number in (signal.SIGINT, signal.SIGTERM):
                self._before[number] = signal.signal(number, lambda *_: self._event.set())

    def __exit__(self, *_: object) -> None:
        """Give them back."""
        for number, handler in self._before.items():
            signal.signal(number, handler)
