"""What integrating a frame costs, beside a pipeline of the usual kind on the same frames."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from toponav.evaluation.bench_tour import TourFrame
from toponav.evaluation.open3d_pipeline import Open3dPipeline
from toponav.mapping.semantic_map import MapConfig, SemanticMap
from toponav.mapping.view import FrameUpdate, MapView
from toponav.mapping.voxels import unpack_keys
from toponav.policy.affordances import AffordanceConfig, exploration

REPETITIONS = 5
"""Of a decision's affordances."""

WARM_UP_FRAMES = 3
"""Frames of a map that is thrown away: the first ones compile."""


def bench_map(
    frames: Sequence[TourFrame], config: MapConfig, *, with_open3d: bool
) -> dict[str, Any]:
    """Map frames, and time every one.

    Args:
        frames: At least one.
        config: Of the map.
        with_open3d: Whether to time the pipeline of `open3d_pipeline` too, in the same run.

    Returns:
        `integrate_ms`, the median, and `integrate_p95_ms`; `integrate_cpu_ms`, the median of its
        processor time, which other processes disturb less; `view_ms` to hand the map out;
        `open3d_ms` and `open3d_ratio` over `integrate_ms`, None without Open3D; likewise
        `affordances_ms` of the paper's affordances on the last map, `pairs_ms` of the matrices of
        distances that are usually made for them, and `pairs_ratio`; `voxels`, and
        whether they are `equal_to_reference`: the voxels of all points, found by NumPy; `frames`,
        `size` and `cores` (of the machine; one is used).

    Raises:
        MissingExtraError: Open3D is wanted and not installed.
    """
    reference = Open3dPipeline(config) if with_open3d else None
    warm_up = SemanticMap(config)
    for frame in frames[:WARM_UP_FRAMES]:
        warm_up.integrate(*frame)
        warm_up.view()
    semantic_map = SemanticMap(config)
    integrate_s, integrate_cpu_s, view_s, open3d_s = [], [], [], []
    update: FrameUpdate | None = None
    for frame in frames:
        started, used = time.perf_counter(), time.process_time()
        update = semantic_map.integrate(*frame)
        integrate_s.append(time.perf_counter() - started)
        integrate_cpu_s.append(time.process_time() - used)
        view_s.append(_seconds(semantic_map.view))
        if reference is not None:
            open3d_s.append(_seconds(partial(reference.integrate, *frame)))
    integrate_ms = 1e3 * float(np.median(integrate_s))
    open3d_ms = 1e3 * float(np.median(open3d_s)) if open3d_s else None
    assert update is not None
    attracting = _attracting(frames, semantic_map.view(), update)
    affordances_ms, pairs_ms = _affordances_ms(semantic_map.view(), attracting, reference)
    scene = semantic_map.parts().scene
    found = unpack_keys(scene.arrays.keys[: len(scene)])
    return {
        "frames": len(frames),
        "size": [frames[0].observation.intrinsics.width, frames[0].observation.intrinsics.height],
        "integrate_ms": integrate_ms,
        "integrate_cpu_ms": 1e3 * float(np.median(integrate_cpu_s)),
        "integrate_p95_ms": 1e3 * float(np.quantile(integrate_s, 0.95)),
        "view_ms": 1e3 * float(np.median(view_s)),
        "open3d_ms": open3d_ms,
        "open3d_ratio": None if open3d_ms is None else open3d_ms / integrate_ms,
        "affordances_ms": affordances_ms,
        "pairs_ms": pairs_ms,
        "pairs_ratio": (None if pairs_ms is None else pairs_ms / affordances_ms),
        "voxels": len(found),
        "equal_to_reference": _same_rows(found, _voxels_of(frames, config)),
        "cores": os.cpu_count(),
    }


def _attracting(
    frames: Sequence[TourFrame], view: MapView, update: FrameUpdate
) -> tuple[NDArray[np.floating], NDArray[np.floating], NDArray[np.floating]]:
    """S_dir, S_node and S_hist: the last view's floor, all frontiers, where the agent was."""
    history = np.array([frame.observation.world_from_base.translation for frame in frames])
    return update.navigable_points, view.frontiers, history


def _affordances_ms(
    view: MapView,
    attracting: tuple[NDArray[np.floating], NDArray[np.floating], NDArray[np.floating]],
    reference: Open3dPipeline | None,
) -> tuple[float, float | None]:
    """Medians of our affordances, and of the reference's distances; None without it."""
    direction, node, history = attracting
    ours, theirs = [], []
    for _ in range(REPETITIONS):
        ours.append(
            _seconds(partial(exploration, view, direction, node, history, AffordanceConfig()))
        )
        if reference is not None:
            targets = (direction, node, view.frontiers, history)
            theirs.append(_seconds(partial(reference.pair_distances, targets)))
    return 1e3 * float(np.median(ours)), 1e3 * float(np.median(theirs)) if theirs else None


def _seconds(do: Callable[[], object]) -> float:
    started = time.perf_counter()
    do()
    return time.perf_counter() - started


def _voxels_of(frames: Sequence[TourFrame], config: MapConfig) -> NDArray[np.int64]:
    """(N, 3) indices of the voxels that hold a point of any frame, without our kernels."""
    found: NDArray[np.int64] = np.empty((0, 3), np.int64)
    for observation, _ in frames:
        camera, depth = observation.intrinsics, observation.depth.astype(np.float64)
        rows, columns = np.nonzero((depth > config.min_depth_m) & (depth < config.max_depth_m))
        d = depth[rows, columns]
        ray_x, ray_y = (columns - camera.cx) / camera.fx, (rows - camera.cy) / camera.fy
        pose = observation.world_from_camera
        directions = [r[0] * ray_x + (r[1] * ray_y + r[2]) for r in pose.rotation]
        points = np.stack(
            [d * u + t for u, t in zip(directions, pose.translation, strict=True)], axis=1
        )
        voxels = np.floor(points / config.r_pcd).astype(np.int64)
        found = np.unique(np.concatenate([found, np.unique(voxels, axis=0)]), axis=0)
    return found


def _same_rows(found: NDArray[np.int64], expected: NDArray[np.int64]) -> bool:
    return np.array_equal(np.unique(found, axis=0), expected)
