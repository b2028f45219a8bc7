"""Writes what an episode did, as it happens: every step, every decision, the last memory."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from toponav.files import append_line, write_atomic
from toponav.mapping.view import MapView
from toponav.memory.graph import TopologicalMemory
from toponav.memory.serialization import save_memory
from toponav.policy.decision import Decision
from toponav.types import Action, Observation

POSITION_DIGITS = 6
"""Decimals of metres and radians in the files: far below any tolerance, and readable."""


class EpisodeRecorder:
    """Records one episode into a folder; a step observer and a decision listener.

    `trajectory.jsonl` has one line a step (pose before the action, and the action);
    `decisions.jsonl` one a decision, enough to replay it; `memory.json` the memory at the end.
    """

    def __init__(self, folder: Path) -> None:
        """Start new files in `folder`, replacing those of an earlier episode."""
        folder.mkdir(parents=True, exist_ok=True)
        self._trajectory = folder / "trajectory.jsonl"
        self._decisions = folder / "decisions.jsonl"
        self._memory = folder / "memory.json"
        for path in (self._trajectory, self._decisions):
            write_atomic(path, "")
        self._memory.unlink(missing_ok=True)

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
        append_line(self._trajectory, json.dumps(line))

    def on_decision(self, decision: Decision) -> None:
        """Append one line to `decisions.jsonl`."""
        append_line(self._decisions, json.dumps(_decision_line(decision)))

    def on_close(self, map_view: MapView | None, memory: TopologicalMemory | None) -> None:
        """Write `memory.json`, when the method keeps a memory and made a decision."""
        del map_view
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
