"""The node and the simulated robot as two processes over real DDS on this machine."""

from __future__ import annotations

import subprocess
import sys
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from functools import cache, partial
from pathlib import Path

import pytest
from dds_domain import domain_of

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

FASTEST_BUMP = 0.2
"""m/s. `toponav bench robot` holds a calmer robot on a calmer machine to 0.1."""

HOUSES = {
    "generated:0": ("chair", ()),
    "generated:1": ("bed", ()),
    # A room away from the target, to save time.
    "generated:6": ("toilet", ("--start", "5.0,4.5,0,-1.2")),
}
"""What is searched for where, and further options of the simulated robot."""

SMALL = "generated:6"
DRIVES = ("cmd_vel", "goal_pose")
TIMEOUT_S = 240.0


@pytest.fixture(scope="module")
def brisk(tmp_path_factory) -> str:
    """A robot that is fast, to save time, with a guard that allows for a busy machine."""
    motion = {"max_speed": 0.6, "max_turn_rate": 2.0, "acceleration": 0.8, "turn_acceleration": 4.0}
    changes = {"motion": {**motion, "settle_s": 0.15}, "guard": {"reaction_s": 0.5}}
    path = tmp_path_factory.mktemp("brisk") / "brisk.yaml"
    path.write_text(robot_yaml(robot_config("generic", changes)))
    return str(path)


def trial_of(brisk: str, number: int, house: str = SMALL, **options) -> TrialConfig:
    """A search with small images, in a DDS domain that no other test uses."""
    target, start = HOUSES[house]
    return TrialConfig(
        house,
        target,
        brisk,
        camera="160x120",
        camera_hz=10.0,
        domain=domain_of(number),
        faults=start,
        timeout_s=TIMEOUT_S,
        **options,
    )


@dataclass(frozen=True)
class Searched:
    """A search that is over, and its files."""

    result: TrialResult
    folder: Path
    seconds: float


@pytest.fixture(scope="module")
def searched(brisk, tmp_path_factory) -> Callable[[str], dict[str, Searched]]:
    """Searches a house in both ways at once, in domains of their own, when first asked."""

    def search(house: str, drive: str) -> Searched:
        folder = tmp_path_factory.mktemp(drive)
        files = ("--record", str(folder / "bag"), "--out", str(folder / "live"))
        number = 2 * list(HOUSES).index(house) + DRIVES.index(drive)
        trial = trial_of(brisk, number, house, drive=drive, node=files)
        begun_s = time.monotonic()
        result = run_trial(trial, folder)
        return Searched(result, folder, time.monotonic() - begun_s)

    @cache
    def both(house: str) -> dict[str, Searched]:
        with ThreadPoolExecutor(len(DRIVES)) as pool:
            return dict(zip(DRIVES, pool.map(partial(search, house), DRIVES), strict=True))

    return both


@pytest.mark.parametrize("drive", DRIVES)
@pytest.mark.parametrize("house", HOUSES)
def test_the_object_is_found_over_dds_without_a_collision(
    searched, house, drive, record_property
) -> None:
    search = searched(house)[drive]
    result = search.result
    assert result.found, (result.failure, result.node, result.sim)
    assert result.node["found"] is not None
    assert result.sim["bump_speed"] <= FASTEST_BUMP
    record_property(
        "figures",
        f"{drive} {house} {HOUSES[house][0]}: found in {result.node['seconds']:.0f} s "
        f"({search.seconds:.0f} s in all), {result.sim['distance_to_goal']:.2f} m from it, "
        f"{result.sim['travelled']:.1f} m driven, fastest bump {result.sim['bump_speed']:.2f} m/s",
    )


def test_the_bag_of_a_search_gives_the_same_map(searched, brisk, tmp_path) -> None:
    folder = searched(SMALL)["cmd_vel"].folder
    live, replayed = folder / "live", tmp_path / "replayed"
    assert main(["map", str(folder / "bag"), "--robot", brisk, "--out", str(replayed)]) == 0
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

    trial = trial_of(brisk, 6)
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
    trial = replace(trial_of(brisk, 7), timeout_s=4.0)
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
        [sys.executable, "-c", code], capture_output=True, text=True, cwd=tmp_path, check=False
    )
    assert ended.returncode == 2
    assert "toponav[ros2]" in ended.stderr
    assert len(ended.stderr.strip().splitlines()) == 1
