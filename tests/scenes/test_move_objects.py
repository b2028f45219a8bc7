"""Things that are moved stand in a room, in nobody's way, and elsewhere than before."""

import numpy as np
import pytest
from shapely.geometry import Point, Polygon

from toponav.envs.simulator import HouseEnv, HouseEnvConfig
from toponav.errors import EpisodeError
from toponav.scenes.generate import generate_house
from toponav.scenes.meshing import build_scene
from toponav.scenes.move_objects import movable, move_objects
from toponav.scenes.room_space import rectangle

FAR_AWAY = (np.array([1e3, 1e3]), 0.0)


@pytest.mark.parametrize("seed", range(4))
def test_moved_things_stand_in_a_room_and_in_nothing(seed: int) -> None:
    house = generate_house(seed)
    things = movable(house)[:3]
    after, moved = move_objects(house, things, np.random.default_rng(seed), FAR_AWAY)
    assert moved
    for before, now in moved:
        assert (now.category, now.size) == (before.category, before.size)
        assert np.hypot(*np.subtract(now.position, before.position)[:2]) > before.size[0]
        level = next(level for level in after.levels if now in level.objects)
        assert before not in level.objects
        footprint = rectangle(np.array(now.position[:2]), now.yaw, *now.size[:2])
        room = next(
            room for room in level.rooms if Polygon(room.polygon).contains(Point(now.position[:2]))
        )
        assert Polygon(room.polygon).contains(footprint)
        for other in movable(after):
            if other is not now and other in level.objects:
                box = rectangle(np.array(other.position[:2]), other.yaw, *other.size[:2])
                assert not footprint.intersects(box)


def test_nothing_is_put_down_where_it_must_not_be() -> None:
    house = generate_house(1)
    thing = movable(house)[0]
    for seed in range(20):
        _, moved = move_objects(
            house, [thing], np.random.default_rng(seed), (np.array(thing.position), 3.0)
        )
        for _, now in moved:
            assert np.hypot(*np.subtract(now.position, thing.position)[:2]) > 3.0


def test_an_episode_goes_on_in_the_changed_house() -> None:
    house = generate_house(1)
    env = HouseEnv(build_scene(house, None), HouseEnvConfig(width=80, height=60))
    env.reset(seed=0)
    thing = min(movable(house), key=lambda one: one.size[0])
    changed, moved = move_objects(house, [thing], np.random.default_rng(0), (env.position, 1.5))
    position, step = env.position.copy(), env.observe().step
    place = np.array(moved[0].after.position)
    assert env.surface.snap(place, 0.1) is not None
    env.change_to(build_scene(changed, None))
    np.testing.assert_array_equal(env.position, position)
    assert env.observe().step == step
    assert env.surface.snap(place, 0.1) is None


def test_a_change_that_would_bury_the_agent_is_refused_and_leaves_the_world_as_it_was() -> None:
    house = generate_house(1)
    env = HouseEnv(build_scene(house, None), HouseEnvConfig(width=80, height=60))
    env.reset(seed=0)
    before = env.observe().depth.copy()
    thing = movable(house)[0]
    x, y, _ = env.position.tolist()
    on_it = thing.model_copy(
        update={"position": (x, y, thing.position[2]), "size": (2.0, 2.0, 1.5)}
    )
    levels = [
        level.model_copy(
            update={"objects": [on_it if one is thing else one for one in level.objects]}
        )
        for level in house.levels
    ]
    buried = build_scene(house.model_copy(update={"levels": levels}), None)
    with pytest.raises(EpisodeError, match="would stand where the agent is"):
        env.change_to(buried)
    np.testing.assert_array_equal(env.observe().depth, before)
