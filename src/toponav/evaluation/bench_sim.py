"""How fast the simulator renders: RGB, depth and ids with each renderer, frame about."""

from __future__ import annotations

import math
import os
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import numpy as np

from toponav.cores import usable_cores
from toponav.envs.simulator.navigation import NavigableSurface
from toponav.envs.simulator.renderer import CameraRenderer
from toponav.envs.simulator.renderers import RendererName, make_renderer
from toponav.geometry import Intrinsics, Pose
from toponav.geometry.conventions import BODY_FROM_OPTICAL
from toponav.scenes.mesh import Scene

CAMERA_HEIGHT_M = 0.88
HFOV_DEG = 79.0
WARM_UP_FRAMES = 3


def bench_sim(
    scene: Scene,
    renderers: Sequence[RendererName],
    size: tuple[int, int],
    frames: int,
    seed: int = 0,
) -> dict[str, Any]:
    """Render frames at random places of a scene and time them.

    The renderers take turns at every place, so that whatever else the machine does slows them all.

    Args:
        scene: Where.
        renderers: Which; each uses all cores that this process may use.
        size: Columns and rows.
        frames: How many are timed.
        seed: Seeds the places.

    Returns:
        `sim_fps` by renderer, one over the median frame; `frame_ms`, that median; `cpu_ms`, the
        median processor time of a frame on all cores together, which other processes disturb
        less; `surface_s` to build the navigable surface; `triangles`; `cores` in use.
    """
    started = time.perf_counter()
    surface = NavigableSurface.build(scene.mesh, floors=scene.floors)
    surface_s = time.perf_counter() - started
    made = {name: make_renderer(name, scene.mesh) for name in renderers}
    intrinsics = Intrinsics.from_hfov(*size, HFOV_DEG)
    seconds: dict[str, list[tuple[float, float]]] = {name: [] for name in renderers}
    for pose in camera_poses(surface, WARM_UP_FRAMES + frames, np.random.default_rng(seed)):
        for name, renderer in made.items():
            seconds[name].append(_seconds(renderer, pose, intrinsics))
    median = {name: np.median(both[WARM_UP_FRAMES:], axis=0) for name, both in seconds.items()}
    return {
        "scene": scene.name,
        "size": list(size),
        "triangles": len(scene.mesh.faces),
        "sim_fps": {name: float(1.0 / wall) for name, (wall, _) in median.items()},
        "frame_ms": {name: float(1e3 * wall) for name, (wall, _) in median.items()},
        "cpu_ms": {name: float(1e3 * cpu) for name, (_, cpu) in median.items()},
        "surface_s": surface_s,
        "cores": usable_cores(),
    }


@contextmanager
def only_cores(count: int | None) -> Iterator[None]:
    """Keep this thread, and those it starts meanwhile, on the first cores; None leaves it alone.

    Systems without CPU affinity keep all their cores.
    """
    if count is None or not hasattr(os, "sched_setaffinity"):
        yield
        return
    before = os.sched_getaffinity(0)
    os.sched_setaffinity(0, sorted(before)[:count])
    try:
        yield
    finally:
        os.sched_setaffinity(0, before)


def camera_poses(surface: NavigableSurface, count: int, rng: np.random.Generator) -> list[Pose]:
    """Level cameras at random places where an agent can stand."""
    base_from_camera = Pose.from_yaw(0.0, (0.0, 0.0, CAMERA_HEIGHT_M)) @ BODY_FROM_OPTICAL
    return [
        Pose.from_yaw(rng.uniform(-math.pi, math.pi), surface.random_point(rng)) @ base_from_camera
        for _ in range(count)
    ]


def _seconds(renderer: CameraRenderer, pose: Pose, intrinsics: Intrinsics) -> tuple[float, float]:
    """Time that passes for a frame, and processor time of all threads."""
    started, used = time.perf_counter(), time.process_time()
    renderer.render(pose, intrinsics)
    return time.perf_counter() - started, time.process_time() - used
