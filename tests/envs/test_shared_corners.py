"""Corners shared by faces: each face keeps its places, its turn and its look."""

from __future__ import annotations

import numpy as np
import pytest

from toponav.envs.simulator.opengl.numbering import number_rows
from toponav.envs.simulator.opengl.shared_corners import NONE, SharedCorners, share_corners


def turned_to_equal(seen: np.ndarray, face: np.ndarray) -> bool:
    return any((np.roll(seen, turn) == face).all() for turn in range(3))


def shared(place: np.ndarray, look: np.ndarray, order: np.ndarray) -> SharedCorners:
    """Corners that are checked to serve all faces."""
    corners = share_corners(place, look, order)
    assert len(np.unique(corners.of_face)) == len(corners.origin) == len(corners.face)
    for seen, f in zip(corners.of_face, order, strict=True):
        assert turned_to_equal(place.reshape(-1)[corners.origin[seen]], place[f])
        assert look[corners.face[seen[2]]] == look[f]
    return corners


@pytest.mark.parametrize("looks", [1, 5, 200])
def test_every_face_keeps_its_places_its_turn_and_its_look(looks: int) -> None:
    rng = np.random.default_rng(looks)
    place = rng.integers(0, 60, (200, 3))  # some have one place twice
    corners = shared(place, rng.integers(0, looks, 200), rng.permutation(200))
    assert len(corners.origin) < 60 + 200


def test_faces_of_one_look_need_no_more_corners_than_places() -> None:
    fan = np.array([(0, k, k + 1) for k in range(1, 9)])
    corners = shared(fan, np.zeros(8, np.int64), np.arange(8))
    assert len(corners.origin) == 10
    assert (corners.face != NONE).sum() < 8


def test_each_face_of_its_own_look_ends_with_a_corner_of_its_own() -> None:
    fan = np.array([(0, k, k + 1) for k in range(1, 9)])
    corners = shared(fan, np.arange(8), np.arange(8))
    assert len(np.unique(corners.of_face[:, 2])) == 8
    assert len(corners.origin) == 10


def test_equal_rows_have_equal_numbers_in_their_order() -> None:
    rng = np.random.default_rng(0)
    rows = rng.integers(-2, 2, (300, 4)) * 0.5
    _, expected = np.unique(rows, axis=0, return_inverse=True)
    np.testing.assert_array_equal(number_rows(list(rows.T)), expected.reshape(-1))
