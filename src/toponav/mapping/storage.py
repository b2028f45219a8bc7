"""Arrays that grow: taken from the system page by page, and given back when they are replaced.

What the allocator hands out for arrays of some megabytes stays with the process when they are
freed, in pieces between which nothing larger fits: of a map that has grown through twenty sizes a
third as much again would be left behind.
"""

from __future__ import annotations

import mmap
from typing import Any, TypeVar

import numpy as np
from numpy.typing import DTypeLike, NDArray

Scalar = TypeVar("Scalar", bound=np.generic)

MAPPED_BYTES = 1 << 20
"""Smaller arrays are left to the allocator."""

LARGE_BYTES = 8 << 20
"""From here on large pages are asked for: voxels are looked up all over them, and of small pages
the processor would not find most in its list. One large page at the end may be partly unused."""


def zeros(length: int, dtype: DTypeLike) -> NDArray[Any]:
    """(length,) zeros; pages count once they are written to."""
    kind = np.dtype(dtype)
    size = length * kind.itemsize
    if size < MAPPED_BYTES or not hasattr(mmap, "MAP_PRIVATE"):  # there are systems without
        return np.zeros(length, kind)
    pages = mmap.mmap(-1, size, flags=mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS)
    if size >= LARGE_BYTES and hasattr(mmap, "MADV_HUGEPAGE"):
        pages.madvise(mmap.MADV_HUGEPAGE)
    return np.frombuffer(pages, kind)


def filled(length: int, value: Scalar) -> NDArray[Scalar]:
    """(length,) of one value."""
    array: NDArray[Scalar] = zeros(length, value.dtype)
    array[:] = value
    return array


def lengthened(array: NDArray[Scalar], length: int) -> NDArray[Scalar]:
    """A copy of a (N,) array with room for more, which is zeros."""
    longer: NDArray[Scalar] = zeros(length, array.dtype)
    # Byte by byte: NumPy would copy records field by field.
    longer.view(np.uint8)[: array.nbytes] = array.view(np.uint8)
    return longer
