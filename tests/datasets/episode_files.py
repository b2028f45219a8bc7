"""Episode files in Habitat's format, made for the tests."""

from __future__ import annotations

import gzip
import json
from pathlib import Path
from typing import Any

SCENE_ID = "hm3d_v0.2/val/00877-4ok3usBNeis/4ok3usBNeis.basis.glb"
"""Named as in the published files."""

TASK_IDS = {"chair": 0, "bed": 1, "plant": 2, "toilet": 3, "tv_monitor": 4, "sofa": 5}


def viewpoint(x: float, y: float, z: float) -> dict[str, Any]:
    state = {"position": [x, y, z], "rotation": [0.0, 0.0, 0.0, 1.0]}
    return {"agent_state": state, "iou": 0.5}


def goal(object_id: int = 7, category: str = "bed", **changes: Any) -> dict[str, Any]:
    return {
        "position": [1.0, 0.4, -3.0], "radius": None, "object_id": object_id,
        "object_name": f"{category}_{object_id}", "object_name_id": None,
        "object_category": category, "room_id": None, "room_name": None,
        "view_points": [viewpoint(1.0, 0.1, -2.0), viewpoint(1.085, 0.1, -2.0)], **changes,
    }  # fmt: skip


def episode(**changes: Any) -> dict[str, Any]:
    return {
        "episode_id": "3", "scene_id": SCENE_ID,
        "scene_dataset_config": "./data/scene_datasets/hm3d_v0.2/x.scene_dataset_config.json",
        "additional_obj_config_paths": [], "start_position": [1.0, 0.1, 3.0],
        "start_rotation": [0.0, 0.0, 0.0, 1.0],
        "info": {"geodesic_distance": 5.5, "euclidean_distance": 5.0, "closest_goal_object_id": 7},
        "goals": [], "start_room": None, "shortest_paths": None, "object_category": "bed",
        **changes,
    }  # fmt: skip


def content(*episodes: dict[str, Any], **changes: Any) -> dict[str, Any]:
    return {
        "goals_by_category": {"4ok3usBNeis.basis.glb_bed": [goal()]},
        "episodes": list(episodes or (episode(),)),
        "category_to_task_category_id": TASK_IDS,
        "category_to_scene_annotation_category_id": TASK_IDS,
        **changes,
    }


def write(path: Path, data: dict[str, Any]) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(gzip.compress(json.dumps(data).encode()))
    return path
