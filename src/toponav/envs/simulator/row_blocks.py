"""The rows of an image shared out over threads; no pixel depends on who computes it."""

from __future__ import annotations

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import cache

import numpy as np
from numpy.typing import NDArray

RowsOfFaces = Callable[[int, int], NDArray[np.int32]]
"""(N, W) triangles that a camera sees in rows `first` to `first + N - 1`, -1 for none. Threads may
ask at the same time."""

BLOCK_ROWS = 30
"""Small enough that a busy core delays the others by no more than a block."""


def for_row_blocks(height: int, work: Callable[[int, int], None], threads: int) -> None:
    """Call work(first, end) for blocks of rows that make up an image.

    Args:
        height: Rows of the image.
        work: Computes rows `first` to `end - 1`; must release the GIL to gain anything.
        threads: How many blocks are computed at a time.
    """
    if threads == 1:
        work(0, height)
        return
    blocks = [(first, min(first + BLOCK_ROWS, height)) for first in range(0, height, BLOCK_ROWS)]
    for _ in _pool(threads, os.getpid()).map(lambda rows: work(*rows), blocks):
        pass


@cache
def _pool(threads: int, process: int) -> ThreadPoolExecutor:
    """The threads of this process: a forked child has none of its parent's."""
    return ThreadPoolExecutor(threads, thread_name_prefix=f"rows-{process}")
