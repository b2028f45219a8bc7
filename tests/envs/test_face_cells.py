"""Cells of faces: each face in one, none left out that a camera sees, near ones first."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from box_scenes import mesh_of

from toponav.envs.simulator.opengl.cells import FaceCells
from toponav.envs.simulator.rasterizer import NO_FACE, Rasterizer
from toponav.geometry import Intrinsics, Pose

CAMERA = Intrinsics(81, 47, 40.0, 55.0, 20.0, 30.0)


def soup(rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Small and large triangles all over a hall."""
    size = rng.choice([0.2, 1.0, 8.0], (400, 1, 1))
    corners = rng.uniform(-12.0, 12.0, (400, 1, 3)) + size * rng.uniform(-1.0, 1.0, (400, 3, 3))
    return corners.reshape(-1, 3), np.arange(1200, dtype=np.int32).reshape(-1, 3)


@pytest.mark.parametrize("seed", range(10))
def test_every_face_that_is_seen_is_in_a_cell_in_view(seed: int) -> None:
    rng = np.random.default_rng(seed)
    vertices, faces = soup(rng)
    cells = FaceCells(vertices, faces)
    pose = Pose.from_quaternion(rng.standard_normal(4), rng.uniform(-9.0, 9.0, 3))
    seen = np.unique(Rasterizer(mesh_of(vertices, faces)).visible_faces(pose, CAMERA))
    in_view = cells.in_view(pose, CAMERA)
    drawn = np.concatenate([cells.order[cells.start[c] : cells.start[c + 1]] for c in in_view])
    assert set(seen[seen != NO_FACE]) <= set(drawn)
    assert len(drawn) < 0.8 * len(faces)
    assert len(np.unique(in_view)) == len(in_view)


def test_cells_hold_every_face_once() -> None:
    vertices, faces = soup(np.random.default_rng(0))
    cells = FaceCells(vertices, faces)
    assert sorted(cells.order) == list(range(len(faces)))
    assert cells.start[0] == 0
    assert cells.start[-1] == len(faces)
    assert (np.diff(cells.start) > 0).all()


def test_backs_are_hidden_from_outside_of_solids_only() -> None:
    box = trimesh.creation.box((2.0, 2.0, 2.0))
    vertices = np.concatenate([box.vertices, box.vertices + 9.0])
    faces = np.concatenate([box.faces, box.faces[1:] + 8]).astype(np.int32)  # the second is open
    cells = FaceCells(vertices, faces)
    closed = cells.order[cells.start[:-1]] < len(box.faces)
    assert not closed.all()
    for eye, hidden in [((3.0, 0.0, 0.0), True), ((0.9, 0.0, 0.0), False), ((1.01, 0, 0), False)]:
        assert (cells.backs_hidden(np.array(eye)) == (closed & hidden)).all()


def test_near_cells_come_first() -> None:
    def wall(x: float) -> list[tuple[float, float, float]]:
        return [(x, 0.5, 0.1), (x, 0.1, 0.1), (x, 0.1, 0.5)]

    vertices = np.array(wall(9.0) + wall(3.0) + wall(6.0) + wall(-3.0))
    cells = FaceCells(vertices, np.arange(12, dtype=np.int32).reshape(-1, 3))
    forward = Pose.from_rotation(
        np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]]), (0.0, 0.0, 0.0)
    )
    first = [int(cells.order[cells.start[c]]) for c in cells.in_view(forward, CAMERA)]
    assert first == [1, 2, 0]
