"""A map that was put down as arrays and taken up again goes on as if nothing had been."""

from __future__ import annotations

import numpy as np
import pytest
from map_frames import detections_of, floor_depth, observe

from toponav.errors import InputError
from toponav.mapping.semantic_map import MapConfig, SemanticMap
from toponav.mapping.serialization import map_arrays, map_of
from toponav.mapping.view import MapView
from toponav.types import Detections, Observation

CONFIG = MapConfig(stairwells=True)


def frames() -> list[tuple[Observation, Detections]]:
    shown = []
    for turn in range(6):
        depth = floor_depth(0.4, wall_distance=3.0)
        observation = observe(depth, foot=(0.1 * turn, 0.0, 0.0), yaw=turn * 0.6, pitch_down=0.4)
        mask = np.zeros(depth.shape, np.bool_)
        mask[5:12, 10:20] = True
        label = "stairs" if turn == 2 else "chair"
        shown.append((observation, detections_of((label, mask))))
    return shown


def mapped(count: int) -> SemanticMap:
    semantic_map = SemanticMap(CONFIG)
    for observation, detections in frames()[:count]:
        semantic_map.integrate(observation, detections)
    return semantic_map


def assert_same(a: MapView, b: MapView) -> None:
    assert set(a.objects) == set(b.objects)
    pairs = [(a.scene, b.scene), *((a.objects[c], b.objects[c]) for c in a.objects)]
    for one, other in pairs:
        assert np.array_equal(one.points, other.points)
        assert np.array_equal(one.colors, other.colors)
        assert np.array_equal(one.counts, other.counts)
    assert np.array_equal(a.grid.cells, b.grid.cells)
    assert np.array_equal(a.frontiers, b.frontiers)
    assert (a.floor, a.floor_z, a.grid.origin) == (b.floor, b.floor_z, b.grid.origin)


def test_it_goes_on_as_if_nothing_had_been() -> None:
    whole = mapped(6)
    restored = map_of(map_arrays(mapped(5)), CONFIG)
    last = frames()[5]
    restored.integrate(*last)
    assert_same(restored.view(), whole.view())


def test_another_resolution_or_a_missing_array_is_said() -> None:
    arrays = map_arrays(mapped(2))
    with pytest.raises(InputError, match=r"r_pcd=0\.05"):
        map_of(arrays, MapConfig(r_pcd=0.1))
    for name in ("scene/keys", "floors", "objects/chair/counts"):
        broken = {key: value for key, value in arrays.items() if key != name}
        with pytest.raises(InputError, match="broken"):
            map_of(broken, CONFIG)
    with pytest.raises(InputError, match="belong together"):
        map_of({**arrays, "scene/counts": arrays["scene/counts"][:-1]}, CONFIG)
    with pytest.raises(InputError, match="twice"):
        map_of({**arrays, "scene/keys": np.zeros_like(arrays["scene/keys"])}, CONFIG)
