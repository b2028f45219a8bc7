"""Writes what an episode did, as it happens: every step, every decision, the last memory."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from toponav.evaluation.model_files import episode_name
from toponav.files import discard_temporaries
from toponav.mapping.view import MapView
from toponav.memory.graph import TopologicalMemory
from toponav.memory.serialization import save_memory
from toponav.policy.decision import Decision
from toponav.types import Action, Observation

POSITION_DIGITS = 6
"""Decimals of metres and radians in the files: far below any tolerance, and readable."""


def episode_folder(run: Path, scene: str, index: int) -> Path:
    """Where an episode of a run is recorded."""
    return run / "episodes" / episode_name(scene, index)


class EpisodeRecorder:
    """Records one episode into a folder; a step observer and a decision listener.

    `trajectory.jsonl` has one line a step (pose before the action, and the action);
    `decisions.jsonl` one a decision, enough to replay it; `memory.json` the memory at the end.
    """

    def __init__(self, folder: Path) -> None:
        """Start new files in `folder`, replacing those of an earlier episode."""
        folder.mkdir(parents=True, exist_ok=True)
        self._memory = folder / "memory.json"
        trajectory, decisions = folder / "trajectory.jsonl", folder / "decisions.jsonl"
        # Removed, not emptied: a worker that outlives its killed run for a moment may have them
        # open, and must not write between the lines of this one.
        for path in (trajectory, decisions, self._memory):
            path.unlink(missing_ok=True)
        discard_temporaries(folder)
        # Buffered by line: what happened before a kill is there, without a disk access a step.
        self._trajectory = trajectory.open("w", encoding="utf-8", buffering=1)
        self._decisions = decisions.open("w", encoding="utf-8", buffering=1)

    def on_step(self, observation: Observation, action: Action) -> None:
        """Append one line to `trajectory.jsonl`."""
        base = observation.world_from_base
        line = {
            "step": observation.step,
            "position": [round(float(x), POSITION_DIGITS) for x in base.translation],
            "yaw": round(base.yaw, POSITION_DIGITS),
            "collided": observation.collided,
            "action": action.name.lower(),
        }
        self._trajectory.write(json.dumps(line) + "\n")

    def on_decision(self, decision: Decision) -> None:
        """Append one line to `decisions.jsonl`."""
        self._decisions.write(json.dumps(_decision_line(decision)) + "\n")

    def on_close(self, map_view: MapView | None, memory: TopologicalMemory | None) -> None:
        """Close the files; write `memory.json`, when the method keeps a memory and decided."""
        del map_view
        self._trajectory.close()
        self._decisions.close()
        if memory is not None and memory.nodes:
            save_memory(memory, self._memory)


def _decision_line(decision: Decision) -> dict[str, Any]:
    waypoint = decision.waypoint
    return {
        "index": decision.index,
        "step": decision.step,
        "phase": decision.phase.value,
        "node": None if decision.memory is None else decision.memory.current,
        "guidance": None if decision.guidance is None else decision.guidance.model_dump(),
        "waypoint": None if waypoint is None else [round(float(x), 4) for x in waypoint],
        "path": [[round(float(x), 4), round(float(y), 4)] for x, y in decision.path],
        "memory_text": None if decision.memory is None else decision.memory.text,
        "views": [
            {
                "bearing": round(view.bearing, 4),
                "frontiers": view.frontier_count,
                "floor_m2": round(view.navigable_area_m2, 4),
                "seen": [[item.label, round(item.score, 4)] for item in view.seen],
            }
            for view in decision.panorama
        ],
    }
