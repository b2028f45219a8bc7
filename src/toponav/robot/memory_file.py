"""What the robot knows of the building, kept on the disk while it searches."""

from __future__ import annotations

import json
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from toponav.errors import InputError, PoseError
from toponav.files import write_atomic
from toponav.geometry import Pose
from toponav.knowledge import Knowledge, RecallingAgent, load_knowledge, save_knowledge
from toponav.mapping.semantic_map import MapConfig
from toponav.robot.frame_sync import Instant
from toponav.robot.intent import Intent
from toponav.robot.senses import Senses

PERIOD_S = 5.0
"""Between two times that it is written, seconds: so much is lost when the node is killed."""


@dataclass(frozen=True, eq=False)
class Remembered:
    """What a file held.

    Attributes:
        knowledge: Map and memory.
        slam_from_world: The frame of the pose topic from that of the map.
    """

    knowledge: Knowledge
    slam_from_world: Pose


def frame_file(path: Path) -> Path:
    """Where it says how the map lies in the pose topic's frame."""
    return path.with_name(path.name + ".frame.json")


def load_memory(path: Path, config: MapConfig) -> Remembered | None:
    """Read what `MemoryKeeper` wrote; None where there is no such file.

    Raises:
        InputError: It is none of ours, or is damaged.
    """
    if not path.exists():
        return None
    knowledge, beside = load_knowledge(path, config), frame_file(path)
    if not beside.exists():
        return Remembered(knowledge, Pose.identity())
    try:
        matrix = json.loads(beside.read_text(encoding="utf-8"))
        return Remembered(knowledge, Pose(np.array(matrix, dtype=np.float64)))
    except (ValueError, TypeError, PoseError) as error:
        raise InputError(f"{beside} is no pose: {error}; remove it and {path}") from error


class MemoryKeeper:
    """Writes the agent's knowledge every few seconds; a `SearchWatcher`."""

    def __init__(self, path: Path, agent: RecallingAgent, senses: Senses) -> None:
        """Write to `path`."""
        self._path, self._agent, self._senses = path, agent, senses
        self._written_s = time.monotonic()

    def __call__(self, instant: Instant, intent: Intent | None) -> None:
        """Write if it is time to; called in the agent's thread."""
        del instant, intent
        if time.monotonic() - self._written_s >= PERIOD_S:
            self.write()

    def write(self) -> None:
        """Write now; not while the agent acts.

        Raises:
            InputError: The folder cannot be written.
        """
        begun_s = time.perf_counter()
        # The frame first: a map without one lies where the pose topic's frame is.
        matrix = self._senses.slam_from_world.matrix.tolist()
        write_atomic(frame_file(self._path), json.dumps(matrix).encode())
        save_knowledge(self._agent.knowledge, self._path)
        self._senses.timings.add("memory file", time.perf_counter() - begun_s)
        self._written_s = time.monotonic()
