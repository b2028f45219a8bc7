"""What is near places: remembered answers are those of a fresh look at all points."""

from __future__ import annotations

import numpy as np
import pytest

from toponav.mapping.nearby import NearObjects, near_objects
from toponav.mapping.surroundings import BLOCK, MOST_CHANGES, MOST_PLACES, Surroundings, VoxelBlocks
from toponav.mapping.voxels import VoxelCloud

RESOLUTION = 0.05
RADIUS_M = 1.5
HEIGHTS_M = (0.2, 1.5)


def plain(
    objects: dict[str, VoxelCloud], places: np.ndarray, radius_m: float = RADIUS_M
) -> list[NearObjects]:
    points = {name: cloud.cloud().points for name, cloud in objects.items()}
    return near_objects(points, places, radius_m, HEIGHTS_M)


def scattered(rng: np.random.Generator, count: int) -> np.ndarray:
    """Points about one spot, as a frame shows them."""
    return rng.uniform((0, 0, 0), (12, 12, 2), 3) + rng.normal(0.0, 0.4, (count, 3))


@pytest.mark.parametrize("seed", range(10))
def test_answers_are_those_of_a_look_at_everything(seed: int) -> None:
    rng = np.random.default_rng(seed)
    scene = VoxelCloud(RESOLUTION)
    objects: dict[str, VoxelCloud] = {}
    surroundings = Surroundings(objects)
    places = rng.uniform(0, 12, (30, 2))
    for _ in range(12):
        points = scattered(rng, 300)
        cloud = objects.setdefault(str(rng.choice(["bed", "chair"])), VoxelCloud(RESOLUTION))
        scene.add(points)
        cloud.add(points)
        surroundings.changed(scene.arrays.points, scene.refresh())
        gone = np.flatnonzero(rng.random(len(cloud)) < 0.02).astype(np.int32)
        cloud.clear(gone)
        surroundings.changed(cloud.arrays.points, gone)
        asked = places[rng.random(len(places)) < 0.7]
        assert surroundings.near(asked, RADIUS_M, HEIGHTS_M) == plain(objects, asked)
    assert surroundings.nbytes > 0


def test_a_place_is_asked_about_with_a_radius_and_heights() -> None:
    objects = {"bed": VoxelCloud(RESOLUTION)}
    objects["bed"].add(np.array([(1.0, 0.0, 0.5)]))
    surroundings, here = Surroundings(objects), np.zeros((1, 2))
    assert surroundings.near(here, 0.5, HEIGHTS_M) == [{}]
    assert surroundings.near(here, 1.5, HEIGHTS_M) == plain(objects, here)
    assert surroundings.near(here, 1.5, (1.0, 2.0)) == [{}]


def test_many_changes_are_one() -> None:
    rng = np.random.default_rng(0)
    objects = {"bed": VoxelCloud(RESOLUTION)}
    surroundings, places = Surroundings(objects), rng.uniform(0, 12, (20, 2))
    surroundings.near(places, RADIUS_M, HEIGHTS_M)
    for _ in range(MOST_CHANGES + 1):
        objects["bed"].add(scattered(rng, 10))
        surroundings.changed(objects["bed"].arrays.points, objects["bed"].refresh())
    assert surroundings.near(places, RADIUS_M, HEIGHTS_M) == plain(objects, places)


def test_more_places_than_are_remembered_are_answered() -> None:
    rng = np.random.default_rng(0)
    objects = {"bed": VoxelCloud(RESOLUTION)}
    objects["bed"].add(scattered(rng, 500))
    surroundings = Surroundings(objects)
    places = rng.uniform(0, 12, (MOST_PLACES + 10, 2))
    for _ in range(2):
        assert surroundings.near(places, RADIUS_M, HEIGHTS_M) == plain(objects, places)


def test_blocks_find_the_voxels_of_a_box() -> None:
    rng = np.random.default_rng(0)
    cloud, blocks = VoxelCloud(RESOLUTION), VoxelBlocks()
    for _ in range(3):
        cloud.add(rng.uniform(-5, 5, (BLOCK, 3)))
        points = cloud.cloud().points
        found = blocks.points_within(cloud, (-1.0, 0.0, 2.0, 3.0))
        inside = ((points[:, :2] >= (-1.0, 0.0)) & (points[:, :2] <= (2.0, 3.0))).all(axis=1)
        assert {tuple(row) for row in points[inside]} <= {tuple(row) for row in found}
        assert ((found[:, :2] >= (-1.06, -0.06)) & (found[:, :2] <= (2.06, 3.06))).all()
