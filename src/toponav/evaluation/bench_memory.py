"""How much memory a map takes: a process that does nothing else, and frames from another one."""

from __future__ import annotations

import multiprocessing
from collections.abc import Iterator
from multiprocessing.connection import Connection
from typing import Any

import numpy as np

from toponav.errors import TopoNavError
from toponav.evaluation.bench_tour import VIEWS, Tour, TourFrame
from toponav.evaluation.process_memory import resident_mb
from toponav.mapping.semantic_map import MapConfig, SemanticMap
from toponav.mapping.view import FREE


def bench_memory(
    config: MapConfig, area_m2: float, size: tuple[int, int], still_frames: int
) -> dict[str, Any]:
    """Map a whole tour, and then stand still at its end.

    Args:
        config: Of the map.
        area_m2: Area of the tour's building.
        size: Width and height of the images.
        still_frames: Frames integrated at the last stop, over and over.

    Returns:
        `mapped_m2` of navigable floor; `map_mb` that the arrays hold, `map_bytes_per_m2` of it a
        square metre of the building; `rss_mb` of this process, in which no simulator ever was,
        when all was mapped, and `rss_growth_mb` from then to the end of standing still (NaN where
        the system does not tell); the arguments.

    Raises:
        TopoNavError: The other process died.
    """
    semantic_map = SemanticMap(config)
    last: list[TourFrame] = []
    for frame in _frames_from_elsewhere(area_m2, size):
        semantic_map.integrate(*frame)
        last = [*last, frame][-VIEWS:]
    grid = semantic_map.view().grid
    mapped_m2 = float(np.count_nonzero(grid.cells == FREE) * grid.resolution**2)
    rss_mb, map_bytes = resident_mb(), semantic_map.nbytes
    for k in range(still_frames):
        semantic_map.integrate(*last[k % VIEWS])
        semantic_map.view()
    return {
        "area_m2": area_m2,
        "mapped_m2": mapped_m2,
        "map_mb": map_bytes / 1e6,
        "map_bytes_per_m2": map_bytes / area_m2,
        "rss_mb": rss_mb,
        "still_frames": still_frames,
        "rss_growth_mb": resident_mb() - rss_mb,
        "size": list(size),
    }


def _frames_from_elsewhere(area_m2: float, size: tuple[int, int]) -> Iterator[TourFrame]:
    """A tour's frames, rendered by another process."""
    context = multiprocessing.get_context("spawn")
    receiver, sender = context.Pipe(duplex=False)
    renderer = context.Process(target=_send_tour, args=(sender, area_m2, size), daemon=True)
    renderer.start()
    sender.close()
    try:
        while (frame := receiver.recv()) is not None:
            yield frame
    except EOFError:
        raise TopoNavError("the process that renders the tour has died") from None
    renderer.join()


def _send_tour(sender: Connection, area_m2: float, size: tuple[int, int]) -> None:
    """In the other process: render and send every frame, then None."""
    for frame in Tour(area_m2, *size):
        sender.send(frame)
    sender.send(None)
