"""How fast the simulator renders: RGB, depth and ids on one core."""

from __future__ import annotations

import math
import os
import time
from typing import Any

import numpy as np

from toponav.envs.simulator.navigation import NavigableSurface
from toponav.envs.simulator.raycaster import RayCaster
from toponav.envs.simulator.renderer import Renderer
from toponav.geometry import Intrinsics, Pose
from toponav.geometry.conventions import BODY_FROM_OPTICAL
from toponav.scenes.mesh import Scene

CAMERA_HEIGHT_M = 0.88
HFOV_DEG = 79.0
WARM_UP_FRAMES = 3


def bench_sim(scene: Scene, width: int, height: int, frames: int, seed: int = 0) -> dict[str, Any]:
    """Render frames at random places of a scene and time them.

    Args:
        scene: Where.
        width: Columns.
        height: Rows.
        frames: How many are timed.
        seed: Seeds the places.

    Returns:
        `sim_fps` by renderer (one over the median frame), `embree_ms` (the ray casting alone),
        `frame_ms`, `triangles`, `cores` (of the machine; one is used).
    """
    started = time.perf_counter()
    surface = NavigableSurface.build(scene.mesh, floors=scene.floors)
    surface_s = time.perf_counter() - started
    renderer = Renderer(scene.mesh, RayCaster(scene.mesh))
    intrinsics = Intrinsics.from_hfov(width, height, HFOV_DEG)
    rng = np.random.default_rng(seed)
    whole, casting = [], []
    for frame in range(WARM_UP_FRAMES + frames):
        foot = Pose.from_yaw(rng.uniform(-math.pi, math.pi), surface.random_point(rng))
        eye = Pose.from_yaw(0.0, (0.0, 0.0, CAMERA_HEIGHT_M)) @ BODY_FROM_OPTICAL
        world_from_camera = foot @ eye
        clock = time.perf_counter()
        renderer.render(world_from_camera, intrinsics)
        rendered = time.perf_counter()
        directions = intrinsics.rays().reshape(-1, 3) @ world_from_camera.rotation.T
        rays = directions.astype(np.float32)
        cast_from = time.perf_counter()
        renderer.caster.cast_from(world_from_camera.translation, rays)
        cast_to = time.perf_counter()
        if frame >= WARM_UP_FRAMES:
            whole.append(rendered - clock)
            casting.append(cast_to - cast_from)
    frame_s = float(np.median(whole))
    return {
        "scene": scene.name,
        "size": [width, height],
        "triangles": len(scene.mesh.faces),
        "sim_fps": {"embree": 1.0 / frame_s},
        "frame_ms": 1e3 * frame_s,
        "embree_ms": 1e3 * float(np.median(casting)),
        "surface_s": surface_s,
        "cores": os.cpu_count(),
    }
