"""A scene's corners, each handed over once for many faces.

A face's look reaches its pixels from its last corner alone, OpenGL's provoking vertex. Faces share
a corner where they meet, but it can be the last one only of faces that look the same: faces are
turned to end with a corner that is free or has their look, or get one of their own.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

NONE = -1


class SharedCorners(NamedTuple):
    """C corners of F faces.

    Attributes:
        of_face: (F, 3) int32 corners of the faces, in the order of drawing; the last has the look.
        origin: (C,) int32 3 f + k where corner k of face f has the place of this one.
        face: (C,) int32 a face whose look the corner has; NONE if it has none.
    """

    of_face: NDArray[np.int32]
    origin: NDArray[np.int32]
    face: NDArray[np.int32]


def share_corners(
    place: NDArray[np.int64], look: NDArray[np.int64], order: NDArray[np.int64]
) -> SharedCorners:
    """Find corners that serve all faces, numbered as they are first needed.

    Args:
        place: (F, 3) numbers of where corners are and what else is theirs.
        look: (F,) numbers of how faces look.
        order: (F,) faces in the order of drawing.
    """
    most = place.size
    shared = SharedCorners(
        np.empty(place.shape, np.int32), np.empty(most, np.int32), np.full(most, NONE, np.int32)
    )
    head = np.full(place.max() + 1, NONE, np.int32)
    count = _share(place, look, order, (head, np.empty(most, np.int32)), shared)
    return SharedCorners(shared.of_face, shared.origin[:count], shared.face[:count])


@njit(cache=True)
def _share(
    place: NDArray[np.int64],
    look: NDArray[np.int64],
    order: NDArray[np.int64],
    chains: tuple[NDArray[np.int32], NDArray[np.int32]],
    shared: SharedCorners,
) -> int:
    """Fill in `shared`; the corners at a place are a chain from its head on. Returns how many."""
    head, following = chains
    count = 0
    for drawn, f in enumerate(order):
        own, last, fits = NONE, 2, False
        for k in range(3):
            c = head[place[f, k]]
            while c != NONE and not fits:
                face = shared.face[c]
                fits = face != NONE and look[face] == look[f]
                if fits or (own == NONE and face == NONE):
                    own, last = c, k
                c = following[c]
        for k in range(3):
            at = place[f, k]
            c = own if k == last else head[at]
            if c == NONE:
                c = count
                shared.origin[c] = 3 * f + k
                following[c], head[at] = head[at], c
                count += 1
            shared.of_face[drawn, (k - last + 2) % 3] = c
        shared.face[shared.of_face[drawn, 2]] = f
    return count
