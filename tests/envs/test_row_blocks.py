"""Rows shared out over threads: each once, and images that do not depend on the threads."""

from __future__ import annotations

import multiprocessing
from threading import Lock

import numpy as np
import pytest
from box_scenes import room

from toponav.cores import usable_cores
from toponav.envs.simulator.raycaster import RayCaster
from toponav.envs.simulator.renderer import Renderer
from toponav.envs.simulator.row_blocks import for_row_blocks
from toponav.geometry import Intrinsics, Pose
from toponav.geometry.conventions import BODY_FROM_OPTICAL

CAMERA = Intrinsics.from_hfov(160, 121, 79.0)
POSE = Pose.from_yaw(0.3, (1.0, 1.7, 0.9)) @ BODY_FROM_OPTICAL


@pytest.mark.parametrize("height", [1, 29, 30, 31, 480])
@pytest.mark.parametrize("threads", [1, 2, 5])
def test_every_row_is_computed_once(height: int, threads: int) -> None:
    rows: list[int] = []
    lock = Lock()

    def work(first: int, end: int) -> None:
        with lock:
            rows.extend(range(first, end))

    for_row_blocks(height, work, threads)
    assert sorted(rows) == list(range(height))


def test_an_error_in_a_thread_is_raised() -> None:
    def work(first: int, end: int) -> None:
        if first:
            raise ValueError("row")

    with pytest.raises(ValueError, match="row"):
        for_row_blocks(100, work, 2)


def test_images_do_not_depend_on_the_number_of_threads() -> None:
    mesh = room(extra=[("table", ((3.0, 1.5, 0.1), (4.0, 2.5, 0.8)))])
    for one, many in [
        (Renderer(mesh, threads=1), Renderer(mesh, threads=3)),
        (Renderer(mesh, RayCaster(mesh), 1), Renderer(mesh, RayCaster(mesh), 3)),
    ]:
        alone, shared = one.render(POSE, CAMERA), many.render(POSE, CAMERA)
        assert len(np.unique(alone.instance_ids)) > 4
        np.testing.assert_array_equal(alone.rgb, shared.rgb)
        np.testing.assert_array_equal(alone.depth, shared.depth)
        np.testing.assert_array_equal(alone.instance_ids, shared.instance_ids)


def test_a_forked_process_computes_with_threads_of_its_own() -> None:
    for_row_blocks(100, lambda first, end: None, 2)
    child = multiprocessing.get_context("fork").Process(
        target=for_row_blocks, args=(100, lambda first, end: None, 2)
    )
    child.start()
    child.join(20)
    assert child.exitcode == 0


def test_omp_num_threads_limits_the_cores(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("OMP_NUM_THREADS", "1")
    assert usable_cores() == 1
    monkeypatch.setenv("OMP_NUM_THREADS", "4,2")
    assert usable_cores() >= 1
