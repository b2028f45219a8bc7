"""How fast the simulator renders: RGB, depth and ids on one core."""

from __future__ import annotations

import math
import os
import time
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from toponav.envs.simulator.navigation import NavigableSurface
from toponav.envs.simulator.rasterizer import Rasterizer
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
        `sim_fps` by renderer: `raster` is the simulator's, `embree` casts a ray a pixel instead
        (one over the median frame); `frame_ms` of the former, of which `visibility_ms` find the
        triangles and the rest shades them; `surface_s` to build the navigable surface;
        `triangles`; `cores` (of the machine; one is used).
    """
    started = time.perf_counter()
    surface = NavigableSurface.build(scene.mesh, floors=scene.floors)
    surface_s = time.perf_counter() - started
    rasterizer, caster = Rasterizer(scene.mesh), RayCaster(scene.mesh)
    renderers = {
        "raster": Renderer(scene.mesh, rasterizer),
        "embree": Renderer(scene.mesh, caster),
    }
    intrinsics = Intrinsics.from_hfov(width, height, HFOV_DEG)
    poses = _camera_poses(surface, WARM_UP_FRAMES + frames, np.random.default_rng(seed))
    frame_s = {
        name: _median_seconds(renderer.render, poses, intrinsics)
        for name, renderer in renderers.items()
    }
    visibility_s = _median_seconds(rasterizer.visible_faces, poses, intrinsics)
    return {
        "scene": scene.name,
        "size": [width, height],
        "triangles": len(scene.mesh.faces),
        "sim_fps": {name: 1.0 / seconds for name, seconds in frame_s.items()},
        "frame_ms": 1e3 * frame_s["raster"],
        "visibility_ms": 1e3 * visibility_s,
        "surface_s": surface_s,
        "cores": os.cpu_count(),
    }


def _camera_poses(surface: NavigableSurface, count: int, rng: np.random.Generator) -> list[Pose]:
    """Level cameras at random places where an agent can stand."""
    base_from_camera = Pose.from_yaw(0.0, (0.0, 0.0, CAMERA_HEIGHT_M)) @ BODY_FROM_OPTICAL
    return [
        Pose.from_yaw(rng.uniform(-math.pi, math.pi), surface.random_point(rng)) @ base_from_camera
        for _ in range(count)
    ]


def _median_seconds(
    see: Callable[[Pose, Intrinsics], object], poses: Sequence[Pose], intrinsics: Intrinsics
) -> float:
    """Median time of seeing from each pose, those of the warm-up left out."""
    seconds = []
    for pose in poses:
        started = time.perf_counter()
        see(pose, intrinsics)
        seconds.append(time.perf_counter() - started)
    return float(np.median(seconds[WARM_UP_FRAMES:]))
