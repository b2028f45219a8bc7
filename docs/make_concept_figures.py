"""Draws the figures of docs/concepts.md from a run of our own: map layers, graph, affordances."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure

from toponav import HouseEnvConfig, load_scene
from toponav.evaluation.run_config import run_config
from toponav.evaluation.runner import SceneRunner
from toponav.policy.decision import Decision
from toponav.viz.stills import StillCamera
from toponav.viz.topdown import save_topdown

IMAGES = Path(__file__).parent / "images"
SCENE = "generated:6"
DECISION = 1
GRID_COLORS = ListedColormap(["#c87838", "#4a5560", "#ffffff", "#dfe5ea"])
"""Of the values -2 to 1: drop, obstacle, unknown, free."""


def draw() -> None:
    """Run one episode with the paper's preset and keep three figures of its second decision."""
    config = run_config("paper", env=HouseEnvConfig(width=320, height=240))
    runner = SceneRunner(load_scene(SCENE), config)
    spec = runner.episode(0)
    camera = StillCamera()
    runner.run(spec, (camera,), (camera,))
    IMAGES.mkdir(exist_ok=True)
    decision = camera.decisions[DECISION]
    _draw_layers(decision)
    _draw_affordances(decision)
    graph = camera.at(len(camera.decisions) - 1, spec.episode.target, SCENE)
    save_topdown(graph, IMAGES / "concept_graph.png", dpi=80)


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
    figure, axes = _page(4)
    for axis, (title, clouds) in zip(axes, panels, strict=False):
        axis.set_title(title, fontsize=10)
        for points, colors in clouds:
            low = points[:, 2] < view.floor_z + 2.0
            order = np.argsort(points[low, 2])
            shade = colors if isinstance(colors, str) else colors[low][order]
            axis.scatter(*points[low][order, :2].T, s=1.2, c=shade, lw=0)
    grid = view.grid
    x, y = grid.origin
    side = np.array(grid.cells.shape) * grid.resolution
    axes[3].set_title("G and M_fro", fontsize=10)
    axes[3].imshow(
        grid.cells.T, origin="lower", extent=(x, x + side[0], y, y + side[1]), cmap=GRID_COLORS,
        vmin=-2, vmax=1,
    )  # fmt: skip
    axes[3].scatter(*view.frontiers[:, :2].T, s=4, c="#f08c00", lw=0)
    figure.savefig(IMAGES / "concept_layers.png", dpi=90)


def _draw_affordances(decision: Decision) -> None:
    affordances = decision.affordances
    if affordances is None or decision.waypoint is None:
        raise SystemExit("this decision was made without affordances: choose another one")
    terms = {f"A_{name}": term for name, term in affordances.terms.items()}
    terms["A, masked"] = affordances.total
    figure, axes = _page(len(terms))
    for axis, (title, values) in zip(axes, terms.items(), strict=True):
        axis.set_title(title, fontsize=10)
        axis.scatter(*affordances.points[:, :2].T, s=1.2, c=values, cmap="plasma", lw=0)
        axis.plot(*decision.waypoint[:2], marker="X", ms=8, color="#37b24d", mec="white")
    figure.savefig(IMAGES / "concept_affordances.png", dpi=90)


def _page(panels: int) -> tuple[Figure, list]:
    figure = Figure(figsize=(3.2 * panels, 3.4), layout="constrained")
    FigureCanvasAgg(figure)
    axes = list(figure.subplots(1, panels, sharex=True, sharey=True))
    for axis in axes:
        axis.set_aspect("equal")
        axis.axis("off")
    return figure, axes


STRUCTURE = {"wall", "floor", "ceiling", "door", "window", "stairs"}

if __name__ == "__main__":
    draw()
