"""Draws the figures of docs/concepts.md from a run: map, graph, panorama, affordances."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from PIL import Image

from toponav import HouseEnvConfig, load_scene
from toponav.evaluation.run_config import run_config
from toponav.evaluation.runner import SceneRunner
from toponav.policy.decision import Decision
from toponav.viz.panorama import save_panorama
from toponav.viz.stills import StillCamera
from toponav.viz.topdown import save_topdown

IMAGES = Path(__file__).parent / "images"
SCENE = "generated:6"
DECISION = 1
GRID_COLORS = ListedColormap(["#c87838", "#4a5560", "#ffffff", "#dfe5ea"])
"""Of the values -2 to 1: drop, obstacle, unknown, free."""

TITLE_PT, POINT = 15, 3.0
"""Type and dots that are still seen when the page is as narrow as a telephone."""


def draw() -> None:
    """Run one episode with the paper's preset and draw its second decision."""
    config = run_config("paper", env=HouseEnvConfig(width=320, height=240))
    runner = SceneRunner(load_scene(SCENE), config)
    spec = runner.episode(0)
    camera = StillCamera()
    runner.run(spec, (camera,), (camera,))
    IMAGES.mkdir(exist_ok=True)
    decision = camera.decisions[DECISION]
    _draw_layers(decision)
    target = spec.episode.target
    save_panorama(decision.panorama, decision.guidance, target, IMAGES / "panorama.jpg")
    _draw_affordances(decision)
    graph = camera.at(len(camera.decisions) - 1, target, SCENE)
    save_topdown(graph, IMAGES / "concept_graph.png", dpi=100)


def _draw_layers(decision: Decision) -> None:
    view = decision.map_view
    objects = {name: cloud for name, cloud in view.objects.items() if name not in STRUCTURE}
    panels = (
        ("M_scene", [(view.scene.points, view.scene.colors / 255.0)]),
        ("M_obj, by category", [(c.points, f"C{k % 10}") for k, c in enumerate(objects.values())]),
        (
            "M_nav and M_obs",
            [(view.navigable.points, "#8fbc8f"), (view.obstacles.points, "#4a5560")],
        ),
    )  # fmt: skip
    figure, axes = _page(2, 2)
    for axis, (title, clouds) in zip(axes, panels, strict=False):
        axis.set_title(title, fontsize=TITLE_PT)
        for points, colors in clouds:
            low = points[:, 2] < view.floor_z + 2.0
            order = np.argsort(points[low, 2])
            shade = colors if isinstance(colors, str) else colors[low][order]
            axis.scatter(*points[low][order, :2].T, s=POINT, c=shade, lw=0)
    grid = view.grid
    x, y = grid.origin
    side = np.array(grid.cells.shape) * grid.resolution
    axes[3].set_title("G and M_fro", fontsize=TITLE_PT)
    axes[3].imshow(
        grid.cells.T, origin="lower", extent=(x, x + side[0], y, y + side[1]), cmap=GRID_COLORS,
        vmin=-2, vmax=1,
    )  # fmt: skip
    axes[3].scatter(*view.frontiers[:, :2].T, s=10, c="#f08c00", lw=0)
    _save(figure, "concept_layers.png")


def _draw_affordances(decision: Decision) -> None:
    affordances = decision.affordances
    if affordances is None or decision.waypoint is None:
        raise SystemExit("this decision was made without affordances: choose another one")
    terms = {f"A_{name}": term for name, term in affordances.terms.items()}
    terms["safe: far from M_obs"] = affordances.safe.astype(np.float64)
    terms["A: the sum, where safe"] = affordances.total
    figure, axes = _page(2, 3)
    for axis, (title, values) in zip(axes, terms.items(), strict=True):
        axis.set_title(title, fontsize=TITLE_PT)
        axis.scatter(*affordances.points[:, :2].T, s=POINT, c=values, cmap="viridis", lw=0)
        axis.plot(*decision.waypoint[:2], marker="X", ms=11, color="#e03131", mec="white")
    _save(figure, "concept_affordances.png")


def _page(rows: int, columns: int) -> tuple[Figure, list]:
    figure = Figure(figsize=(10.0, 10.0 * rows / columns * 0.86), layout="constrained")
    FigureCanvasAgg(figure)
    axes = list(figure.subplots(rows, columns, sharex=True, sharey=True).flat)
    for axis in axes:
        axis.set_aspect("equal")
        axis.axis("off")
    return figure, axes


def _save(figure: Figure, name: str) -> None:
    """A PNG of 256 colours: a third of the bytes."""
    buffer = io.BytesIO()
    figure.savefig(buffer, dpi=100)
    image = Image.open(buffer).convert("RGB")
    image.quantize(256).save(IMAGES / name, optimize=True)


STRUCTURE = {"wall", "floor", "ceiling", "door", "window", "stairs"}

if __name__ == "__main__":
    draw()
