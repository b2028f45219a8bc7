"""A house of two levels: the target on the other one is found, upstairs and downstairs alike."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from small_house import small_config
from toponav.evaluation.runner import SceneRunner
from toponav.scenes.loading import load_scene

STOREY_M = 2.8
ROOM = [[0.0, 0.0], [6.0, 0.0], [6.0, 4.0], [0.0, 4.0]]
STARTS = {"up": ("bed", 0.0), "down": ("toilet", STOREY_M)}
"""Way to walk: what is looked for, and the floor on which the search starts."""


def level(floor: float, category: str, size: list[float]) -> dict[str, object]:
    item = {"id": f"{category}0", "category": category, "position": [5.2, 1.6, floor]}
    return {
        "floor": floor,
        "rooms": [{"id": "r", "type": "unknown", "polygon": ROOM, "height": 2.6}],
        "openings": [],
        "objects": [{**item, "size": size, "yaw": 0.0}],
    }


@pytest.fixture(scope="module")
def house(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("house") / "two_levels.json"
    data = {
        "format": "toponav-house/1",
        "name": "two levels",
        "levels": [
            level(0.0, "toilet", [0.5, 0.7, 0.8]),
            level(STOREY_M, "bed", [1.4, 1.2, 0.5]),
        ],
        "stairs": [
            {"from_level": 0, "to_level": 1, "start": [1.2, 3.4], "end": [4.6, 3.4], "width": 1.0}
        ],
        "episodes": [
            {"target": target, "start": [1.0, 1.2, floor], "yaw": 0.0}
            for target, floor in STARTS.values()
        ],
    }
    path.write_text(json.dumps(data), encoding="utf-8")
    return path


@pytest.mark.parametrize("way", STARTS)
def test_the_target_on_the_other_level_is_found(house: Path, way: str) -> None:
    config = small_config(preset="default", max_steps=400)
    runner = SceneRunner(load_scene(str(house)), config)
    result = runner.run(runner.episode(list(STARTS).index(way)))
    assert result.floor_change
    assert result.success["0.1"], result


@pytest.mark.parametrize("way", STARTS)
@pytest.mark.parametrize("by_shape", [True, False])
def test_where_nothing_names_stairs_their_shape_does(
    house: Path, way: str, *, by_shape: bool
) -> None:
    config = small_config(preset="default", max_steps=400)
    names = tuple(name for name in config.navigator.vocabulary if name != "stairs")
    grown = config.navigator.map.model_copy(update={"stairs_by_shape": by_shape})
    navigator = config.navigator.model_copy(update={"vocabulary": names, "map": grown})
    runner = SceneRunner(load_scene(str(house)), config.model_copy(update={"navigator": navigator}))
    result = runner.run(runner.episode(list(STARTS).index(way)))
    assert result.success["0.1"] == by_shape, result
