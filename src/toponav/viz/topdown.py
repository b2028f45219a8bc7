"""The top-down picture: map, path, topological memory, frontiers and the target."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.patheffects import withStroke
from numpy.typing import NDArray

from toponav.categories import readable
from toponav.files import temporary_beside
from toponav.mapping.view import FREE, OCCUPIED, UNKNOWN, MapView
from toponav.memory.graph import TopologicalMemory
from toponav.memory.snapshot import UNKNOWN_ROOM
from toponav.viz.labels import landmarks, on_this_floor, place_labels

BACKGROUND = "#ffffff"
FREE_COLOR = "#e4e9ee"
OBSTACLE_COLOR = "#4a5560"
FRONTIER_COLOR = "#f08c00"
PATH_COLOR = "#1971c2"
NODE_COLOR = "#2f9e44"
TARGET_COLOR = "#e03131"
INK = "#212529"
MARGIN_M = 0.4
"""White border around what has been mapped."""
MAX_SIDE_INCHES = 11.0
INCHES_PER_METRE = 0.8
POINT_M = 0.06
"""A mapped point is drawn as a square of this size: a voxel and a little more: none gape."""
NODE_LABEL_M = (0.085, 0.26)
"""Width of a character and height of a line of a node's label on the map."""
NODE_GAP_M = 0.12


@dataclass(frozen=True, eq=False)
class TopDownPicture:
    """What to draw; what is empty is left out.

    Attributes:
        map_view: The map of one floor.
        trajectory: (T, 3) positions of the agent, world frame, metres.
        memory: Nodes and edges, or None.
        target: Category searched for; its cloud is drawn, and named in the title.
        title: One line above the picture.
        subtitle: A smaller line below it.
        waypoint: (2,) or (3,) current waypoint, or None.
        plan: (K, 2) planned path.
    """

    map_view: MapView
    trajectory: NDArray[np.float64]
    memory: TopologicalMemory | None = None
    target: str = ""
    title: str = ""
    subtitle: str = ""
    waypoint: NDArray[np.float64] | None = None
    plan: NDArray[np.float64] | None = None


def save_topdown(picture: TopDownPicture, path: Path, dpi: int = 110) -> None:
    """Draw to a PNG, SVG or PDF file, told by its ending; a reader never sees half a file."""
    figure = draw_topdown(picture)
    temporary = temporary_beside(path)
    figure.savefig(temporary, dpi=dpi, facecolor=BACKGROUND)
    temporary.replace(path)


def draw_topdown(picture: TopDownPicture) -> Figure:
    """The figure, x to the right and y up, in metres."""
    grid = picture.map_view.grid
    low, high = _extent(picture)
    scale = min(INCHES_PER_METRE, MAX_SIDE_INCHES / float((high - low).max()))
    size = (high - low) * scale
    figure = Figure(figsize=(max(size[0], 6.5), max(size[1], 3.5) + 1.1), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.add_subplot()
    _draw_grid(axes, grid.cells, grid.origin, grid.resolution)
    _draw_objects(axes, picture, POINT_M * scale)
    handles = _draw_search(axes, picture)
    if picture.memory is not None:
        _draw_memory(axes, picture, INCHES_PER_METRE / scale)
    axes.set_xlim(low[0], high[0])
    axes.set_ylim(low[1], high[1])
    axes.set_aspect("equal")
    axes.set_xlabel("x [m]", fontsize=8)
    axes.set_ylabel("y [m]", fontsize=8)
    axes.tick_params(labelsize=7, color="#adb5bd")
    axes.spines[:].set_visible(False)
    figure.suptitle(picture.title, fontsize=13, fontweight="bold", color=INK, wrap=True)
    axes.set_title(picture.subtitle, fontsize=9, color=INK, wrap=True)
    figure.legend(handles=handles, loc="outside lower center", ncols=4, fontsize=8, frameon=False)
    return figure


def _extent(picture: TopDownPicture) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Lower and upper corner (x, y) of everything known, with a margin."""
    grid = picture.map_view.grid
    known = np.argwhere(grid.cells != UNKNOWN)
    points = [grid.center_of(known)] if len(known) else []
    if len(picture.trajectory):
        points.append(picture.trajectory[:, :2])
    if not points:
        return np.array([-2.0, -2.0]), np.array([2.0, 2.0])
    stacked = np.concatenate(points)
    return stacked.min(axis=0) - MARGIN_M, stacked.max(axis=0) + MARGIN_M


def _draw_grid(
    axes: Axes, cells: NDArray[np.int8], origin: tuple[float, float], resolution: float
) -> None:
    index = np.zeros(cells.shape, dtype=np.int8)
    index[cells == FREE] = 1
    index[cells == OCCUPIED] = 2
    x, y = origin
    extent = (x, x + cells.shape[0] * resolution, y, y + cells.shape[1] * resolution)
    colors = ListedColormap([BACKGROUND, FREE_COLOR, OBSTACLE_COLOR])
    axes.imshow(
        index.T, origin="lower", extent=extent, cmap=colors, vmin=0, vmax=2,
        interpolation="nearest",
    )  # fmt: skip


def _draw_objects(axes: Axes, picture: TopDownPicture, point_inches: float) -> None:
    """The mapped objects in their own mean colour, the target on top, red; large ones named."""
    view = picture.map_view
    area = (72.0 * point_inches) ** 2  # Matplotlib's markers: square points, 72 to the inch
    for category in sorted(view.objects, key=lambda name: (name == picture.target, name)):
        cloud = view.objects[category]
        here = on_this_floor(cloud.points, view)
        here &= np.isfinite(cloud.points).all(axis=1)
        order = np.flatnonzero(here)[np.argsort(cloud.points[here, 2], kind="stable")]
        colors = TARGET_COLOR if category == picture.target else cloud.colors[order] / 255.0
        x, y = cloud.points[order, 0], cloud.points[order, 1]
        axes.scatter(x, y, s=area, c=colors, marker="s", lw=0)
    for category, center in landmarks(view):
        axes.annotate(
            readable(category), tuple(center), ha="center", va="center", fontsize=6.5, color=INK,
            style="italic", path_effects=[withStroke(linewidth=2.2, foreground="white")], zorder=3,
        )  # fmt: skip


def _draw_search(axes: Axes, picture: TopDownPicture) -> list[Line2D | Patch]:
    """Frontiers, the path walked, the plan and the waypoint; returns the legend's entries."""
    frontiers = picture.map_view.frontiers
    axes.scatter(frontiers[:, 0], frontiers[:, 1], s=9, c=FRONTIER_COLOR, marker="s", lw=0)
    handles: list[Line2D | Patch] = [
        Patch(color=FREE_COLOR, label="free"),
        Patch(color=OBSTACLE_COLOR, label="obstacle"),
        Patch(color=FRONTIER_COLOR, label="frontier"),
    ]
    path = picture.trajectory
    if len(path):
        axes.plot(path[:, 0], path[:, 1], color=PATH_COLOR, lw=1.6, alpha=0.9)
        axes.plot(*path[0, :2], marker="o", ms=7, mfc="white", mec=PATH_COLOR, mew=1.8)
        axes.plot(*path[-1, :2], marker="o", ms=7, color=PATH_COLOR)
        handles.append(Line2D([], [], color=PATH_COLOR, label="path (start: ring, end: dot)"))
    if picture.plan is not None and len(picture.plan):
        axes.plot(picture.plan[:, 0], picture.plan[:, 1], color=PATH_COLOR, lw=1.0, ls=":")
    if picture.waypoint is not None:
        axes.plot(*picture.waypoint[:2], marker="X", ms=9, color="#ae3ec9", mec="white")
        handles.append(
            Line2D([], [], marker="X", ls="", color="#ae3ec9", label="waypoint p_target")
        )
    if picture.target:
        handles.append(Patch(color=TARGET_COLOR, label=f"target: {readable(picture.target)}"))
    if picture.memory is not None:
        handles.append(
            Line2D([], [], marker="o", color=NODE_COLOR, label="memory: node, room, frontiers f")
        )
    return handles


def _draw_memory(axes: Axes, picture: TopDownPicture, metres_per_label: float) -> None:
    """Nodes of the drawn floor with id, room and frontier count, and the edges between them."""
    memory, floor = picture.memory, picture.map_view.floor
    assert memory is not None
    here = {node.id: node for node in memory.nodes if node.floor == floor}
    for edge in memory.edges:
        if edge.source in here and edge.target in here:
            ends = np.array([here[edge.source].position, here[edge.target].position])
            axes.plot(ends[:, 0], ends[:, 1], color=NODE_COLOR, lw=1.3, alpha=0.8)
    labels = {}
    for node in here.values():
        current = memory.history[-1:] == (node.id,)
        axes.plot(
            *node.position, marker="o", ms=13, color=NODE_COLOR,
            mec="black" if current else "white", mew=1.5, zorder=4,
        )  # fmt: skip
        axes.annotate(
            str(node.id), node.position, ha="center", va="center", color="white", fontsize=8,
            zorder=5,
        )  # fmt: skip
        room = "" if node.room_type == UNKNOWN_ROOM else readable(node.room_type)
        label = f"{room} f={node.frontier_count}" if node.frontier_count else room
        if label.strip():
            labels[node.id] = label.strip()
    anchors = np.array([here[k].position for k in labels]).reshape(-1, 2)
    width, height = (side * metres_per_label for side in NODE_LABEL_M)
    sizes = [(width * len(label), height) for label in labels.values()]
    nodes = np.array([node.position for node in here.values()]).reshape(-1, 2)
    named = np.array([center for _, center in landmarks(picture.map_view)]).reshape(-1, 2)
    taken = np.concatenate([nodes, named]).repeat(20, axis=0)
    busy = np.concatenate([picture.trajectory[:, :2], taken])
    centers = place_labels(anchors, sizes, busy, NODE_GAP_M * metres_per_label)
    for label, center in zip(labels.values(), centers, strict=True):
        axes.annotate(
            label, center, ha="center", va="center", fontsize=8, color=INK, zorder=5,
            bbox={"boxstyle": "round,pad=0.15", "fc": "white", "ec": NODE_COLOR, "lw": 0.6},
        )  # fmt: skip
