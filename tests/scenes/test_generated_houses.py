"""Generated houses: plans in which the simulator's own agent gets everywhere it has to."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest
from shapely import Polygon, contains_xy
from shapely.geometry import Point

from toponav.envs.simulator import HouseEnv, HouseEnvConfig
from toponav.errors import SceneError
from toponav.scenes.generate import GeneratorConfig, generate_house, parse_generator_spec
from toponav.scenes.house import House, HouseObject, Level, Opening
from toponav.scenes.meshing import build_scene
from toponav.scenes.validation import validate_house

ONE_LEVEL = (0, 1, 2, 5, 6, 7, 10)
TWO_LEVELS = (3, 4, 8, 9, 13)
SEEDS = ONE_LEVEL + TWO_LEVELS
OPTIONED = (
    GeneratorConfig(rooms=3, size=0.8, clutter=1.0),
    GeneratorConfig(rooms=14, size=0.8, clutter=1.0),
    GeneratorConfig(rooms=14, size=1.6, clutter=0.0),
    GeneratorConfig(rooms=3, levels=2, size=0.8, clutter=1.0),
    GeneratorConfig(rooms=14, levels=2, size=1.6, clutter=1.0),
)
"""The ends of the options' ranges."""
HOUSES = [*((seed, GeneratorConfig()) for seed in SEEDS), *((1, config) for config in OPTIONED)]

SAME_FLOOR_M = 0.1
TOUCH_M = 0.02
"""Furniture may touch what it stands at."""
BEFORE_DOOR_M = 0.35
"""From the middle of an opening to where an agent stands before it."""

every_house = pytest.mark.parametrize(("seed", "config"), HOUSES)


@cache
def simulated(seed: int, config: GeneratorConfig) -> tuple[House, HouseEnv]:
    house = generate_house(seed, config)
    return house, HouseEnv(build_scene(house), HouseEnvConfig(width=8, height=6))


def on_floor(env: HouseEnv, xy: np.ndarray, floor: float) -> np.ndarray:
    """(M, 3) points of the main island over (N, 2) places, on one floor."""
    points = env.surface.points_over(xy)
    return points[np.abs(points[:, 2] - floor) < SAME_FLOOR_M]


def footprint(item: HouseObject) -> Polygon:
    half_x, half_y = item.size[0] / 2, item.size[1] / 2
    cos, sin = math.cos(item.yaw), math.sin(item.yaw)
    corners = ((half_x, half_y), (-half_x, half_y), (-half_x, -half_y), (half_x, -half_y))
    x, y, _ = item.position
    return Polygon([(x + cos * u - sin * v, y + sin * u + cos * v) for u, v in corners])


def across(level: Level, opening: Opening) -> np.ndarray:
    """The unit axis along which one goes through an opening between two rooms."""
    polygons = {room.id: Polygon(room.polygon) for room in level.rooms}
    first, second = (polygons[name] for name in opening.rooms)
    center = np.array(opening.center)
    for axis in np.eye(2):
        for way in (axis, -axis):
            before, behind = Point(center - 0.3 * way), Point(center + 0.3 * way)
            if first.contains(before) and second.contains(behind):
                return way
    raise AssertionError(f"{opening.center} does not lie between {opening.rooms}")


@every_house
def test_the_format_holds_and_a_seed_is_one_house(seed: int, config: GeneratorConfig) -> None:
    house, _ = simulated(seed, config)
    validate_house(house)
    assert House.model_validate_json(house.model_dump_json()) == house
    assert generate_house(seed, config) == house
    assert generate_house(seed + 1, config).levels != house.levels


@every_house
def test_rooms_do_not_overlap(seed: int, config: GeneratorConfig) -> None:
    for level in simulated(seed, config)[0].levels:
        polygons = [Polygon(room.polygon) for room in level.rooms]
        for k, one in enumerate(polygons):
            assert one.area > 1.0
            assert all(one.intersection(other).area < 1e-6 for other in polygons[:k])


@every_house
def test_furniture_stands_inside_one_room_and_apart(seed: int, config: GeneratorConfig) -> None:
    house, _ = simulated(seed, config)
    for level in house.levels:
        rooms = [Polygon(room.polygon).buffer(TOUCH_M) for room in level.rooms]
        ceiling = level.floor + level.rooms[0].height
        for item in level.objects:
            assert any(room.contains(footprint(item)) for room in rooms), item.id
            base, top = item.position[2], item.position[2] + item.size[2]
            assert level.floor <= base < top <= ceiling, item.id


@every_house
def test_the_agent_reaches_every_room(seed: int, config: GeneratorConfig) -> None:
    house, env = simulated(seed, config)
    for level in house.levels:
        for room in level.rooms:
            polygon = Polygon(room.polygon)
            x0, y0, x1, y1 = polygon.bounds
            x, y = (axis.ravel() for axis in np.mgrid[x0:x1:0.1, y0:y1:0.1])
            inside = contains_xy(polygon, x, y)
            free = on_floor(env, np.column_stack([x, y])[inside], level.floor)
            assert len(free) > 0.1 * inside.sum(), (level.floor, room.id, room.type)


@every_house
def test_every_passage_is_walked_straight_through(seed: int, config: GeneratorConfig) -> None:
    house, env = simulated(seed, config)
    for level in house.levels:
        for opening in level.openings:
            if len(opening.rooms) == 1:
                continue  # an outer door: nothing to reach behind it
            way = across(level, opening)
            before = np.array(opening.center) - BEFORE_DOOR_M * way
            place = np.array([*before, level.floor])
            motion = env.surface.move(place, math.atan2(way[1], way[0]), 2 * BEFORE_DOOR_M)
            assert not motion.collided, (opening.rooms, opening.center)
            assert len(on_floor(env, motion.position[None, :2], level.floor)) == 1


@pytest.mark.parametrize("seed", TWO_LEVELS)
def test_stairs_join_the_storeys(seed: int) -> None:
    house, env = simulated(seed, GeneratorConfig())
    (flight,) = house.stairs
    up = np.subtract(flight.end, flight.start)
    run = float(np.hypot(*up))
    foot, head = (
        np.array([*(np.array(end) + sign * 0.4 * up / run), level.floor])
        for end, sign, level in zip((flight.start, flight.end), (-1, 1), house.levels, strict=True)
    )
    rise = house.levels[1].floor - house.levels[0].floor
    walked = env.surface.geodesic_distance(foot, head)
    assert run + 0.7 < walked < 1.1 * (math.hypot(run, rise) + 0.8)


@every_house
def test_episodes_start_on_free_floor_and_end_at_the_target(
    seed: int, config: GeneratorConfig
) -> None:
    house, env = simulated(seed, config)
    assert len(house.episodes) == config.episodes
    floors = [level.floor for level in house.levels]
    for number, episode in enumerate(house.episodes):
        env.reset(options={"episode": number})
        assert env.target == episode.target
        np.testing.assert_allclose(env.position, episode.start, atol=0.05)
        assert 0.5 < env.oracle.distance_to_goal() < 60.0
        if len(floors) == 2:
            other = house.levels[1 - floors.index(episode.start[2])]
            own = house.levels[floors.index(episode.start[2])]
            has = [episode.target in {item.category for item in lv.objects} for lv in (own, other)]
            assert has[1] or has[0]
            if number % 2:
                assert has == [False, True]


def test_two_of_five_seeds_have_two_storeys() -> None:
    houses = [generate_house(*house) for house in parse_generator_spec("generated:0-24")]
    assert [house.name for house in houses] == [f"generated_{seed}" for seed in range(25)]
    assert sum(len(house.levels) == 2 for house in houses) == 10
    assert sum(len(house.levels) == 1 for house in houses) == 15


@pytest.mark.parametrize("rooms", [3, 5, 8, 14])
@pytest.mark.parametrize("levels", [1, 2])
def test_rooms_and_levels_are_those_asked_for(rooms: int, levels: int) -> None:
    for seed in (1, 3):
        house = generate_house(seed, GeneratorConfig(rooms=rooms, levels=levels))
        assert len(house.levels[0].rooms) == rooms
        assert len(house.levels) == levels == len(house.stairs) + 1


def test_size_stretches_and_clutter_fills() -> None:
    def floor_area(size: float) -> float:
        house = generate_house(5, GeneratorConfig(rooms=8, size=size))
        return sum(Polygon(room.polygon).area for room in house.levels[0].rooms)

    def pieces(clutter: float) -> int:
        houses = (generate_house(seed, GeneratorConfig(clutter=clutter)) for seed in range(5))
        return sum(len(level.objects) for house in houses for level in house.levels)

    assert floor_area(0.8) < floor_area(1.0) < floor_area(1.6)
    assert pieces(0.0) < pieces(0.5) < pieces(1.0)


def test_as_many_episodes_as_asked_for() -> None:
    assert generate_house(1, GeneratorConfig(episodes=0)).episodes == []
    many = generate_house(1, GeneratorConfig(episodes=7)).episodes
    assert len(many) == 7
    assert len({episode.start for episode in many}) == 7


def test_a_range_shares_its_options() -> None:
    config = GeneratorConfig(rooms=5, clutter=0.25)
    assert parse_generator_spec("generated:2-4?rooms=5&clutter=0.25") == [
        (2, config), (3, config), (4, config),
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("spec", "message"),
    [
        ("generated:", "no generator spec"),
        ("generated:-3", "no generator spec"),
        ("generated:7 ", "no generator spec"),
        ("generated:5-3", "range ends before it starts"),
        ("generated:1?walls=3", "unknown option 'walls=3'; known: rooms, levels"),
        ("generated:1?rooms", "unknown option 'rooms'"),
        ("generated:1?rooms=99", "rooms: .*less than or equal to 14"),
        ("generated:1?levels=0", "levels: .*greater than or equal to 1"),
        ("generated:1?clutter=nan", "clutter"),
        ("generated:1?size=big", "size: .*valid number"),
    ],
)
def test_bad_specs_are_refused_in_one_line(spec: str, message: str) -> None:
    with pytest.raises(SceneError, match=message) as refused:
        parse_generator_spec(spec)
    assert "\n" not in str(refused.value)
