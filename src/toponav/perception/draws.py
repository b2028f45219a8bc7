"""Random draws that depend on what they are about, and not on when they are made.

A generator's draws depend on all draws before. A draw here is a hash of its keys: the same object
from the same side gives the same draw in every frame, in any order, which is what makes simulated
errors as persistent as real ones are.
"""

from __future__ import annotations

import zlib

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import ndtr, ndtri

_GOLDEN = np.uint64(0x9E3779B97F4A7C15)
_MIX = (np.uint64(0xBF58476D1CE4E5B9), np.uint64(0x94D049BB133111EB))
"""Steele, Lea and Flood's SplitMix64 (2014)."""


class Draws:
    """Draws of one seed; `stream` names what is drawn, so that two purposes never share a draw."""

    def __init__(self, seed: int) -> None:
        """Take the seed of the episode."""
        self._seed = np.uint64(seed)

    def uniform(self, stream: str, *keys: ArrayLike) -> NDArray[np.float64]:
        """Uniform draws in (0, 1), of the shape to which the integer keys broadcast."""
        state = np.asarray(_mixed(self._seed ^ np.uint64(key_of(stream))))
        for key in keys:
            bits = np.asarray(key).astype(np.int64).view(np.uint64)
            state = _mixed(state ^ _mixed(bits))
        return ((state >> np.uint64(11)).astype(np.float64) + 0.5) / 2.0**53

    def normal(self, stream: str, *keys: ArrayLike) -> NDArray[np.float64]:
        """Standard normal draws, of the shape to which the integer keys broadcast."""
        return np.asarray(ndtri(self.uniform(stream, *keys)))


def key_of(what: str | bytes) -> int:
    """An integer key for a name or for anything that has bytes."""
    return zlib.crc32(what.encode() if isinstance(what, str) else what)


def blended(shares: tuple[float, ...], normals: tuple[ArrayLike, ...]) -> NDArray[np.float64]:
    """A uniform draw that is made up of several normal ones, each with its share of the variance.

    A Gaussian copula: an event of probability p happens where the result is below p, however the
    shares lie; they only say how much it has in common with other draws.

    Args:
        shares: Of the variance; they add up to 1.
        normals: As many standard normal draws.
    """
    weighted = [np.sqrt(s) * np.asarray(n) for s, n in zip(shares, normals, strict=True)]
    return np.asarray(ndtr(sum(weighted)))


def _mixed(state: NDArray[np.uint64] | np.uint64) -> NDArray[np.uint64]:
    """SplitMix64's output function."""
    with np.errstate(over="ignore"):
        z = np.asarray(state + _GOLDEN)
        z = (z ^ (z >> np.uint64(30))) * _MIX[0]
        z = (z ^ (z >> np.uint64(27))) * _MIX[1]
        return np.asarray(z ^ (z >> np.uint64(31)))
