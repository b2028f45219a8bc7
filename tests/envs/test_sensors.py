"""Sensor noise against the published figures and a random walk's statistics."""

from __future__ import annotations

import math

import numpy as np
import pytest
from box_scenes import room
from hypothesis import given
from hypothesis import strategies as st

from toponav.envs.simulator import HouseEnv, HouseEnvConfig
from toponav.envs.simulator.sensors import NoiseConfig, SensorNoise, clip_range
from toponav.geometry import Pose
from toponav.scenes.mesh import Scene, SceneEpisode
from toponav.types import Action

WALKS = 250
TABLE = ("table", ((4.0, 1.5, 0.0), (5.0, 2.5, 0.75)))


def noise(seed: int = 0, **config: float) -> SensorNoise:
    return SensorNoise(NoiseConfig(**config), np.random.default_rng(seed))


@given(st.floats(0.0, 12.0, width=32))
def test_depth_is_kept_inside_the_range_and_lost_outside(depth: float) -> None:
    measured = clip_range(np.array([[depth]], np.float32), 0.5, 5.0)
    assert measured.dtype == np.float32
    assert measured[0, 0] == (depth if 0.5 <= depth <= 5.0 else 0.0)


# Nguyen et al. 2012: 0.0012 + 0.0019 (z - 0.4)^2, worked out by hand.
@pytest.mark.parametrize(("z", "sigma"), [(0.4, 0.0012), (1.4, 0.0031), (2.4, 0.0088)])
def test_axial_noise_has_the_published_deviation(z: float, sigma: float) -> None:
    wall = np.full((300, 300), z, np.float32)
    measured = noise(depth=True).measured(wall)
    assert measured.dtype == np.float32
    assert measured.mean() == pytest.approx(z, abs=4 * sigma / 300)
    assert measured.std() == pytest.approx(sigma, rel=0.02)


def test_lateral_noise_moves_edges_by_less_than_a_few_pixels() -> None:
    step = np.full((400, 60), 1.0, np.float32)
    step[:, 30:] = 3.0
    measured = noise(depth=True).measured(step)
    crossed = (measured > 2.0) != (step > 2.0)
    share = crossed.mean(axis=0)
    # A shift of sigma = 0.8 pixels, rounded: pixel 30 reads pixel 29 when it exceeds 0.5.
    expected = 0.5 * math.erfc(0.5 / 0.8 / math.sqrt(2.0))
    assert share[29] == pytest.approx(expected, abs=0.07)
    assert share[30] == pytest.approx(expected, abs=0.07)
    assert not share[:25].any()
    assert not share[35:].any()


def test_no_return_stays_no_return() -> None:
    assert not noise(depth=True).measured(np.zeros((20, 20), np.float32)).any()


def drifted_ends(steps: int, **config: float) -> np.ndarray:
    """(WALKS, 3) final x, y and yaw errors of straight walks in steps of 0.25 m."""
    ends = []
    for seed in range(WALKS):
        sensor = noise(seed, **config)
        for k in range(steps):
            sensor.moved(
                Pose.from_yaw(0.0, (0.25 * k, 0.0, 0.0)),
                Pose.from_yaw(0.0, (0.25 * (k + 1), 0.0, 0.0)),
            )
        true = Pose.from_yaw(0.0, (0.25 * steps, 0.0, 0.0))
        reported = sensor.reported(true)
        ends.append([*(reported.translation - true.translation)[:2], reported.yaw])
    return np.array(ends)


@pytest.mark.parametrize("metres", [1, 4])
def test_position_drifts_like_a_random_walk(metres: int) -> None:
    errors = drifted_ends(4 * metres, drift_per_m=0.05)
    sigma = 0.05 * math.sqrt(metres)
    np.testing.assert_allclose(errors[:, :2].std(axis=0), sigma, rtol=0.15)
    assert np.abs(errors[:, :2].mean(axis=0)).max() < 4 * sigma / math.sqrt(WALKS)
    assert not errors[:, 2].any()


def test_an_error_in_yaw_bends_the_rest_of_the_way() -> None:
    errors = drifted_ends(20, drift_yaw_per_m=0.02)
    assert errors[:, 2].std() == pytest.approx(0.02 * math.sqrt(5.0), rel=0.15)
    # The integral of a random walk over length L has deviation sigma L^(3/2) / sqrt(3).
    assert errors[:, 1].std() == pytest.approx(0.02 * 5.0**1.5 / math.sqrt(3.0), rel=0.15)


def test_yaw_drifts_when_turning_on_the_spot() -> None:
    yaws = []
    for seed in range(WALKS):
        sensor = noise(seed, drift_yaw_per_rad=0.03)
        here = Pose.from_yaw(3.0, (2.0, 1.0, 0.5))
        turned = Pose.from_yaw(3.0 + math.pi / 6, (2.0, 1.0, 0.5))
        sensor.moved(here, turned)
        reported = sensor.reported(turned)
        np.testing.assert_allclose(reported.translation, (2.0, 1.0, 0.5), atol=1e-12)
        yaws.append((turned.inverse() @ reported).yaw)
    assert np.std(yaws) == pytest.approx(0.03 * math.sqrt(math.pi / 6), rel=0.15)


def test_standing_still_or_tilting_does_not_drift() -> None:
    sensor = noise(drift_per_m=0.5, drift_yaw_per_m=0.5, drift_yaw_per_rad=0.5)
    here = Pose.from_yaw(0.3, (1.0, 2.0, 0.0))
    sensor.moved(here, here)
    np.testing.assert_allclose(sensor.reported(here).matrix, here.matrix, atol=1e-12)


def test_height_and_verticality_are_reported_exactly() -> None:
    sensor = noise(drift_per_m=0.5, drift_yaw_per_m=0.5)
    before, after = Pose.from_yaw(0.0, (0, 0, 0.0)), Pose.from_yaw(1.0, (1, 0, 0.2))
    sensor.moved(before, after)
    reported = sensor.reported(after)
    assert reported.translation[2] == pytest.approx(0.2)
    np.testing.assert_allclose(reported.rotation[:, 2], (0, 0, 1), atol=1e-12)
    assert np.linalg.norm(reported.translation - after.translation) > 0.01


def test_actuation_scatters_about_the_command_and_never_runs_backwards() -> None:
    motor = noise(actuation=0.1)
    amounts = np.array([motor.actuated(0.25) for _ in range(4000)])
    assert amounts.mean() == pytest.approx(0.25, rel=0.01)
    assert amounts.std() == pytest.approx(0.025, rel=0.05)
    wild = noise(actuation=5.0)
    assert min(wild.actuated(0.25) for _ in range(100)) == 0.0


def test_noise_that_is_off_draws_nothing_and_changes_nothing() -> None:
    rng = np.random.default_rng(3)
    sensor = SensorNoise(NoiseConfig(), rng)
    depth = np.linspace(0.0, 6.0, 100, dtype=np.float32).reshape(10, 10)
    assert sensor.measured(depth) is depth
    assert sensor.actuated(0.25) == 0.25
    pose = Pose.from_yaw(1.0, (1.0, 2.0, 3.0))
    sensor.moved(Pose.identity(), pose)
    np.testing.assert_array_equal(sensor.reported(pose).matrix, pose.matrix)
    assert rng.random() == np.random.default_rng(3).random()


NOISY = NoiseConfig(
    depth=True, drift_per_m=0.05, drift_yaw_per_m=0.02, drift_yaw_per_rad=0.02, actuation=0.05
)


def walk(config: NoiseConfig, seed: int) -> HouseEnv:
    episodes = (SceneEpisode("table", (1.0, 2.0, 0.0), 0.0),)
    scene = Scene("box", room(extra=[TABLE]), floors=(0.0,), episodes=episodes)
    env = HouseEnv(scene, HouseEnvConfig(width=32, height=24, noise=config))
    env.reset(seed=seed)
    for action in (Action.MOVE_FORWARD, Action.TURN_LEFT, Action.MOVE_FORWARD, Action.LOOK_DOWN):
        env.step(action)
    return env


def test_a_noisy_walk_is_fixed_by_its_seed() -> None:
    first, same, other = walk(NOISY, 1), walk(NOISY, 1), walk(NOISY, 2)
    seen, again, different = first.observe(), same.observe(), other.observe()
    np.testing.assert_array_equal(seen.depth, again.depth)
    np.testing.assert_array_equal(seen.world_from_camera.matrix, again.world_from_camera.matrix)
    assert not np.array_equal(seen.depth, different.depth)
    assert not np.allclose(first.position, other.position)


def test_the_agent_sees_the_reported_pose_and_the_simulator_keeps_the_true_one() -> None:
    env = walk(NOISY, 1)
    seen = env.observe()
    error = np.linalg.norm(seen.world_from_base.translation - env.position)
    assert 1e-3 < error < 0.5
    eye = seen.world_from_base.inverse() @ seen.world_from_camera
    np.testing.assert_allclose(eye.translation, (0.0, 0.0, 0.88), atol=1e-9)
    ideal = walk(NoiseConfig(), 1)
    np.testing.assert_allclose(ideal.observe().world_from_base.translation, ideal.position)
