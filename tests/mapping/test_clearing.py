"""What has gone leaves the map; what is hidden, unsure or still there does not."""

import hypothesis.strategies as st
import numpy as np
import pytest
from hypothesis import given
from map_frames import floor_depth, nothing_seen, observe, random_frame

from ball_frames import Ball, frame, said
from toponav.geometry import Pose
from toponav.geometry.conventions import BODY_FROM_OPTICAL
from toponav.mapping.clearing import Clearing, ClearingConfig, Voxels
from toponav.mapping.frame_sums import Frame
from toponav.mapping.semantic_map import MapConfig, SemanticMap
from toponav.mapping.serialization import map_arrays, map_of
from toponav.mapping.view import FREE, OCCUPIED, MapView
from toponav.types import Detections, Observation

FRAMES = 2
CLEARING = MapConfig(clearing=ClearingConfig(frames=FRAMES))
BALL = Ball(2.0, 0.0)


def shown(*balls: Ball, label: str = "chair") -> tuple[Observation, Detections]:
    """From the origin towards the balls; the first one is detected."""
    observation, masks = frame(balls, 0.0, 0.0, at=(1.0, 0.0))
    return observation, said((label, 0.9, masks[0])) if masks else nothing_seen(observation)


def chairs(view: MapView) -> int:
    return len(view.objects["chair"]) if "chair" in view.objects else 0


def voxels_there(view: MapView, ball: Ball) -> int:
    away = np.hypot(view.scene.points[:, 0] - ball.x, view.scene.points[:, 1] - ball.y)
    return int((away < ball.radius + 0.1).sum())


def test_a_thing_that_is_looked_through_goes_from_every_cloud() -> None:
    semantic_map = SemanticMap(CLEARING)
    semantic_map.integrate(*shown(BALL))
    before = semantic_map.view()
    held, there = chairs(before), voxels_there(before, BALL)
    gone = 0
    for _ in range(FRAMES):
        gone += len(semantic_map.integrate(*shown()).gone)
    view = semantic_map.view()
    assert held > 30
    assert chairs(view) == voxels_there(view, BALL) == 0
    assert gone == there


def test_its_cells_are_free_again() -> None:
    def in_front_of_a_wall(thing: bool) -> tuple[Observation, Detections]:
        depth = floor_depth()
        hit = np.zeros(depth.shape, bool)
        hit[:16, 15:25] = thing
        observation = observe(np.where(hit, 1.5, depth), pitch_down=0.5)
        return observation, nothing_seen(observation)

    semantic_map = SemanticMap(CLEARING)
    semantic_map.integrate(*in_front_of_a_wall(True))
    blocked = semantic_map.view().grid
    ahead = tuple(blocked.index_of((1.55, 0.0)))
    assert blocked.cells[ahead] == OCCUPIED
    for _ in range(FRAMES):
        semantic_map.integrate(*in_front_of_a_wall(False))
    grid = semantic_map.view().grid
    ahead = tuple(grid.index_of((1.55, 0.0)))
    assert grid.cells[ahead] == FREE


def test_without_the_switch_everything_stays() -> None:
    semantic_map = SemanticMap(MapConfig())
    semantic_map.integrate(*shown(BALL))
    held = chairs(semantic_map.view())
    for _ in range(3 * FRAMES):
        assert not len(semantic_map.integrate(*shown()).gone)
    assert chairs(semantic_map.view()) == held


def test_one_look_is_not_enough_nor_are_two_that_are_not_in_a_row() -> None:
    semantic_map = SemanticMap(CLEARING)
    semantic_map.integrate(*shown(BALL))
    held = chairs(semantic_map.view())
    for _ in range(3):
        semantic_map.integrate(*shown())
        assert chairs(semantic_map.view()) == held
        semantic_map.integrate(*shown(BALL))


def test_what_is_hidden_stays() -> None:
    semantic_map = SemanticMap(CLEARING)
    semantic_map.integrate(*shown(BALL))
    held = chairs(semantic_map.view())
    screen = Ball(1.0, 0.0, radius=0.6)
    for _ in range(3 * FRAMES):
        semantic_map.integrate(*shown(screen, label="screen"))
    assert chairs(semantic_map.view()) == held


@pytest.mark.parametrize("depth", [0.0, BALL.x - BALL.radius + 0.05])
def test_no_return_and_what_is_hardly_behind_say_nothing(depth: float) -> None:
    semantic_map = SemanticMap(CLEARING)
    observation, detections = shown(BALL)
    semantic_map.integrate(observation, detections)
    held = chairs(semantic_map.view())
    observation.depth[...] = depth
    for _ in range(3 * FRAMES):
        semantic_map.integrate(observation, nothing_seen(observation))
    assert chairs(semantic_map.view()) >= held


def test_a_place_that_was_cleared_takes_a_thing_again() -> None:
    semantic_map, fresh = SemanticMap(CLEARING), SemanticMap(CLEARING)
    semantic_map.integrate(*shown(BALL))
    for _ in range(FRAMES):
        semantic_map.integrate(*shown())
    assert chairs(semantic_map.view()) == 0
    for built in (semantic_map, fresh):
        built.integrate(*shown(BALL))
    again, first = (built.view().objects["chair"] for built in (semantic_map, fresh))
    np.testing.assert_allclose(
        again.points[np.lexsort(again.points.T)], first.points[np.lexsort(first.points.T)]
    )


def test_a_saved_map_has_no_gaps() -> None:
    semantic_map, stays = SemanticMap(CLEARING), Ball(3.0, 1.2)
    semantic_map.integrate(*shown(BALL, stays))
    for _ in range(FRAMES):
        semantic_map.integrate(*shown(stays, label="plant"))
    saved = map_of(map_arrays(semantic_map), CLEARING).view()
    live = semantic_map.view()
    np.testing.assert_array_equal(saved.scene.points, live.scene.points)
    assert saved.objects.keys() == live.objects.keys()
    assert len(saved.scene) > 0
    assert saved.scene.counts.min() > 0


@given(seed=st.integers(0, 2**32 - 1))
def test_nothing_that_a_frame_shows_goes_with_it(seed: int) -> None:
    observation, detections = random_frame(np.random.default_rng(seed))
    semantic_map = SemanticMap(CLEARING)
    semantic_map.integrate(observation, detections)
    held = len(semantic_map.view().scene)
    for _ in range(2 * FRAMES):
        assert not len(semantic_map.integrate(observation, detections).gone)
    assert len(semantic_map.view().scene) == held


@pytest.mark.parametrize("seed", range(12))
def test_all_voxels_in_an_image_of_nothing_near_go_whatever_the_view(seed: int) -> None:
    rng = np.random.default_rng(seed)
    pitch, focal, height, width = rng.uniform(-1.5, 1.5), 40.0, 48, 64
    tilt = Pose.from_rotation(
        np.array(
            [
                [np.cos(pitch), 0.0, np.sin(pitch)],
                [0.0, 1.0, 0.0],
                [-np.sin(pitch), 0.0, np.cos(pitch)],
            ]
        ),
        (0.0, 0.0, 1.0),
    )
    pose = Pose.from_yaw(rng.uniform(-3.0, 3.0), (0.3, -0.7, 0.0)) @ tilt @ BODY_FROM_OPTICAL
    frame = Frame(
        depth=np.full((height, width), 9.0, np.float32),
        rgb=np.zeros((height, width, 3), np.uint8),
        ray_x=(np.arange(width) - 31.5) / focal,
        ray_y=(np.arange(height) - 23.5) / focal,
        rotation=np.ascontiguousarray(pose.rotation),
        translation=pose.translation,
    )
    points = rng.uniform(-6.0, 6.0, (4000, 3)).astype(np.float32)
    voxels = Voxels(points, np.ones(len(points), np.int32), np.full(len(points), -1, np.int16))
    clearing = Clearing(ClearingConfig(frames=1))
    clearing.watch(points)
    gone = clearing.look(frame, voxels, 0.05, np.zeros(0, np.int32))

    x, y, z = pose.inverse().apply(points.astype(np.float64)).T
    u, v = focal * x / z + 31.5, focal * y / z + 23.5
    inside = (z > 0.5) & (np.hypot(*(points[:, :2] - pose.translation[:2]).T) < 4.0) & (z < 4.0)
    inside &= (u > 1.0) & (v > 1.0) & (u < width - 2.0) & (v < height - 2.0)
    assert inside.sum() > 20
    assert set(np.flatnonzero(inside)) <= set(gone.tolist())
    assert (z[gone] > 0.0).all()
    assert ((u[gone] > -0.5) & (u[gone] < width - 0.5)).all()
