"""What becomes of a map, and of a search, when things are moved while the agent looks for one."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from toponav.categories import HM3D_TARGETS, canonical
from toponav.config import NavigatorConfig
from toponav.envs.simulator import HouseEnv, HouseEnvConfig
from toponav.errors import EpisodeError
from toponav.evaluation.metrics import SUCCESS_RADII_M
from toponav.evaluation.rollout import EpisodeSpec, roll_out
from toponav.mapping.view import PointCloud
from toponav.navigator import Navigator
from toponav.perception.oracle import OracleDetector
from toponav.reasoning import PriorReasoner
from toponav.scenes.generate import generate_house
from toponav.scenes.house import House, HouseObject
from toponav.scenes.mesh import SceneEpisode
from toponav.scenes.meshing import build_scene
from toponav.scenes.move_objects import Moved, movable, move_objects
from toponav.types import Action, Observation

MOVED_OBJECTS = 3
"""The target, and the nearest things that are on the map already."""

SIGHT_SHARE = 0.003
"""Of an image's pixels that show the target when it has come into sight: then it is moved."""

NEAR_AGENT_M = 0.8
"""Nothing is put down this near to the agent."""

BOX_MARGIN_M = 0.05
"""Points of a thing may lie this far outside its box."""

PLAINLY_BEHIND_M, WITHIN_M = 0.25, 4.0
"""A view sees past a place when what it shows there lies so far behind it, from no farther off."""

LOOKS = 3
"""Views that must see past a place before it counts as looked at again."""

MAPPED_POINTS = 20
"""Voxels of a thing that is on the map."""

MOVE_TRIES = 10


@dataclass
class MovedFigures:
    """Of one configuration over all houses.

    Attributes:
        episodes: Houses.
        found: Episodes that ended at the target's new place.
        seen_again: Object voxels of moved things whose old place was looked at again.
        stale: Those of them that are still in the map at the end.
    """

    episodes: int = 0
    found: int = 0
    seen_again: int = 0
    stale: int = 0


def bench_moved(
    configs: dict[str, NavigatorConfig],
    houses: int,
    size: tuple[int, int],
    on_house: Callable[[str, str], None],
) -> dict[str, Any]:
    """Run every configuration in the same houses, in each of which three things are moved.

    The target is the only thing of its category, so that it can be found at its new place alone.

    Args:
        configs: By name.
        houses: Generated ones, from seed 0 on; seeds without such a target are passed over.
        size: Width and height of the images.
        on_house: Told of every episode: the house, and what came of it.

    Returns:
        By name, `MovedFigures` with `success` and `stale_share`; `houses`.
    """
    figures = {name: MovedFigures() for name in configs}
    seed = done = 0
    while done < houses:
        house = generate_house(seed)
        target = _single_target(house)
        seed += 1
        if target is None:
            continue
        done += 1
        for name, config in configs.items():
            found = _run(house, target, config, size, figures[name])
            on_house(house.name, f"{name}: {target.category} {'found' if found else 'not found'}")
    return {
        "houses": houses,
        "size": list(size),
        **{
            name: {
                **asdict(one),
                "success": one.found / one.episodes,
                "stale_share": one.stale / max(1, one.seen_again),
            }
            for name, one in figures.items()
        },
    }


def _single_target(house: House) -> HouseObject | None:
    """A movable thing of a target category of which there is one."""
    for name in HM3D_TARGETS:
        things = [
            t for level in house.levels for t in level.objects if canonical(t.category) == name
        ]
        if (
            len(things) == 1
            and things[0] in movable(house)
            and len(movable(house)) >= MOVED_OBJECTS
        ):
            return things[0]
    return None


def _run(
    house: House,
    target: HouseObject,
    config: NavigatorConfig,
    size: tuple[int, int],
    figures: MovedFigures,
) -> bool:
    """One episode; adds to the figures."""
    env = HouseEnv(build_scene(house, None), HouseEnvConfig(width=size[0], height=size[1]))
    agent = Navigator(OracleDetector(env.oracle), PriorReasoner(), config)
    mover = _Mover(env, agent, house, target)
    episode = env.sample_episode(np.random.default_rng(0), canonical(target.category))
    spec = EpisodeSpec(house.name, 0, SceneEpisode(episode.target, episode.start, episode.yaw), 0)
    rollout = roll_out(env, agent, spec, (mover,))
    found = rollout.stopped and rollout.distance_to_goal < SUCCESS_RADII_M[0]
    figures.episodes += 1
    figures.found += found
    seen_again, stale = mover.stale()
    figures.seen_again += seen_again
    figures.stale += stale
    agent.close()
    return bool(found)


class _Mover:
    """Moves things in the middle of an episode, and watches what the map keeps of them."""

    def __init__(self, env: HouseEnv, agent: Navigator, house: House, target: HouseObject) -> None:
        """Move the target, and other things, when it comes into sight."""
        self._env = env
        self._agent = agent
        self._house = house
        self._target = target
        self._old: list[_OldPlace] | None = None

    def on_step(self, observation: Observation, action: Action) -> None:
        """Move when it is time; afterwards, count the views that see past the old places."""
        del action
        if self._old is not None:
            for place in self._old:
                place.looks += _seen_past(place.points, observation)
        elif self._is_time(observation):
            self._move(observation)

    def stale(self) -> tuple[int, int]:
        """Voxels whose place was looked at again, and those of them that the map still holds."""
        objects = self._objects()
        resolution = self._agent.config.map.r_pcd
        seen_again = stale = 0
        for place in self._old or ():
            kept = objects[place.label].points if place.label in objects else place.points[:0]
            voxels = set(map(tuple, np.floor(kept / resolution).astype(int).tolist()))
            again = place.points[place.looks >= LOOKS]
            seen_again += len(again)
            at = map(tuple, np.floor(again / resolution).astype(int).tolist())
            stale += sum(voxel in voxels for voxel in at)
        return seen_again, stale

    def _objects(self) -> dict[str, PointCloud]:
        """M_obj by category."""
        return dict(self._agent.knowledge.semantic_map.view().objects)

    def _is_time(self, observation: Observation) -> bool:
        frame = self._env.semantic_frame()
        wanted = [i.id for i in frame.instances if i.category == self._env.target]
        in_sight = np.isin(frame.instance_ids, wanted) & (observation.depth > 0.0)
        return float(in_sight.mean()) > SIGHT_SHARE

    def _move(self, observation: Observation) -> None:
        objects, here = self._objects(), self._env.position
        mapped = [
            thing
            for thing in movable(self._house)
            if thing is not self._target and len(_points_of(thing, objects)) >= MAPPED_POINTS
        ]
        mapped.sort(key=lambda thing: math.dist(thing.position[:2], here[:2].tolist()))
        things = [self._target, *mapped[: MOVED_OBJECTS - 1]]
        for attempt in range(MOVE_TRIES):
            rng = np.random.default_rng([observation.step, attempt])
            house, moved = move_objects(self._house, things, rng, (here, NEAR_AGENT_M))
            try:
                self._env.change_to(build_scene(house, None))
            except EpisodeError:
                continue
            self._old = [_OldPlace.of(thing, objects) for thing in moved]
            return


@dataclass
class _OldPlace:
    """Where a thing was.

    Attributes:
        label: Its category.
        points: (N, 3) its voxels on the map when it was moved, metres.
        looks: (N,) views since then that saw past them.
    """

    label: str
    points: NDArray[np.float32]
    looks: NDArray[np.int64]

    @classmethod
    def of(cls, thing: Moved, objects: Mapping[str, PointCloud]) -> _OldPlace:
        """What the map knew of a thing, where it does not stand now."""
        points = _points_of(thing.before, objects)
        points = points[~_in_box(points, thing.after)]
        return cls(canonical(thing.before.category), points, np.zeros(len(points), np.int64))


def _points_of(thing: HouseObject, objects: Mapping[str, PointCloud]) -> NDArray[np.float32]:
    """(N, 3) the voxels of a thing's category in its box."""
    cloud = objects.get(canonical(thing.category))
    points = np.empty((0, 3), np.float32) if cloud is None else cloud.points
    return points[_in_box(points, thing)]


def _in_box(points: NDArray[np.float32], thing: HouseObject) -> NDArray[np.bool_]:
    offset = points - np.array(thing.position)
    c, s = np.cos(thing.yaw), np.sin(thing.yaw)
    along = np.abs(c * offset[:, 0] + s * offset[:, 1])
    across = np.abs(-s * offset[:, 0] + c * offset[:, 1])
    half = np.array(thing.size) / 2 + BOX_MARGIN_M
    inside = (along <= half[0]) & (across <= half[1])
    return np.asarray(inside & (offset[:, 2] >= -BOX_MARGIN_M) & (offset[:, 2] <= 2 * half[2]))


def _seen_past(points: NDArray[np.float32], observation: Observation) -> NDArray[np.bool_]:
    """(N,) whether a view shows only what lies behind each point."""
    camera = observation.intrinsics
    in_camera = observation.world_from_camera.inverse().apply(points.astype(np.float64))
    depth = in_camera[:, 2]
    ahead = (depth > 0.1) & (depth < WITHIN_M)
    z = np.where(ahead, depth, 1.0)
    column = np.rint(in_camera[:, 0] / z * camera.fx + camera.cx).astype(int)
    row = np.rint(in_camera[:, 1] / z * camera.fy + camera.cy).astype(int)
    ahead &= (column >= 0) & (column < camera.width) & (row >= 0) & (row < camera.height)
    shown = observation.depth[np.where(ahead, row, 0), np.where(ahead, column, 0)]
    return np.asarray(ahead & (shown > depth + PLAINLY_BEHIND_M))
