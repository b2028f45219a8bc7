"""The map of real Kinect frames against a vectorised brute force."""

import numpy as np
import pytest
from map_frames import detections_of
from map_reference import world_points

from shared_data import shared_data
from toponav.envs.recording import Recording, open_recording
from toponav.mapping.semantic_map import MapConfig, SemanticMap

KITCHEN = "rgbd/7scenes-redkitchen"


@pytest.fixture(scope="module")
def kitchen() -> Recording:
    return open_recording(shared_data(KITCHEN), "y-down")


def downsampled(
    points: np.ndarray, colors: np.ndarray, resolution: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Centroids, mean colours and counts of voxels, in order of first observation."""
    voxels = np.floor(points / resolution).astype(np.int64)
    _, first, inverse, counts = np.unique(
        voxels, axis=0, return_index=True, return_inverse=True, return_counts=True
    )
    sums = np.zeros((len(first), 6))
    np.add.at(sums, inverse.ravel(), np.hstack([points, colors]))
    order = np.argsort(first)
    means = (sums / counts[:, None])[order]
    return means[:, :3], means[:, 3:], counts[order]


def test_scene_and_object_clouds_are_those_of_all_points(kitchen: Recording) -> None:
    config = MapConfig()
    semantic_map = SemanticMap(config)
    scene, chair = [], []
    for index in (0, 1, 30, 60, 99):
        observation = kitchen.observation(index)
        mask = np.zeros(observation.depth.shape, np.bool_)
        mask[100:300, 50 + index : 300 + index] = True
        semantic_map.integrate(observation, detections_of(("chair", mask)))
        scene.append(world_points(observation, config))
        chair.append(world_points(observation, config, mask))
    view = semantic_map.view()
    for cloud, parts in ((view.scene, scene), (view.objects["chair"], chair)):
        points, colors, counts = downsampled(
            np.concatenate([part[0] for part in parts]),
            np.concatenate([part[1] for part in parts]),
            config.r_pcd,
        )
        assert len(cloud) == len(points)
        np.testing.assert_array_equal(cloud.counts, counts)
        np.testing.assert_allclose(cloud.points, points, atol=1e-4)
        assert np.abs(cloud.colors - colors).max() <= 0.52  # a mean is kept in steps of 1 / 256


def test_layers_are_the_scene_cut_by_height(kitchen: Recording) -> None:
    config = MapConfig()
    semantic_map = SemanticMap(config)
    for index in range(0, 100, 20):
        observation = kitchen.observation(index)
        semantic_map.integrate(
            observation, detections_of(("plant", np.zeros(observation.depth.shape, np.bool_)))
        )
    view = semantic_map.view()
    height = view.scene.points[:, 2].astype(np.float64) - view.floor_z
    obstacle = (height > config.delta) & (height < config.obstacle_top_m)
    np.testing.assert_array_equal(view.obstacles.points, view.scene.points[obstacle])
    floor = view.scene.points[np.abs(height) <= config.delta]
    np.testing.assert_array_equal(view.navigable.points[: len(floor)], floor)
