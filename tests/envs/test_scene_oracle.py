"""Ground truth of an episode: what can be reached, and how far it is."""

from __future__ import annotations

import math

import numpy as np
import pytest
from box_scenes import Box, room

from toponav.envs.simulator import HouseEnv, HouseEnvConfig
from toponav.errors import EpisodeError
from toponav.scenes.mesh import Scene

SAFE: list[tuple[str, Box]] = [
    ("wall", ((1.0, 0.2, 0.0), (1.1, 1.2, 2.5))),
    ("wall", ((2.0, 0.2, 0.0), (2.1, 1.2, 2.5))),
    ("wall", ((1.0, 0.2, 0.0), (2.1, 0.3, 2.5))),
    ("wall", ((1.0, 1.1, 0.0), (2.1, 1.2, 2.5))),
]
"""Four walls around a place that nobody can enter or look into."""

PARTS: list[tuple[str, Box]] = [
    *SAFE,
    ("toilet", ((1.4, 0.5, 0.0), (1.7, 0.8, 0.4))),
    ("table", ((4.0, 1.5, 0.0), (5.0, 2.5, 0.75))),
    ("bed", ((0.0, 3.0, 0.0), (1.5, 4.0, 0.5))),
    ("unknown", ((3.0, 0.2, 0.0), (3.3, 0.5, 0.5))),
]


@pytest.fixture(scope="module")
def env() -> HouseEnv:
    scene = Scene("box", room(extra=PARTS), floors=(0.0,))
    return HouseEnv(scene, HouseEnvConfig(width=32, height=24))


def test_categories_are_those_that_can_be_seen_from_where_one_can_stand(env: HouseEnv) -> None:
    assert env.oracle.categories() == ("bed", "table")
    assert env.oracle.viewpoints("toilet").shape == (0, 3)
    with pytest.raises(EpisodeError, match="no reachable toilet; it has bed, table"):
        env.reset(options={"target": "toilet"})


def test_the_distance_to_the_goal_is_that_to_the_nearest_viewpoint(env: HouseEnv) -> None:
    env.reset(options={"target": "table", "start": (0.5, 2.0, 0.0, 0.0)})
    viewpoints = env.oracle.viewpoints("table")
    straight = np.linalg.norm(viewpoints - env.position, axis=1)
    nearest = viewpoints[straight.argmin()]
    # Nothing lies between: the shortest path is the straight line.
    assert env.oracle.distance_to_goal() == pytest.approx(straight.min(), abs=0.03)
    geodesic = env.oracle.geodesic_distance(env.position, nearest)
    assert geodesic == pytest.approx(straight.min(), abs=0.03)


def test_the_distance_follows_the_agent_and_the_target(env: HouseEnv) -> None:
    start = (0.5, 2.0, 0.0, 0.0)
    env.reset(options={"target": "table", "start": start})
    before = env.oracle.distance_to_goal()
    env.step(1)
    assert env.oracle.distance_to_goal() == pytest.approx(before - 0.25, abs=0.02)
    env.reset(options={"target": "bed", "start": start})
    assert env.oracle.distance_to_goal() == pytest.approx(0.0, abs=0.1)


def test_viewpoints_that_a_dataset_brings_count_instead_of_those_found() -> None:
    given = np.array([[0.5, 1.0, 0.0], [0.6, 1.0, 0.0]])
    nowhere = np.zeros((0, 3))
    scene = Scene(
        "box", room(extra=PARTS), floors=(0.0,), viewpoints={"table": given, "bed": nowhere}
    )
    env = HouseEnv(scene, HouseEnvConfig(width=32, height=24))
    assert env.oracle.categories() == ("table",)
    env.reset(options={"target": "table", "start": (0.6, 2.0, 0.0, 0.0)})
    assert env.oracle.distance_to_goal() == pytest.approx(1.0, abs=0.03)


def test_synonyms_name_the_same_viewpoints(env: HouseEnv) -> None:
    np.testing.assert_array_equal(env.oracle.viewpoints("Bed"), env.oracle.viewpoints("bed"))


def test_without_a_path_the_distance_is_infinite(env: HouseEnv) -> None:
    inside_the_table = np.array([4.5, 2.0, 0.0])
    outside = np.array([0.5, 2.0, 0.0])
    assert math.isinf(env.oracle.geodesic_distance(outside, inside_the_table))


def test_labels_are_those_of_the_last_image(env: HouseEnv) -> None:
    env.reset(options={"target": "table", "start": (2.5, 2.0, 0.0, 0.0)})
    frame = env.oracle.semantic_frame()
    assert frame.instance_ids.shape == (24, 32)
    ahead = frame.instances[frame.instance_ids[20, 16]]
    assert ahead.category == "table"
    for _ in range(6):
        env.step(2)
    behind = env.oracle.semantic_frame()
    assert "table" not in {frame.instances[k].category for k in np.unique(behind.instance_ids)}
