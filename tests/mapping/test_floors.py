"""Several floors: when one begins, what belongs to it, and that the others stay as they were."""

import numpy as np
import pytest
from map_frames import detections_of, floor_depth, nothing_seen, observe
from map_reference import voxels_of

from toponav.errors import StaleViewError
from toponav.mapping.semantic_map import SemanticMap
from toponav.mapping.view import FREE, MapView
from toponav.types import Observation

STOREY = 3.0


def standing(z: float, x: float = 0.0, yaw: float = 0.0) -> Observation:
    return observe(floor_depth(0.4, wall_distance=4.0), foot=(x, 0.0, z), yaw=yaw, pitch_down=0.4)


def blind(z: float, x: float = 0.0) -> Observation:
    """On stairs, with nothing but air in front."""
    return observe(np.zeros((30, 40)), foot=(x, 0.0, z))


def climbed(*observations: Observation) -> SemanticMap:
    semantic_map = SemanticMap()
    for observation in observations:
        semantic_map.integrate(observation, nothing_seen(observation))
    return semantic_map


def test_the_first_foot_point_is_the_first_floor() -> None:
    view = climbed(standing(1.7)).view()
    assert (view.floor, view.floor_z) == (0, 1.7)
    assert (np.abs(view.navigable.points[:, 2] - 1.7) <= 0.15 + 1e-6).all()


def test_on_stairs_the_floor_below_stays_until_level_ground_is_seen() -> None:
    semantic_map = climbed(standing(0.0))
    for z in np.arange(0.2, STOREY, 0.2):
        observation = blind(float(z), x=float(z))
        semantic_map.integrate(observation, nothing_seen(observation))
        assert semantic_map.view().floor == 0
        assert semantic_map.view().floor_z == 0.0
    observation = standing(STOREY, x=3.0)
    semantic_map.integrate(observation, nothing_seen(observation))
    assert (semantic_map.view().floor, semantic_map.view().floor_z) == (1, STOREY)


def test_walls_at_foot_height_are_no_ground() -> None:
    """Half-way up a flight the house's walls pass the foot's height, without a floor there."""
    foot_z, wall = 1.6, np.mgrid[0:200, 0:40].reshape(2, -1).T * 0.05
    semantic_map = climbed(standing(0.0))
    upright = np.column_stack([wall[:, 0], np.zeros(len(wall)), foot_z - 1.0 + wall[:, 1]])
    semantic_map._scene.add(upright)
    foot = np.array([3.0, 0.0, foot_z])
    assert semantic_map._ground_height(foot, semantic_map._scene.refresh()) is None
    level = np.column_stack([wall[:, 0], 2.0 + wall[:, 1], np.full(len(wall), foot_z)])
    semantic_map._scene.add(level)
    assert semantic_map._ground_height(foot, semantic_map._scene.refresh()) == foot_z


def test_a_known_floor_is_entered_again_with_its_index_and_its_map() -> None:
    semantic_map = climbed(standing(0.0))
    ground = semantic_map.view()
    floor, obstacles = set(voxels_of(ground.navigable.points, 0.05)), len(ground.obstacles)
    for observation in (standing(STOREY, x=8.0), blind(1.6), blind(1.4), blind(0.02)):
        semantic_map.integrate(observation, nothing_seen(observation))
    back = semantic_map.view()
    assert (back.floor, back.floor_z) == (0, 0.0)
    assert floor <= set(voxels_of(back.navigable.points, 0.05))
    assert len(back.obstacles) == obstacles
    assert len(back.scene) > len(ground.scene)


def test_each_floor_has_its_own_layers_and_the_scene_is_shared() -> None:
    semantic_map = climbed(standing(0.0), standing(STOREY, yaw=np.pi / 2))
    upper = semantic_map.view()
    alone = climbed(standing(STOREY, yaw=np.pi / 2)).view()
    assert upper.floor == 1
    assert set(voxels_of(upper.navigable.points, 0.05)) == set(
        voxels_of(alone.navigable.points, 0.05)
    )
    assert len(upper.obstacles) == len(alone.obstacles)
    np.testing.assert_array_equal(upper.grid.cells, alone.grid.cells)
    np.testing.assert_allclose(upper.frontiers, alone.frontiers)
    lower = climbed(standing(0.0)).view()
    assert len(upper.scene) == len(lower.scene) + len(alone.scene)


def test_a_floor_seen_from_above_is_sorted_when_it_is_entered() -> None:
    """Looking down through an opening first, the ground floor's map holds what was seen."""
    upstairs = standing(STOREY)
    semantic_map = climbed(upstairs)
    rays = upstairs.intrinsics.rays() @ upstairs.world_from_camera.rotation.T
    depth = np.where(rays[..., 2] < -0.7, -(STOREY + 0.88) / rays[..., 2], 0.0)
    looking_down = observe(depth, foot=(0.0, 0.0, STOREY), pitch_down=0.4)
    semantic_map.integrate(looking_down, nothing_seen(looking_down))
    assert semantic_map.view().navigable.points[:, 2].min() > STOREY - 0.2
    arrived = standing(0.0, yaw=np.pi)
    semantic_map.integrate(arrived, nothing_seen(arrived))
    view = semantic_map.view()
    assert view.floor == 1
    seen_from_above = view.scene.points[np.abs(view.scene.points[:, 2]) < 0.15]
    ahead = seen_from_above[seen_from_above[:, 0] > 0.5]
    assert len(ahead) > 10
    index = view.grid.index_of(ahead[:, :2])
    assert (view.grid.cells[index[:, 0], index[:, 1]] == FREE).all()


def check_heights(view: MapView, treads: np.ndarray) -> None:
    """The grid knows the highest tread over each cell, and that elsewhere there is none."""
    assert view.grid.stairs is not None
    expected = np.full(view.grid.cells.shape, np.nan)
    for point in treads:
        i, j = view.grid.index_of(point)
        expected[i, j] = np.fmax(expected[i, j], point[2] - view.floor_z)
    np.testing.assert_allclose(view.grid.stairs, expected, atol=1e-6)


def test_stairs_belong_to_the_floors_that_they_join() -> None:
    """A ramp of "stairs" from 0 to 3 m is navigable on both floors, whole."""
    camera = observe(np.zeros((30, 40)))
    rays = camera.intrinsics.rays() @ camera.world_from_camera.rotation.T
    # The plane z = x - 1 rises from (1, 0) to (4, 3): 0.88 + d r_z = d r_x - 1.
    climb = rays[..., 0] - rays[..., 2]
    depth = np.where(climb > 0.0, 1.88 / climb, 0.0)
    heights = 0.88 + depth * rays[..., 2]
    depth[(heights < 0.2) | (heights > 2.8)] = 0.0
    ramp = observe(depth)
    semantic_map = climbed(standing(0.0, yaw=np.pi))
    semantic_map.integrate(ramp, detections_of(("stairs", depth > 0.0)))
    points = semantic_map.view().objects["stairs"].points
    stairs = set(voxels_of(points, 0.05))
    assert len(stairs) > 50
    check_heights(semantic_map.view(), points)
    assert stairs <= set(voxels_of(semantic_map.view().navigable.points, 0.05))
    upstairs = standing(STOREY, x=5.0)
    semantic_map.integrate(upstairs, nothing_seen(upstairs))
    view = semantic_map.view()
    assert view.floor == 1
    assert stairs <= set(voxels_of(view.navigable.points, 0.05))
    assert not stairs & set(voxels_of(view.obstacles.points, 0.05))
    check_heights(view, points)
    third = standing(2 * STOREY, x=5.0)
    semantic_map.integrate(third, nothing_seen(third))
    assert semantic_map.view().floor == 2
    assert not stairs & set(voxels_of(semantic_map.view().navigable.points, 0.05))


def test_a_cloud_first_looked_at_too_late_says_so() -> None:
    semantic_map = climbed(standing(0.0))
    late, early = semantic_map.view(), len(semantic_map.view().obstacles)
    assert len(late.obstacles) == early
    observation = standing(0.0, yaw=np.pi / 2)
    semantic_map.integrate(observation, nothing_seen(observation))
    assert len(late.obstacles) == early
    with pytest.raises(StaleViewError, match="before its next frame"):
        len(late.navigable)
