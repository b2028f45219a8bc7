"""From the package's values to arrays that a viewer draws."""

from __future__ import annotations

import io
import zlib
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from toponav.categories import readable
from toponav.mapping.view import DROP, FREE, OCCUPIED, UNKNOWN, OccupancyGrid
from toponav.memory.snapshot import UNKNOWN_ROOM, NodeView
from toponav.policy.decision import Decision

MILLIMETRES = 1000.0
GRID_COLORS = {FREE: (205, 214, 222), OCCUPIED: (60, 70, 80), DROP: (200, 120, 60)}
PALETTE = (
    (0, 114, 178), (230, 159, 0), (0, 158, 115), (204, 121, 167), (86, 180, 233), (213, 94, 0),
    (150, 140, 30), (120, 94, 240),
)  # fmt: skip
"""Okabe and Ito's, without black and with a darker yellow."""


def category_color(category: str) -> tuple[int, int, int]:
    """The same colour for the same name, in every run."""
    return PALETTE[zlib.crc32(category.encode()) % len(PALETTE)]


def path_name(label: str) -> str:
    """A free-text label as one part of an entity path: letters, digits, `_` and `-` only."""
    name = "".join(c if c.isascii() and (c.isalnum() or c in "_-") else "_" for c in label)
    return name or "_"


def thin(count: int, most: int) -> slice:
    """Every n-th of `count` rows, so that at most `most` are left."""
    return slice(None, None, max(-(-count // most), 1))


def depth_png(depth: NDArray[np.float32], step: int) -> bytes:
    """A depth image in metres, every `step`-th pixel, as a 16-bit PNG in millimetres."""
    scaled = np.round(depth[::step, ::step] * MILLIMETRES).clip(0, np.iinfo(np.uint16).max)
    buffer = io.BytesIO()
    Image.fromarray(scaled.astype(np.uint16)).save(buffer, "png")
    return buffer.getvalue()


def grid_cells(grid: OccupancyGrid, height: float) -> tuple[NDArray[np.float64], NDArray[np.uint8]]:
    """(N, 3) centres of the known cells, metres, and their (N, 3) colours."""
    known = np.argwhere(grid.cells != UNKNOWN)
    values = grid.cells[tuple(known.T)]
    colors = np.zeros((len(known), 3), np.uint8)
    for value, color in GRID_COLORS.items():
        colors[values == value] = color
    return at_height(grid.center_of(known), height), colors


def at_height(xy: NDArray[np.floating], height: float) -> NDArray[np.float64]:
    """(N, 3) points over (N, 2) places."""
    xy = np.asarray(xy, np.float64).reshape(-1, 2)
    return np.column_stack([xy, np.full(len(xy), height)])


def heat(values: NDArray[np.floating]) -> NDArray[np.uint8]:
    """(N, 3) colours of (N,) values, dark blue at the least and yellow at the largest."""
    low, high = (values.min(), values.max()) if len(values) else (0.0, 1.0)
    share = ((values - low) / max(high - low, 1e-9))[:, None]
    cold, middle, hot = np.array([[40, 30, 110]]), np.array([[200, 60, 110]]), [[250, 225, 80]]
    first = cold + (middle - cold) * (2.0 * share).clip(0, 1)
    colors: NDArray[np.uint8] = (first + (hot - middle) * (2.0 * share - 1.0).clip(0, 1)).astype(
        np.uint8
    )
    return colors


def node_label(node: NodeView) -> str:
    """Number, room, objects and frontiers of a node, in one line."""
    room = "" if node.room_type == UNKNOWN_ROOM else f" {readable(node.room_type)}"
    objects = ", ".join(readable(name) for name in node.objects[:4])
    more = f" [{objects}]" if objects else ""
    frontiers = f" f={node.frontier_count}" if node.frontier_count else ""
    return f"{node.id}{room}{more}{frontiers}"


def answer_text(decision: Decision, target: str) -> str:
    """What the reasoner said and what came of it, as plain text."""
    lines: list[str] = [f"decision {decision.index} at step {decision.step}"]
    lines.append(f"searching for: {readable(target)}; phase: {decision.phase.value}")
    guidance = decision.guidance
    if guidance is not None:
        lines += [
            f"room: {readable(guidance.room_type)}",
            f"next: node {guidance.node_id}, view {guidance.direction}",
            f"target found: {'yes' if guidance.target_found else 'no'}",
            f"why: {guidance.reason}",
        ]
    lines.append(f"waypoint: {_place(decision.waypoint)}")
    return "\n".join(lines)


def _place(waypoint: NDArray[np.float64] | Sequence[float] | None) -> str:
    if waypoint is None:
        return "none left"
    return "({:.2f}, {:.2f}) m".format(*waypoint[:2])
