"""How much memory a map takes: a process that does nothing else, and frames from another one.

Run as a module, this is that process: it imports the map and nothing above it.
"""

from __future__ import annotations

import json
import multiprocessing
import os
import subprocess
import sys
from collections.abc import Iterator
from multiprocessing.connection import Connection
from typing import Any

import numpy as np

from toponav.errors import TopoNavError
from toponav.evaluation.process_memory import resident_mb
from toponav.mapping.semantic_map import MapConfig, SemanticMap
from toponav.mapping.view import FREE
from toponav.types import Detections, Observation

Frames = Iterator[tuple[Observation, Detections]]


def bench_memory(
    config: MapConfig, area_m2: float, size: tuple[int, int], still_frames: int
) -> dict[str, Any]:
    """Map a whole tour in a process of its own, and then stand still at its end.

    Args:
        config: Of the map.
        area_m2: Area of the tour's building.
        size: Width and height of the images.
        still_frames: Frames integrated at the last stop, over and over.

    Returns:
        `mapped_m2` of navigable floor; `map_mb` that the arrays hold, `map_bytes_per_m2` of it a
        square metre of the building; `voxels`; `rss_mb` of the process, in which neither simulator
        nor planner ever was, when all was mapped, `rss_before_mb` when nothing was yet, and
        `rss_growth_mb` from the first round of standing still to its end (NaN where the system does
        not tell); `cores` (of the machine); the arguments.

    Raises:
        TopoNavError: The process died.
    """
    request = {
        "config": config.model_dump(mode="json"),
        "area_m2": area_m2,
        "size": size,
        "still_frames": still_frames,
    }
    command = [sys.executable, "-m", "toponav.evaluation.bench_memory", json.dumps(request)]
    done = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=False)
    if done.returncode:
        raise TopoNavError("the process that maps the tour has died")
    figures: dict[str, Any] = json.loads(done.stdout)
    return figures


def _measure(
    config: MapConfig, area_m2: float, size: tuple[int, int], still_frames: int
) -> dict[str, Any]:
    """What `bench_memory` returns, of this process."""
    semantic_map = SemanticMap(config)
    rss_before_mb = resident_mb()
    connection = _renderer(area_m2, size)
    for frame in _received(connection):
        semantic_map.integrate(*frame)
    del frame
    grid = semantic_map.view().grid
    mapped_m2 = float(np.count_nonzero(grid.cells == FREE) * grid.resolution**2)
    rss_mb, map_bytes = resident_mb(), semantic_map.nbytes
    still = list(_received(connection))
    for k in range(still_frames):
        if k == len(still):
            rss_first_mb = resident_mb()
        semantic_map.integrate(*still[k % len(still)])
        semantic_map.view()
    return {
        "area_m2": area_m2,
        "mapped_m2": mapped_m2,
        "voxels": len(semantic_map.parts().scene),
        "map_mb": map_bytes / 1e6,
        "map_bytes_per_m2": map_bytes / area_m2,
        "rss_before_mb": rss_before_mb,
        "rss_mb": rss_mb,
        "still_frames": still_frames,
        "rss_growth_mb": resident_mb() - rss_first_mb if still_frames > len(still) else 0.0,
        "size": list(size),
        "cores": os.cpu_count(),
    }


def _renderer(area_m2: float, size: tuple[int, int]) -> Connection:
    """Start another process, and take what it renders."""
    context = multiprocessing.get_context("spawn")
    receiver, sender = context.Pipe(duplex=False)
    renderer = context.Process(target=_send_tour, args=(sender, area_m2, size), daemon=True)
    renderer.start()
    sender.close()
    return receiver


def _received(connection: Connection) -> Frames:
    """What comes until there is a None."""
    try:
        while (frame := connection.recv()) is not None:
            yield frame
    except EOFError:
        raise TopoNavError("the process that renders the tour has died") from None


def _send_tour(sender: Connection, area_m2: float, size: tuple[int, int]) -> None:
    """In the other process: send every frame and None, then the last panorama again and None."""
    # The simulator is loaded here alone; plain tuples, since reading a class loads where it is.
    from toponav.evaluation.bench_tour import Tour

    tour = Tour(area_m2, *size)
    for frame in tour:
        sender.send(tuple(frame))
    sender.send(None)
    for frame in tour.panorama(tour.stops - 1):
        sender.send(tuple(frame))
    sender.send(None)


if __name__ == "__main__":
    asked = json.loads(sys.argv[1])
    asked["config"] = MapConfig(**asked["config"])
    json.dump(_measure(**asked), sys.stdout)
