"""The map against its brute-force reference, and against what can be worked out by hand."""

from collections.abc import Iterable

import numpy as np
import pytest
from map_frames import detections_of, floor_depth, nothing_seen, observe, random_frame
from map_reference import ReferenceCloud, ReferenceMap, Voxel, voxels_of
from numpy.typing import NDArray
from pydantic import ValidationError

from toponav.errors import ObservationError
from toponav.mapping.semantic_map import MapConfig, SemanticMap
from toponav.mapping.view import FREE, OCCUPIED, UNKNOWN, MapView, PointCloud
from toponav.types import Detections, Observation

Frame = tuple[Observation, Detections]


def by_voxel(cloud: PointCloud, resolution: float) -> dict[Voxel, NDArray[np.float32]]:
    points = cloud.points.astype(np.float64)
    return dict(zip(voxels_of(points, resolution), cloud.points, strict=True))


def assert_same_points(
    cloud: PointCloud, expected: dict[Voxel, NDArray[np.float64]], config: MapConfig
) -> None:
    got = by_voxel(cloud, config.r_pcd)
    assert len(got) == len(cloud), "two points in one voxel"
    assert got.keys() == expected.keys()
    for voxel, point in expected.items():
        np.testing.assert_allclose(got[voxel], point, atol=1e-4)


def assert_same_cloud(cloud: PointCloud, reference: ReferenceCloud) -> None:
    np.testing.assert_allclose(cloud.points, reference.centroids(), atol=1e-4)
    np.testing.assert_array_equal(cloud.counts, reference.counts())
    assert np.abs(cloud.colors - reference.mean_colors()).max(initial=0.0) <= 0.5


def assert_same_map(view: MapView, reference: ReferenceMap) -> None:
    config = reference.config
    assert_same_cloud(view.scene, reference.scene)
    seen = {label: cloud for label, cloud in reference.objects.items() if cloud.members}
    assert view.objects.keys() == seen.keys()
    for label, cloud in seen.items():
        assert_same_cloud(view.objects[label], cloud)
    assert_same_points(view.navigable, reference.navigable(), config)
    assert_same_points(view.obstacles, reference.obstacles(), config)
    first = np.rint(np.array(view.grid.origin) / config.r_g).astype(int)
    known = np.argwhere(view.grid.cells != UNKNOWN)
    cells = {tuple((index + first).tolist()): int(view.grid.cells[tuple(index)]) for index in known}
    assert cells == reference.cells()


def run_both(frames: Iterable[Frame], config: MapConfig) -> tuple[SemanticMap, ReferenceMap]:
    semantic_map, reference = SemanticMap(config), ReferenceMap(config, 0.0)
    for observation, detections in frames:
        update = semantic_map.integrate(observation, detections)
        navigable = reference.integrate(observation, detections)
        np.testing.assert_allclose(update.navigable_points, navigable, atol=1e-4)
    return semantic_map, reference


@pytest.mark.parametrize("seed", range(6))
def test_random_frames_give_the_reference_map(seed: int) -> None:
    rng = np.random.default_rng(seed)
    config = MapConfig(
        min_obstacle_voxels=1 + seed % 2, pixel_stride=1 + seed % 3, max_depth_m=3.0 + seed % 2
    )
    semantic_map, reference = run_both([random_frame(rng) for _ in range(4)], config)
    assert_same_map(semantic_map.view(), reference)


def test_views_between_frames_do_not_change_the_result() -> None:
    frames = [random_frame(np.random.default_rng(seed)) for seed in range(5)]
    quiet, looked_at = SemanticMap(), SemanticMap()
    for frame in frames:
        quiet.integrate(*frame)
        looked_at.integrate(*frame)
        looked_at.view()
    a, b = quiet.view(), looked_at.view()
    np.testing.assert_array_equal(a.grid.cells, b.grid.cells)
    np.testing.assert_array_equal(a.frontiers, b.frontiers)
    np.testing.assert_array_equal(a.frontier_labels, b.frontier_labels)
    np.testing.assert_array_equal(a.navigable.points, b.navigable.points)


def test_a_view_of_an_unchanged_map_is_the_same_object() -> None:
    semantic_map = SemanticMap()
    semantic_map.integrate(*random_frame(np.random.default_rng(0)))
    assert semantic_map.view() is semantic_map.view()
    before = semantic_map.view()
    semantic_map.integrate(*random_frame(np.random.default_rng(1)))
    assert semantic_map.view() is not before


def test_an_empty_map_has_an_empty_view() -> None:
    view = SemanticMap().view()
    assert len(view.scene) == len(view.navigable) == len(view.obstacles) == len(view.frontiers) == 0
    assert not view.objects
    assert view.grid.cells.size == 0


def test_a_frame_without_returns_shows_only_the_ground_underfoot() -> None:
    semantic_map = SemanticMap()
    observation = observe(np.zeros((30, 40)), foot=(1.0, -2.0, 0.3))
    update = semantic_map.integrate(observation, nothing_seen(observation))
    view = semantic_map.view()
    assert len(update.navigable_points) == 0
    assert update.labels == ()
    assert len(view.scene) == len(view.obstacles) == 0
    assert view.floor_z == 0.3
    distance = np.hypot(*(view.navigable.points[:, :2] - (1.0, -2.0)).T)
    assert distance.max() <= semantic_map.config.standing_radius_m + 1e-6
    assert view.grid.cells[tuple(view.grid.index_of((1.0, -2.0)))] == FREE


def test_depth_at_or_over_the_limit_is_no_return() -> None:
    depth = np.zeros((30, 40))
    depth[10, 10], depth[10, 20], depth[10, 30] = 5.0, 4.99, 6.0
    semantic_map = SemanticMap()
    observation = observe(depth)
    semantic_map.integrate(observation, nothing_seen(observation))
    assert len(semantic_map.view().scene) == 1


def test_a_pixel_counts_for_every_category_over_it() -> None:
    observation = observe(floor_depth())
    mask = np.ones(observation.depth.shape, np.bool_)
    semantic_map = SemanticMap()
    update = semantic_map.integrate(observation, detections_of(("sofa", mask), ("cushion", mask)))
    view = semantic_map.view()
    assert update.labels == ("sofa", "cushion")
    np.testing.assert_array_equal(view.objects["sofa"].points, view.scene.points)
    np.testing.assert_array_equal(view.objects["cushion"].points, view.scene.points)


def test_a_category_without_a_return_is_not_in_the_map() -> None:
    observation = observe(np.zeros((30, 40)))
    semantic_map = SemanticMap()
    mask = np.ones(observation.depth.shape, np.bool_)
    update = semantic_map.integrate(observation, detections_of(("bed", mask)))
    assert update.labels == ()
    assert "bed" not in semantic_map.view().objects


def test_masks_of_another_size_are_refused() -> None:
    observation = observe(np.zeros((30, 40)))
    with pytest.raises(ObservationError, match="masks must be of the image's size"):
        SemanticMap().integrate(observation, Detections.empty(15, 20))


def test_a_camera_beyond_the_maps_reach_is_refused() -> None:
    observation = observe(np.ones((30, 40)), foot=(6e4, 0.0, 0.0))
    with pytest.raises(ObservationError, match="move the world frame's origin nearer"):
        SemanticMap().integrate(observation, nothing_seen(observation))


def test_a_pose_that_jumps_across_the_country_is_refused() -> None:
    semantic_map = SemanticMap()
    here, far = observe(floor_depth()), observe(floor_depth(), foot=(9000.0, 8000.0, 0.0))
    semantic_map.integrate(here, nothing_seen(here))
    with pytest.raises(ObservationError, match="check the poses for a jump"):
        semantic_map.integrate(far, nothing_seen(far))


def test_obstacles_win_over_the_floor_and_end_over_the_agents_head() -> None:
    """A wall at 2 m seen level: its cells are occupied, though its foot lies in the floor band."""
    observation = observe(floor_depth(pitch_down=0.0, wall_distance=2.02))
    semantic_map = SemanticMap()
    semantic_map.integrate(observation, nothing_seen(observation))
    view = semantic_map.view()
    assert view.grid.cells[tuple(view.grid.index_of((2.02, 0.0)))] == OCCUPIED
    top = semantic_map.config.obstacle_top_m
    assert view.scene.points[:, 2].max() > 2.0 > top
    assert view.obstacles.points[:, 2].max() < top
    assert view.obstacles.points[:, 2].min() > semantic_map.config.delta


def test_stairs_are_navigable_at_any_height_and_no_obstacle() -> None:
    observation = observe(floor_depth(pitch_down=0.0, wall_distance=2.02))
    everything = np.ones(observation.depth.shape, np.bool_)
    semantic_map = SemanticMap()
    semantic_map.integrate(observation, detections_of(("stairs", everything)))
    view = semantic_map.view()
    assert len(view.obstacles) == 0
    assert view.navigable.points[:, 2].max() > 2.0
    assert view.grid.cells[tuple(view.grid.index_of((2.02, 0.0)))] == FREE


def test_what_becomes_known_as_stairs_is_cleared_from_the_obstacles() -> None:
    observation = observe(floor_depth(pitch_down=0.0, wall_distance=2.02))
    semantic_map = SemanticMap()
    semantic_map.integrate(observation, nothing_seen(observation))
    wall = tuple(semantic_map.view().grid.index_of((2.02, 0.0)))
    assert semantic_map.view().grid.cells[wall] == OCCUPIED
    everything = np.ones(observation.depth.shape, np.bool_)
    semantic_map.integrate(observation, detections_of(("stairs", everything)))
    view = semantic_map.view()
    assert view.grid.cells[tuple(view.grid.index_of((2.02, 0.0)))] == FREE
    assert len(view.obstacles) == 0


def test_interpolation_reaches_from_the_foot_to_the_floor_that_is_seen() -> None:
    """The camera sees the floor from about 1 m on; every cell on the way there is free."""
    observation = observe(floor_depth(pitch_down=0.0, wall_distance=3.0))
    semantic_map = SemanticMap()
    update = semantic_map.integrate(observation, nothing_seen(observation))
    nearest = update.navigable_points[:, 0].min()
    assert nearest > 0.8
    grid = semantic_map.view().grid
    along = np.column_stack([np.arange(0.0, 2.9, 0.05), np.zeros(58)])
    index = grid.index_of(along)
    assert (grid.cells[index[:, 0], index[:, 1]] == FREE).all()


def test_reset_forgets_everything() -> None:
    frame = random_frame(np.random.default_rng(4))
    fresh, used = SemanticMap(), SemanticMap()
    used.integrate(*random_frame(np.random.default_rng(7)))
    used.reset()
    fresh.integrate(*frame)
    used.integrate(*frame)
    np.testing.assert_array_equal(fresh.view().scene.points, used.view().scene.points)
    np.testing.assert_array_equal(fresh.view().grid.cells, used.view().grid.cells)


@pytest.mark.parametrize(
    "wrong", [{"r_g": 0.12}, {"r_g": 0.02}, {"delta": 1.1}, {"obstacle_top_m": 1.1}, {"r_pcd": 0.0}]
)
def test_impossible_configurations_are_refused(wrong: dict[str, float]) -> None:
    with pytest.raises(ValidationError):
        MapConfig(**wrong)
