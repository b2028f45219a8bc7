"""Edges of the floor: found from the side that one can stand on, looked down once."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from ball_frames import frame
from drawn_map import drawn_map, reach_from
from toponav.control.drops import DropEdges
from toponav.control.locomotion import Locomotion, LocomotionConfig
from toponav.mapping.view import MapView
from toponav.types import Action, Observation

OPEN_EDGE = drawn_map(
    "##########",
    "#........#",
    "#....vvvv#",
    "#....vvvv#",
    "#........#",
    "##########",
    enlarged=4,
)
"""A floor of 3.2 m with a well in it."""
RAILED = drawn_map(
    "##########",
    "#...######",
    "#...#vvvv#",
    "#...#vvvv#",
    "#...######",
    "##########",
    enlarged=4,
)


def test_an_edge_is_found_and_stood_at_from_nearby() -> None:
    [edge] = DropEdges().clusters(OPEN_EDGE, reach_from(OPEN_EDGE, (0.8, 1.2)))
    assert edge.nearest[0] < 2.0
    assert np.hypot(*(edge.cells - edge.nearest[:2]).T).min() <= 0.5


def test_no_edge_behind_a_rail_and_none_without_a_drop() -> None:
    assert DropEdges().clusters(RAILED, reach_from(RAILED, (0.8, 1.2))) == ()
    hall = drawn_map("#####", "#...#", "#####", enlarged=6)
    assert DropEdges().clusters(hall, reach_from(hall, (1.0, 1.0))) == ()


def at(x: float, y: float, towards: tuple[float, float], z: float = 0.0) -> Observation:
    observation, _ = frame([], x, y, towards)
    if not z:
        return observation
    base = observation.world_from_base
    return replace(observation, world_from_base=type(base).from_yaw(base.yaw, (x, y, z)))


def actions(
    edges: DropEdges, view: MapView, *observations: Observation, landing: bool = False
) -> list[Action | None]:
    walker = Locomotion(LocomotionConfig())
    return [edges.look(observation, view, walker, landing=landing) for observation in observations]


def test_the_agent_turns_to_the_drop_and_looks_down_and_up_again() -> None:
    edges = DropEdges()
    [edge] = edges.clusters(OPEN_EDGE, reach_from(OPEN_EDGE, (0.8, 1.2)))
    edges.approach(edge)
    x, y = float(edge.nearest[0]), float(edge.nearest[1])
    away, towards = at(x, y, (-9.0, 1.2)), at(x, y, (9.0, 1.2))
    turn, down, up, done = actions(edges, OPEN_EDGE, away, towards, towards, towards)
    assert turn in (Action.TURN_LEFT, Action.TURN_RIGHT)
    assert (down, up, done) == (Action.LOOK_DOWN, Action.LOOK_UP, None)
    again = edges.clusters(OPEN_EDGE, reach_from(OPEN_EDGE, (0.8, 1.2)))
    assert all(np.hypot(*(other.nearest[:2] - (x, y))) > 0.5 for other in again)


def test_elsewhere_the_camera_stays_level_but_on_a_flight_it_does_not() -> None:
    level, on_flight = at(0.8, 1.2, (9.0, 1.2)), at(0.8, 1.2, (9.0, 1.2), z=-0.6)
    assert actions(DropEdges(), OPEN_EDGE, level) == [None]
    assert actions(DropEdges(), OPEN_EDGE, on_flight, on_flight) == [
        Action.LOOK_DOWN,
        Action.LOOK_UP,
    ]


@pytest.mark.parametrize(
    ("landing", "ahead"), [(False, (9.0, 0.8)), (True, (-9.0, 0.8))], ids=["leaving", "landing"]
)
def test_on_a_flight_it_looks_down_the_way_it_goes(
    landing: bool, ahead: tuple[float, float]
) -> None:
    hall = drawn_map("##########", "#........#", "#........#", "##########", enlarged=4)
    heights = np.full(hall.grid.cells.shape, np.nan, np.float32)
    heights[4:36, 4:12] = -0.1 * np.arange(1, 33)[:, None]  # away from the floor along x
    view = replace(hall, grid=replace(hall.grid, stairs=heights))
    onward, back = (at(2.0, 0.8, (side * ahead[0], 0.8), z=-1.6) for side in (1.0, -1.0))
    assert actions(DropEdges(), view, onward, landing=landing) == [Action.LOOK_DOWN]
    [turn] = actions(DropEdges(), view, back, landing=landing)
    assert turn in (Action.TURN_LEFT, Action.TURN_RIGHT)


@pytest.mark.parametrize("rise_m", [-0.1, 0.1])
def test_the_last_known_treads_of_a_flight_are_such_a_place(rise_m: float) -> None:
    hall = drawn_map("##########", "#........#", "#........#", "##########", enlarged=4)
    heights = np.full(hall.grid.cells.shape, np.nan, np.float32)
    heights[12:28, 4:12] = rise_m * np.arange(1, 17)[:, None]
    view = replace(hall, grid=replace(hall.grid, stairs=heights))
    [flight] = DropEdges().clusters(view, reach_from(view, (0.8, 0.8)))
    assert flight.nearest[0] > 2.4
