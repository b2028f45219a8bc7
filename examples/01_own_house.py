"""A house written by hand: two rooms, a door, a bed; saved, loaded and searched."""

import json
import tempfile
from pathlib import Path

from toponav import HouseEnvConfig, load_scene
from toponav.evaluation.run_config import run_config
from toponav.evaluation.runner import SceneRunner

HOUSE = {
    "format": "toponav-house/1",
    "name": "two_rooms",
    "levels": [
        {
            "rooms": [
                {"id": "hall", "type": "hallway", "polygon": [[0, 0], [3, 0], [3, 4], [0, 4]]},
                {"id": "bed", "type": "bedroom", "polygon": [[3, 0], [7, 0], [7, 4], [3, 4]]},
            ],
            "openings": [{"kind": "door", "rooms": ["hall", "bed"], "center": [3, 1]}],
            "objects": [
                {"id": "b1", "category": "bed", "position": [5.9, 2.9, 0], "size": [1.6, 2.0, 0.9]},
                {"id": "p1", "category": "plant", "position": [0.4, 3.6, 0], "size": [0.5, 0.5, 1]},
            ],
        }
    ],
    "episodes": [{"target": "bed", "start": [1.5, 3.0, 0], "yaw": 3.14}],
}

with tempfile.TemporaryDirectory() as folder:
    path = Path(folder) / "two_rooms.json"
    path.write_text(json.dumps(HOUSE))
    config = run_config("default", env=HouseEnvConfig(width=320, height=240))
    runner = SceneRunner(load_scene(str(path)), config)
    result = runner.run(runner.episode(0))
print(f"found: {result.succeeded}, SPL {result.spl:.2f}, {result.steps} steps")
