"""Questions for models: a small memory with three views, and one of 200 places."""

from __future__ import annotations

import math

import numpy as np

from toponav.memory.snapshot import UNKNOWN_ROOM, EdgeView, MemorySnapshot, NodeView
from toponav.memory.text import TextBudget, describe
from toponav.reasoning.base import PanoramaView, Query, SeenObject


def picture(shade: int) -> np.ndarray:
    """A flat image with a darker floor."""
    image = np.full((120, 160, 3), shade, np.uint8)
    image[80:] //= 2
    return image


def view(bearing_deg: float, *seen: SeenObject, frontiers: int = 0) -> PanoramaView:
    shade = 60 + round(bearing_deg) % 180
    return PanoramaView(picture(shade), math.radians(bearing_deg), seen, 3.25, frontiers)


def snapshot(
    nodes: tuple[NodeView, ...], edges: tuple[EdgeView, ...], current: int, history: tuple[int, ...]
) -> MemorySnapshot:
    text = describe(nodes, edges, current, history, TextBudget())
    return MemorySnapshot(nodes, edges, current, history, text)


def small_query(target: str = "tv_monitor", *extra: SeenObject) -> Query:
    """Two places; a sofa and what is asked for by `extra` in sight."""
    nodes = (
        NodeView(1, (0.0, 0.0), 0, ("sofa",), UNKNOWN_ROOM, 12, 1),
        NodeView(2, (3.0, 1.0), 0, ("bed", "nightstand"), "bedroom", 0, 2),
    )
    sofa = SeenObject("sofa", 0.874, 2.31)
    lamp = SeenObject("lamp", 0.5, math.inf)
    views = (view(0.0, sofa, lamp), view(120.0, *extra, frontiers=7), view(240.0))
    memory = snapshot(nodes, (EdgeView(1, 2, 4.0, 3.5),), 1, (2, 1))
    return Query(target, memory, views)


def large_query() -> Query:
    """200 places in a long building, 12 views with a dozen detections each."""
    objects = ("cabinet", "chair", "coffee_table", "picture", "plant", "sofa", "table")
    nodes = tuple(
        NodeView(k, (2.0 * (k % 20), 3.0 * (k // 20)), 0, objects, "living room", k % 7, 1)
        for k in range(1, 201)
    )
    edges = tuple(EdgeView(k, k + 1, 3.0, 2.5) for k in range(1, 200))
    seen = [SeenObject(name, 0.9 - 0.05 * k, 1.0 + k) for k, name in enumerate(objects * 2)]
    views = tuple(view(30.0 * k, *seen, frontiers=k) for k in range(12))
    return Query("toilet", snapshot(nodes, edges, 100, tuple(range(1, 101))), views)
