"""The node and the simulated robot as two processes over real DDS on this machine."""

from __future__ import annotations

import os
import subprocess
import time
from pathlib import Path

import pytest

from toponav.cli.main import main
from toponav.robot.config import robot_config, robot_yaml
from toponav.robot.trial import (
    TrialConfig,
    TrialResult,
    moves_after,
    run_trial,
    search_node,
    sim_robot,
    stop_time,
    trial_result,
)

pytest.importorskip("rclpy", reason="needs the extra ros2")
pytest.importorskip("nav_msgs", reason="needs the extra ros2")

FASTEST_BUMP = 0.1
"""m/s"""

START = ("--start", "5.0,4.5,0,-1.2")
"""A room away from the target, to save time."""


@pytest.fixture
def brisk(tmp_path: Path) -> str:
    """A robot that turns and drives as fast as the simulated body can, to save time."""
    motion = {"max_speed": 0.8, "max_turn_rate": 2.0, "acceleration": 0.8, "turn_acceleration": 4.0}
    config = robot_config("generic", {"motion": {**motion, "settle_s": 0.15}})
    path = tmp_path / "brisk.yaml"
    path.write_text(robot_yaml(config))
    return str(path)


def trial_of(brisk: str, number: int, **options) -> TrialConfig:
    """A search in the small house, in a DDS domain that no other test uses."""
    domain = 1 + (os.getpid() * 7 + number) % 100
    return TrialConfig(
        "generated:6",
        "toilet",
        brisk,
        camera="160x120",
        camera_hz=10.0,
        domain=domain,
        faults=START,
        **options,
    )


def assert_found(result: TrialResult) -> None:
    assert result.found, (result.failure, result.node, result.sim)
    assert result.sim["bump_speed"] <= FASTEST_BUMP
    assert result.node["found"] is not None


def test_the_object_is_found_by_goals_over_dds_without_a_collision(brisk, tmp_path) -> None:
    trial = trial_of(brisk, 1, drive="goal_pose", timeout_s=240.0)
    assert_found(run_trial(trial, tmp_path))


def test_the_object_is_found_by_velocities_and_the_bag_of_it_gives_the_same_map(
    brisk, tmp_path
) -> None:
    bag, live, replayed = tmp_path / "bag", tmp_path / "live", tmp_path / "replayed"
    files = ("--record", str(bag), "--out", str(live))
    assert_found(run_trial(trial_of(brisk, 0, node=files, timeout_s=240.0), tmp_path))
    assert main(["map", str(bag), "--robot", brisk, "--out", str(replayed)]) == 0
    for name in ("scene.ply", "navigable.ply", "obstacles.ply"):
        points = (live / name).read_bytes()
        assert len(points) > 1000
        assert (replayed / name).read_bytes() == points, name
    # What few views speak for is left out of a recording's objects, and nothing is added.
    objects = {path.name for path in (replayed / "objects").iterdir()}
    assert objects
    assert objects <= {path.name for path in (live / "objects").iterdir()}


def test_cancelling_by_the_service_stops_a_moving_robot(brisk, tmp_path) -> None:
    from toponav.robot.witness import Witness

    trial = trial_of(brisk, 2, timeout_s=240.0)
    with Witness(trial.domain) as witness, sim_robot(trial, tmp_path) as robot:
        node = search_node(trial, tmp_path)
        witness.wait_for_speed(0.2, 120.0)
        called_s = witness.call("Trigger", "toponav/cancel")
        node.wait(60.0)
        time.sleep(0.5)
    result = trial_result(robot, node, tmp_path)
    assert "cancelled" in result.failure
    # How soon is what `toponav bench faults` measures; here it stands, and for good.
    stop_s = stop_time(result.trace, called_s)
    assert moves_after(result.trace, called_s + stop_s) < 0.01


def test_without_a_robot_the_node_says_what_it_waits_for(tmp_path, brisk) -> None:
    trial = trial_of(brisk, 3, timeout_s=4.0)
    node = search_node(trial, tmp_path)
    node.wait(60.0)
    assert node.process.returncode == 1
    assert "no camera info on camera/color/camera_info" in node.last_words()


def test_without_ros_the_commands_name_the_extra(tmp_path) -> None:
    code = (
        "import sys; sys.modules['rclpy'] = None\n"
        "from toponav.cli.main import main; sys.exit(main(['ros2', '--target', 'chair']))"
    )
    ended = subprocess.run(
        [os.sys.executable, "-c", code], capture_output=True, text=True, cwd=tmp_path, check=False
    )
    assert ended.returncode == 2
    assert "toponav[ros2]" in ended.stderr
    assert len(ended.stderr.strip().splitlines()) == 1
