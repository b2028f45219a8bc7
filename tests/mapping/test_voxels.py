"""Voxel clouds against brute force."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from map_reference import ReferenceCloud, voxels_of

from toponav.errors import ObservationError
from toponav.mapping.voxels import (
    INITIAL_CAPACITY,
    SETTLED_COUNT,
    VoxelCloud,
    columns_of,
    reach_m,
    unpack_keys,
)

RESOLUTION = 0.05


def assert_equal_clouds(cloud: VoxelCloud, reference: ReferenceCloud) -> None:
    result = cloud.cloud()
    keys = cloud.arrays.keys[: len(cloud)]
    assert [tuple(row) for row in unpack_keys(keys).tolist()] == reference.voxels
    np.testing.assert_allclose(result.points, reference.centroids(), atol=1e-4)
    np.testing.assert_array_equal(result.counts, reference.counts())
    assert (
        np.abs(result.colors - reference.mean_colors()).max(initial=0.0) <= 0.52
    )  # steps of 1 / 256


@settings(max_examples=30)
@given(st.integers(0, 2**32 - 1), st.integers(1, 5), st.floats(0.01, 30.0))
def test_batches_give_the_centroids_of_all_points(seed: int, batches: int, spread: float) -> None:
    rng = np.random.default_rng(seed)
    cloud, reference = VoxelCloud(RESOLUTION), ReferenceCloud(RESOLUTION)
    for _ in range(batches):
        points = rng.normal(0.0, spread, (rng.integers(0, 200), 3))
        colors = rng.integers(0, 256, points.shape, dtype=np.uint8)
        cloud.add(points, colors)
        reference.add(points, colors)
        assert_equal_clouds(cloud, reference)


def test_growth_keeps_every_voxel_in_order_of_first_observation() -> None:
    rng = np.random.default_rng(3)
    cells = rng.permutation(40**3)[: 10 * INITIAL_CAPACITY]
    corners = np.column_stack(np.unravel_index(cells, (40, 40, 40))) - 20.0
    points = (corners + 0.5) * RESOLUTION
    cloud = VoxelCloud(RESOLUTION)
    for chunk in np.array_split(points, 7):
        cloud.add(chunk)
    assert len(cloud) == len(points)
    np.testing.assert_allclose(cloud.cloud().points, points, atol=1e-6)
    cloud.add(points[::-1])
    assert len(cloud) == len(points)
    assert set(cloud.cloud().counts.tolist()) == {2}


def test_centroid_stays_near_the_mean_far_from_the_origin_and_over_many_points() -> None:
    rng = np.random.default_rng(5)
    corner = np.array([-4000, 3000, 77]) * RESOLUTION
    points = corner + rng.uniform(0.2, 0.3, (300_000, 3)) * RESOLUTION
    cloud = VoxelCloud(RESOLUTION)
    cloud.add(points)
    assert len(cloud) == 1
    # Single precision tells 0.015 mm apart there; a mean of many points no longer moves by less.
    np.testing.assert_allclose(cloud.cloud().points[0], points.mean(axis=0), atol=3e-4)


def test_keys_reach_as_far_as_the_cloud() -> None:
    cloud = VoxelCloud(RESOLUTION)
    reach = reach_m(RESOLUTION)
    points = np.array([[reach - 0.01, -reach + 0.01, 0.0], [-0.01, 0.01, -reach + 0.01]])
    cloud.add(points)
    keys = cloud.arrays.keys[:2]
    assert (keys >= 0).all()
    assert [tuple(row) for row in unpack_keys(keys).tolist()] == voxels_of(points, RESOLUTION)
    np.testing.assert_array_equal(columns_of(keys), unpack_keys(keys)[:, :2])


@pytest.mark.parametrize("bad", [np.nan, np.inf, 1e6])
def test_points_out_of_reach_are_refused_and_nothing_changes(bad: float) -> None:
    cloud = VoxelCloud(RESOLUTION)
    with pytest.raises(ObservationError, match="finite and within"):
        cloud.add(np.array([[0.0, 0.0, 0.0], [0.0, bad, 0.0]]))
    assert len(cloud) == 0


def test_a_voxel_that_averages_millions_of_points_takes_no_more() -> None:
    cloud = VoxelCloud(RESOLUTION)
    cloud.add(np.array([[0.01, 0.01, 0.01]]), np.full((1, 3), 255, np.uint8))
    cloud.arrays.counts[0] = SETTLED_COUNT
    cloud.add(np.array([[0.04, 0.04, 0.04]]), np.zeros((1, 3), np.uint8))
    result = cloud.cloud()
    assert result.counts[0] == SETTLED_COUNT
    assert result.colors[0].tolist() == [255, 255, 255]
    np.testing.assert_allclose(result.points[0], 0.01, atol=1e-6)


def test_the_cloud_cannot_be_written_through_its_view() -> None:
    cloud = VoxelCloud(RESOLUTION)
    cloud.add(np.zeros((1, 3)))
    with pytest.raises(ValueError, match="read-only"):
        cloud.cloud().points[0] = 1.0


def test_refresh_tells_what_was_touched_once_and_in_order() -> None:
    cloud = VoxelCloud(RESOLUTION)
    first, second = np.full(3, 0.01), np.full(3, 0.11)
    cloud.add(np.array([first, second]))
    assert cloud.refresh().tolist() == [0, 1]
    assert cloud.refresh().tolist() == []
    cloud.add(np.array([second, first, second]))
    assert cloud.refresh().tolist() == [1, 0]


def test_an_emptied_voxel_is_not_in_the_cloud_until_points_come_again() -> None:
    cloud = VoxelCloud(RESOLUTION)
    cloud.add(np.array([[0.01, 0.0, 0.0], [1.01, 0.0, 0.0], [2.01, 0.0, 0.0]]))
    slots = cloud.refresh()
    cloud.clear(slots[:0])
    assert not cloud.has_gaps
    cloud.clear(slots[1:2])
    np.testing.assert_allclose(cloud.cloud().points[:, 0], [0.01, 2.01], atol=1e-6)
    cloud.add(np.array([[2.03, 0.0, 0.0]]))
    np.testing.assert_allclose(cloud.cloud().points[:, 0], [0.01, 2.02], atol=1e-6)
    cloud.add(np.array([[1.04, 0.0, 0.0]]))
    np.testing.assert_allclose(cloud.cloud().points[:, 0], [0.01, 1.04, 2.02], atol=1e-6)
    assert len(cloud) == 3
