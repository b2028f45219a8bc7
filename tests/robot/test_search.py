"""Whole searches of the simulated robot in lockstep: found, stopped when it must, and got over."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from lockstep import TICK_S, Lockstep

from toponav.robot.config import robot_config
from toponav.robot.search import Status
from toponav.robot.sim_faults import FaultConfig

FASTEST_BUMP = 0.1
"""m/s"""

CORRIDOR = str(Path(__file__).resolve().parents[2] / "examples" / "scenes" / "corridor.json")


def searching(**options) -> Lockstep:
    robot = Lockstep(**options)
    robot.search.start(robot.target)
    return robot


def assert_found(robot: Lockstep) -> None:
    assert robot.search.status is Status.DONE, robot.search.reason
    assert robot.env.oracle.distance_to_goal() < 0.25
    assert robot.base.bump_speed <= FASTEST_BUMP


@pytest.mark.parametrize(
    "faults",
    [{}, {"drop": 0.2}, {"latency_s": 0.3}, {"jump_at_s": 20.0}, {"silent_at_s": 20.0}],
    ids=lambda faults: next(iter(faults), "none"),
)
def test_the_object_is_found_whatever_happens_to_the_sensors(faults) -> None:
    robot = searching(faults=FaultConfig(**faults))
    robot.run(240.0)
    assert_found(robot)
    assert robot.senses.jumps == ("jump_at_s" in faults)


def test_a_silent_camera_stops_the_robot_until_it_is_back() -> None:
    robot = searching()
    robot.run_until_speed(0.35)
    robot._look = lambda: None
    spent = 0.0
    while robot.base.twist.speed > 0.0:
        robot.tick()
        spent += TICK_S
    limit = robot.watchdog._config.max_depth_silence_s
    assert spent <= limit + 0.6
    assert robot.pilot.objection == "no fresh depth"
    there = robot.env.position
    for _ in range(60):
        robot.tick()
    assert np.array_equal(there, robot.env.position)
    del robot._look
    robot.run(240.0)
    assert_found(robot)


def test_a_cancelled_robot_stands_and_a_new_goal_is_searched_for_with_the_map_kept() -> None:
    robot = searching()
    robot.run_until_speed(0.35)
    known = len(robot.agent.knowledge.semantic_map.view().scene)
    robot.search.cancel()
    assert robot.search.status is Status.CANCELLED
    for _ in range(10):
        robot.tick()
    assert robot.base.twist.speed == 0.0
    there = robot.env.position
    for _ in range(20):
        robot.tick()
    assert np.array_equal(there, robot.env.position)
    robot.search.start(robot.target)
    robot.tick()
    assert len(robot.agent.knowledge.semantic_map.view().scene) >= known
    robot.run(240.0)
    assert_found(robot)


def test_a_goal_that_changes_on_the_way_is_searched_for_instead() -> None:
    robot = searching()
    robot.run_until_speed(0.35)
    known = len(robot.agent.knowledge.semantic_map.view().scene)
    other = next(name for name in ("bed", "sofa", "chair") if name in robot.env.oracle.categories())
    assert other != robot.target
    robot.search.start(other)
    assert robot.search.goal == other
    robot.tick()
    assert len(robot.agent.knowledge.semantic_map.view().scene) >= known
    robot.run(240.0)
    assert robot.search.status is Status.DONE, robot.search.reason
    viewpoints = robot.env.surface.distance_field(robot.env.oracle.viewpoints(other))
    assert viewpoints.at(robot.env.position) < 0.25


def test_an_error_of_the_agent_stops_the_robot_and_says_so(monkeypatch) -> None:
    robot = searching()
    robot.run_until_speed(0.35)

    def fail(observation):
        raise ZeroDivisionError("no plan")

    monkeypatch.setattr(robot.agent, "act", fail)
    robot.run(10.0)
    assert robot.search.status is Status.FAILED
    assert "no plan" in robot.search.reason
    for _ in range(20):
        robot.tick()
    assert robot.base.twist.speed == 0.0


def test_the_robot_never_enters_a_keep_out_area() -> None:
    free = searching()
    free.run(240.0)
    way = np.array([(point.x, point.y) for point in free.base.trace])
    middle = way[len(way) * 2 // 3]
    half = 0.4
    corners = [tuple(middle + half * np.array(c)) for c in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    config = robot_config("generic", {"watchdog": {"keep_out": [corners]}})
    robot = searching(robot=config)
    if np.abs(robot.env.position[:2] - middle).max() < half:
        pytest.skip("the area would hold the start")
    robot.run(120.0)
    inside = [
        max(abs(point.x - middle[0]), abs(point.y - middle[1])) < half for point in robot.base.trace
    ]
    assert not any(inside)


def test_a_room_that_was_passed_is_gone_back_to() -> None:
    robot = Lockstep(house=CORRIDOR, target="plant", start=(1.2, 0.9, 0.0, 0.0))
    robot.search.start("plant")
    robot.run(200.0)
    assert robot.search.status is Status.DONE, robot.search.reason
    assert robot.env.position[0] > 14.0
    office_door = np.array([8.6, 1.4])
    passed = [
        node.id
        for node in robot.agent.knowledge.memory.nodes
        if math.dist(node.position, office_door) < 1.5
    ]
    assert passed
    robot.search.start("chair")
    robot.run(240.0)
    assert robot.search.status is Status.DONE, robot.search.reason
    x, y = robot.env.position[:2]
    assert 5.0 < x < 9.5, "in the office"
    assert y > 1.8
    assert robot.base.bump_speed <= FASTEST_BUMP


def test_fewer_views_make_a_panorama_of_wider_turns() -> None:
    config = robot_config("generic", {"panorama_views": 9})
    robot = searching(robot=config)
    for _ in range(3000):
        robot.tick()
        if robot.search.steps == 9:
            break
    turned = np.unwrap([point.yaw for point in robot.base.trace])
    assert math.degrees(turned[-1] - turned[0]) == pytest.approx(8 * 40.0, abs=45.0)
