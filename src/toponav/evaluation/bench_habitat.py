"""The embedded simulator against habitat-sim in one scene: images, distances, walks and speed."""

from __future__ import annotations

import math
import time
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter, minimum_filter

from toponav.envs.habitat.env import HabitatEnv
from toponav.envs.simulator import HouseEnv, HouseEnvConfig
from toponav.errors import InputError
from toponav.scenes.mesh import Scene
from toponav.types import STRUCTURE_CATEGORIES, Action

EDGE_M = 0.05
"""Pixels beside a larger jump in depth, or beside another object, lie on an edge."""

SAME_PLACE_M = 0.05
"""Positions that differ by more have parted."""

WALK = (Action.MOVE_FORWARD,) * 3 + (Action.TURN_LEFT, Action.TURN_RIGHT)
"""What a random walk draws from."""


NO_TARGET = STRUCTURE_CATEGORIES | {"unknown"}


def bench_habitat(
    scene: Scene, config: HouseEnvConfig, poses: int, pairs: int, actions: int, seed: int = 0
) -> dict[str, Any]:
    """Compare the two simulators at random places.

    Args:
        scene: One that Habitat loads too.
        config: Camera and body.
        poses: Views whose images are compared and timed.
        pairs: Pairs of points between which geodesic distances are compared.
        actions: Length of a random walk.
        seed: Draws places and actions.

    Returns:
        `depth_m`: the largest median difference of a view; `ids`: the lowest share of equal ids of
        a view; `rgb`: mean difference of a channel, of 255; `geodesic_ok`: share of pairs that
        agree within 5 % or 0.15 m, `geodesic_m` the largest difference; `walk`: steps until the
        positions part by 5 cm (all of them if they never do), `walk_m` the largest difference by
        then, `collisions` the share of equal collision flags; `fps` of both, with RGB, depth and
        ids.

    Raises:
        SceneError: Habitat cannot load the scene.
        InputError: A number is not positive.
    """
    if min(poses, pairs, actions) < 1:
        raise InputError("give positive numbers of poses, pairs and actions")
    rng = np.random.default_rng(seed)
    embedded, habitat = HouseEnv(scene, config), HabitatEnv(scene, config)
    try:
        return {
            "scene": scene.name,
            "size": [config.width, config.height],
            "area_m2": {"embedded": embedded.surface.area, "habitat": habitat.surface.area},
            **_views(embedded, habitat, poses, rng),
            **_distances(embedded, habitat, pairs, rng),
            **_walk(embedded, habitat, actions, rng),
        }
    finally:
        habitat.close()


def _views(
    embedded: HouseEnv, habitat: HouseEnv, poses: int, rng: np.random.Generator
) -> dict[str, Any]:
    depth, ids, rgb = [], [], []
    seconds: dict[str, list[float]] = {"embedded": [], "habitat": []}
    for start in _starts(embedded, habitat, poses + 1, rng):
        for name, env in (("embedded", embedded), ("habitat", habitat)):
            _place(env, start)
            began = time.perf_counter()
            env.step(Action.TURN_LEFT)
            seconds[name].append(time.perf_counter() - began)
        a, b = embedded.semantic_frame(), habitat.semantic_frame()
        inner = ~(_edges(a.depth, a.instance_ids) | _edges(b.depth, b.instance_ids))
        depth.append(float(np.median(np.abs(a.depth - b.depth)[inner])))
        ids.append(float((a.instance_ids == b.instance_ids)[inner].mean()))
        colors = [env.observe().rgb.astype(np.int64) for env in (embedded, habitat)]
        rgb.append(float(np.abs(colors[0] - colors[1])[inner].mean()))
    return {
        "depth_m": max(depth),
        "ids": min(ids),
        "rgb": float(np.mean(rgb)),
        # The first frame of each warms it up.
        "fps": {name: 1.0 / float(np.median(times[1:])) for name, times in seconds.items()},
    }


def _distances(
    embedded: HouseEnv, habitat: HouseEnv, pairs: int, rng: np.random.Generator
) -> dict[str, Any]:
    points = [start[:3] for start in _starts(embedded, habitat, 2 * pairs, rng)]
    gaps, agree = [], []
    for start, goal in zip(points[::2], points[1::2], strict=True):
        ours = embedded.surface.geodesic_distance(start, goal)
        theirs = habitat.surface.geodesic_distance(start, goal)
        gap = 0.0 if ours == theirs else abs(ours - theirs)
        gaps.append(gap)
        agree.append(math.isfinite(gap) and gap <= max(0.15, 0.05 * theirs))
    return {"geodesic_ok": float(np.mean(agree)), "geodesic_m": max(gaps)}


def _walk(
    embedded: HouseEnv, habitat: HouseEnv, actions: int, rng: np.random.Generator
) -> dict[str, Any]:
    [start] = _starts(embedded, habitat, 1, rng)
    for env in (embedded, habitat):
        _place(env, start)
    together, largest, equal = 0, 0.0, []
    for k in range(actions):
        action = WALK[int(rng.integers(len(WALK)))]
        for env in (embedded, habitat):
            env.step(action)
        gap = float(np.linalg.norm(embedded.position - habitat.position))
        if gap > SAME_PLACE_M:
            break
        largest, together = max(largest, gap), k + 1
        equal.append(embedded.collided == habitat.collided)
    return {"walk": together, "walk_m": largest, "collisions": float(np.mean(equal or [False]))}


def _starts(
    embedded: HouseEnv, habitat: HouseEnv, count: int, rng: np.random.Generator
) -> list[tuple[float, float, float, float]]:
    """Random places where both let the agent stand, with headings."""
    found: list[tuple[float, float, float, float]] = []
    while len(found) < count:
        x, y, z = (float(v) for v in embedded.surface.random_point(rng))
        if habitat.surface.is_navigable((x, y, z)):
            found.append((x, y, z, float(rng.uniform(-math.pi, math.pi))))
    return found


def _place(env: HouseEnv, start: tuple[float, float, float, float]) -> None:
    """Put the agent somewhere; what it looks for is all one."""
    category = next(
        instance.category
        for instance in env.scene.mesh.instances
        if instance.category not in NO_TARGET and len(env.oracle.viewpoints(instance.category))
    )
    env.reset(options={"target": category, "start": start})


def _edges(depth: NDArray[np.float32], ids: NDArray[np.int32]) -> NDArray[np.bool_]:
    """(H, W) pixels beside a jump."""
    jump = maximum_filter(depth, 3) - minimum_filter(depth, 3) > EDGE_M
    edge: NDArray[np.bool_] = jump | (maximum_filter(ids, 3) != minimum_filter(ids, 3))
    return edge
