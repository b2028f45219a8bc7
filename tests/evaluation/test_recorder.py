"""What the recorder writes, line by line."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from toponav.evaluation.recorder import EpisodeRecorder
from toponav.geometry import Intrinsics, Pose
from toponav.geometry.conventions import BODY_FROM_OPTICAL
from toponav.mapping.view import MapView, OccupancyGrid, PointCloud
from toponav.memory.graph import TopologicalMemory
from toponav.memory.serialization import load_memory
from toponav.memory.snapshot import MemorySnapshot
from toponav.policy.affordances import Phase
from toponav.policy.decision import Decision
from toponav.reasoning import Guidance, PanoramaView, SeenObject
from toponav.types import Action, Observation


def observation(step: int, x: float, yaw: float = 0.0, collided: bool = False) -> Observation:
    foot = Pose.from_yaw(yaw, (x, 2.0, 0.0))
    return Observation(
        rgb=np.zeros((2, 3, 3), np.uint8),
        depth=np.zeros((2, 3), np.float32),
        world_from_camera=foot @ BODY_FROM_OPTICAL,
        world_from_base=foot,
        intrinsics=Intrinsics.from_hfov(3, 2, 79.0),
        collided=collided,
        step=step,
    )


def empty_view() -> MapView:
    nothing = PointCloud(
        np.zeros((0, 3), np.float32), np.zeros((0, 3), np.uint8), np.zeros(0, np.int32)
    )
    grid = OccupancyGrid(np.zeros((1, 1), np.int8), (0.0, 0.0), 0.1)
    return MapView(
        scene=nothing, objects={}, navigable=nothing, obstacles=nothing,
        frontiers=np.zeros((0, 3)), frontier_labels=np.zeros(0, np.int64), grid=grid, floor_z=0.0,
    )  # fmt: skip


def decision(**changes: Any) -> Decision:
    values: dict[str, Any] = {
        "index": 0, "step": 11, "phase": Phase.EXPLORATION,
        "waypoint": np.array([1.23456, 2.0, 0.0]),
        "path": np.array([[0.0, 2.0], [1.23456, 2.0]]), "map_view": empty_view(),
    }  # fmt: skip
    return Decision(**{**values, **changes})


def lines(path: Path) -> list[dict[str, Any]]:
    return [json.loads(line) for line in path.read_text().splitlines()]


def test_a_step_is_a_pose_and_the_action_chosen_there(tmp_path: Path) -> None:
    recorder = EpisodeRecorder(tmp_path)
    recorder.on_step(observation(0, 1.0, yaw=0.5), Action.MOVE_FORWARD)
    recorder.on_step(observation(1, 1.23456789, collided=True), Action.STOP)
    assert lines(tmp_path / "trajectory.jsonl") == [
        {"step": 0, "position": [1.0, 2.0, 0.0], "yaw": 0.5, "collided": False,
         "action": "move_forward"},
        {"step": 1, "position": [1.234568, 2.0, 0.0], "yaw": 0.0, "collided": True,
         "action": "stop"},
    ]  # fmt: skip


def test_every_line_is_on_the_disk_as_soon_as_it_happened(tmp_path: Path) -> None:
    recorder = EpisodeRecorder(tmp_path)
    for step in range(3):
        recorder.on_step(observation(step, 0.0), Action.TURN_LEFT)
        assert len(lines(tmp_path / "trajectory.jsonl")) == step + 1


def test_a_decision_without_memory_reasoner_or_goal_is_written_as_such(tmp_path: Path) -> None:
    EpisodeRecorder(tmp_path).on_decision(decision(waypoint=None, path=np.zeros((0, 2))))
    assert lines(tmp_path / "decisions.jsonl") == [
        {"index": 0, "step": 11, "phase": "exploration", "node": None, "guidance": None,
         "waypoint": None, "path": [], "memory_text": None, "views": []}
    ]  # fmt: skip


def test_a_full_decision_holds_what_a_replay_needs(tmp_path: Path) -> None:
    memory = TopologicalMemory()
    node = memory.add_node((0.0, 2.0), 0)
    memory.record_arrival(node.id)
    guidance = Guidance(
        node_id=node.id, direction=0, target_found=False, room_type="hall", reason="wide"
    )
    view = PanoramaView(
        image=np.zeros((2, 3, 3), np.uint8), bearing=0.5,
        seen=(SeenObject(label="chair", score=0.75, range_m=2.0),),
        navigable_area_m2=1.5, frontier_count=4,
    )  # fmt: skip
    snapshot = MemorySnapshot(memory.nodes, memory.edges, node.id, memory.history, "a text")
    EpisodeRecorder(tmp_path).on_decision(
        decision(memory=snapshot, guidance=guidance, panorama=(view,))
    )
    (line,) = lines(tmp_path / "decisions.jsonl")
    assert Guidance(**line["guidance"]) == guidance
    assert line["node"] == node.id
    assert line["memory_text"] == "a text"
    assert line["waypoint"] == [1.2346, 2.0, 0.0]
    assert line["path"] == [[0.0, 2.0], [1.2346, 2.0]]
    assert line["views"] == [
        {"bearing": 0.5, "frontiers": 4, "floor_m2": 1.5, "seen": [["chair", 0.75]]}
    ]


def test_the_memory_is_written_at_the_end_and_reads_back(tmp_path: Path) -> None:
    memory = TopologicalMemory()
    memory.record_arrival(memory.add_node((0.5, 2.0), 0).id)
    EpisodeRecorder(tmp_path).on_close(empty_view(), memory)
    assert load_memory(tmp_path / "memory.json").nodes == memory.nodes


def test_no_memory_no_file(tmp_path: Path) -> None:
    recorder = EpisodeRecorder(tmp_path)
    recorder.on_close(None, None)
    recorder.on_close(None, TopologicalMemory())
    assert not (tmp_path / "memory.json").exists()


def test_a_new_episode_replaces_the_files_of_the_last(tmp_path: Path) -> None:
    memory = TopologicalMemory()
    memory.record_arrival(memory.add_node((0.5, 2.0), 0).id)
    first = EpisodeRecorder(tmp_path / "deep" / "folder")
    first.on_step(observation(0, 0.0), Action.STOP)
    first.on_decision(decision())
    first.on_close(None, memory)
    EpisodeRecorder(tmp_path / "deep" / "folder")
    left = sorted(path.name for path in (tmp_path / "deep" / "folder").iterdir())
    assert left == ["decisions.jsonl", "trajectory.jsonl"]
    assert not any((tmp_path / "deep" / "folder" / name).read_text() for name in left)
