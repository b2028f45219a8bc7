"""The environment: gymnasium's contract, the protocol's motion, clear errors."""

from __future__ import annotations

import math
import warnings

import gymnasium
import numpy as np
import pytest
from box_scenes import room
from gymnasium.utils.env_checker import check_env

from toponav.envs import ENV_ID
from toponav.envs.base import observation_from_dict
from toponav.envs.simulator import HouseEnv, HouseEnvConfig
from toponav.errors import EpisodeError, InputError
from toponav.geometry import back_project
from toponav.scenes.mesh import Scene, SceneEpisode
from toponav.types import Action

TABLE = ("table", ((4.0, 1.5, 0.0), (5.0, 2.5, 0.75)))
CONFIG = HouseEnvConfig(width=32, height=24)


@pytest.fixture(scope="module")
def scene() -> Scene:
    episodes = (SceneEpisode("table", (1.0, 2.0, 0.0), 0.0),)
    return Scene("box", room(extra=[TABLE]), floors=(0.0,), episodes=episodes)


@pytest.fixture
def env(scene: Scene) -> HouseEnv:
    env = HouseEnv(scene, CONFIG)
    env.reset(seed=0)
    return env


def test_gymnasium_accepts_the_registered_environment(scene: Scene) -> None:
    env = gymnasium.make(ENV_ID, scene=scene, config=CONFIG)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warnings.filterwarnings("ignore", message=".*(infinity|Inf|spec|render|Box).*")
        check_env(env.unwrapped, skip_render_check=True)


def test_the_dict_and_the_typed_observation_are_the_same(env: HouseEnv) -> None:
    raw, reward, terminated, truncated, info = env.step(Action.TURN_LEFT)
    typed, again = env.observe(), observation_from_dict(raw, env.intrinsics)
    assert env.observation_space.contains(raw)
    np.testing.assert_array_equal(typed.depth, again.depth)
    np.testing.assert_array_equal(typed.world_from_camera.matrix, again.world_from_camera.matrix)
    assert (typed.step, typed.collided) == (again.step, again.collided) == (1, False)
    assert (reward, terminated, truncated, info) == (0.0, False, False, {})


def test_steps_and_turns_are_the_protocols(env: HouseEnv) -> None:
    start = env.position
    env.step(Action.MOVE_FORWARD)
    np.testing.assert_allclose(env.position - start, [0.25, 0.0, 0.0], atol=1e-9)
    env.step(Action.TURN_RIGHT)
    assert env.yaw == pytest.approx(-math.radians(30.0))
    for _ in range(12):
        env.step(Action.TURN_LEFT)
    assert env.yaw == pytest.approx(-math.radians(30.0))


def test_a_blocked_step_ends_at_the_obstacle_and_does_not_slide(env: HouseEnv) -> None:
    env.step(Action.TURN_LEFT)  # 30 degrees: into the far wall at an angle
    track = []
    for _ in range(40):
        before = env.position
        env.step(Action.MOVE_FORWARD)
        track.append(env.position - before)
        if env.collided:
            break
    assert env.collided
    heading = np.array([math.cos(math.radians(30)), math.sin(math.radians(30)), 0.0])
    for move in track:
        np.testing.assert_allclose(np.cross(move, heading), 0.0, atol=1e-9)
    assert np.linalg.norm(track[-1]) < 0.25
    gap = 4.0 - env.position[1]
    assert 0.18 - 0.025 <= gap <= 0.18 + 0.075  # the radius, to the surface's cells of 0.05 m


def test_tilting_is_limited_and_moves_the_optical_axis(env: HouseEnv) -> None:
    for _ in range(5):
        env.step(Action.LOOK_UP)
    forward = env.observe().world_from_camera.rotation[:, 2]
    assert forward[2] == pytest.approx(math.sin(math.radians(60.0)))
    env.step(Action.LOOK_DOWN)
    forward = env.observe().world_from_camera.rotation[:, 2]
    assert forward[2] == pytest.approx(math.sin(math.radians(30.0)))


def test_back_projected_points_lie_on_the_scene(env: HouseEnv, scene: Scene) -> None:
    corners = scene.mesh.vertices.reshape(-1, 8, 3)  # of its boxes
    low, high = corners.min(axis=1), corners.max(axis=1)
    for action in (Action.TURN_LEFT, Action.LOOK_DOWN, Action.MOVE_FORWARD):
        env.step(action)
        seen = env.observe()
        points = seen.world_from_camera.apply(back_project(seen.depth, seen.intrinsics))
        points = points[seen.depth > 0.0]
        assert len(points) > 50
        beyond = np.maximum(low - points[:, None], points[:, None] - high)  # of each box
        outside = np.linalg.norm(np.maximum(beyond, 0.0), axis=-1)
        to_surface = np.where(outside > 0.0, outside, np.abs(beyond.max(axis=-1)))
        assert to_surface.min(axis=1).max() < 2e-3
    height = env.observe().world_from_camera.translation[2] - env.position[2]
    assert height == pytest.approx(0.88)


def test_depth_outside_the_range_is_no_return(env: HouseEnv) -> None:
    env.reset(options={"target": "table", "start": (0.4, 0.4, 0.0, 0.0)})
    depth = env.observe().depth
    assert depth[depth > 0.0].min() >= 0.5
    assert depth.max() <= 5.0
    assert depth[12, 16] == 0.0  # the far wall, at 5.6 m


def test_stop_terminates_and_the_limit_truncates(scene: Scene) -> None:
    env = HouseEnv(scene, CONFIG.model_copy(update={"max_steps": 2}))
    env.reset(seed=0)
    assert env.step(Action.TURN_LEFT)[2:4] == (False, False)
    assert env.step(Action.TURN_LEFT)[2:4] == (False, True)
    env.reset(seed=0)
    assert env.step(Action.STOP)[1:4] == (0.0, True, False)


def test_stopping_at_a_viewpoint_is_rewarded(env: HouseEnv) -> None:
    viewpoint = env.oracle.viewpoints("table")[0]
    env.reset(options={"target": "table", "start": (*viewpoint, 0.0)})
    assert env.oracle.distance_to_goal() < 0.1
    assert env.step(Action.STOP)[1] == 1.0


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"target": "piano"}, "no reachable piano; it has table"),
        ({"start": (4.5, 2.0, 0.0, 0.0)}, "nobody can stand at .*nearest free place"),
        ({"start": (math.nan, 2.0, 0.0, 0.0)}, "NaN"),
        ({"target": "wall"}, "no reachable wall"),
    ],
)
def test_impossible_episodes_say_why(env: HouseEnv, options: dict, message: str) -> None:
    with pytest.raises(EpisodeError, match=message):
        env.reset(seed=0, options=options)


def test_drawn_episodes_depend_on_the_seed_alone(scene: Scene) -> None:
    bare = Scene("bare", scene.mesh, floors=(0.0,))
    positions = []
    for seed in (1, 1, 2):
        env = HouseEnv(bare, CONFIG)
        env.reset(seed=seed)
        positions.append((env.target, *env.position, env.yaw))
    assert positions[0] == positions[1] != positions[2]


def test_viewpoints_are_near_navigable_and_in_sight(env: HouseEnv) -> None:
    points = env.oracle.viewpoints("table")
    low, high = np.array(TABLE[1][0][:2]), np.array(TABLE[1][1][:2])
    outside = np.maximum(np.maximum(low - points[:, :2], points[:, :2] - high), 0.0)
    distance = np.hypot(*outside.T)
    assert len(points) > 200
    assert distance.max() <= 1.0 + 0.05  # the surface is sampled
    assert distance.min() >= 0.15  # the radius, less half a cell of the surface
    assert all(env.surface.is_navigable(point) for point in points)


def test_steps_before_a_reset_and_unknown_actions_are_refused(scene: Scene, env: HouseEnv) -> None:
    with pytest.raises(EpisodeError, match="reset the environment"):
        HouseEnv(scene, CONFIG).step(Action.STOP)
    for action in (6, -1, 1.0, "stop"):
        with pytest.raises(InputError, match="integers 0 to 5"):
            env.step(action)
