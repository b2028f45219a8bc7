"""Solids among faces: closed, turned outward, and nothing else."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from toponav.envs.simulator.opengl.solids import OPEN, find_solids

BOX = trimesh.creation.box((1.0, 2.0, 3.0))
CORNERS, FACES = np.array(BOX.vertices), np.array(BOX.faces, np.int32)


def test_a_box_is_a_solid_with_its_bounds() -> None:
    solids = find_solids(CORNERS + 5.0, FACES)
    assert (solids.of_face == 0).all()
    np.testing.assert_allclose(solids.low, [[4.5, 4.0, 3.5]])
    np.testing.assert_allclose(solids.high, [[5.5, 6.0, 6.5]])


def test_corners_at_the_same_place_join_faces() -> None:
    apart = CORNERS[FACES].reshape(-1, 3)
    solids = find_solids(apart, np.arange(36, dtype=np.int32).reshape(-1, 3))
    assert (solids.of_face == 0).all()


@pytest.mark.parametrize(
    "faces",
    [
        FACES[1:],  # a hole
        FACES[:, ::-1],  # inside out
        np.concatenate([FACES[:1, ::-1], FACES[1:]]),  # one face turned round
        np.concatenate([FACES[:1], FACES]),  # one twice
    ],
)
def test_what_is_not_closed_or_not_turned_outward_is_open(faces: np.ndarray) -> None:
    assert (find_solids(CORNERS, faces).of_face == OPEN).all()


def test_a_face_without_area_opens_nothing() -> None:
    faces = np.concatenate([FACES, np.array([[0, 0, 1]], np.int32)])
    assert (find_solids(CORNERS, faces).of_face == 0).all()


def test_several_parts_are_judged_one_by_one() -> None:
    vertices = np.concatenate([CORNERS, CORNERS + 9.0, CORNERS - 9.0])
    faces = np.concatenate([FACES, FACES[1:] + 8, FACES + 16])
    solids = find_solids(vertices, faces)
    first, second = solids.of_face[0], solids.of_face[-1]
    assert solids.of_face.tolist() == [first] * 12 + [OPEN] * 11 + [second] * 12
    assert solids.low[[first, second], 0].tolist() == [-0.5, -9.5]
