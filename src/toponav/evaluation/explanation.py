"""Records what explains each decision, as it is made; it observes and never steers."""

from __future__ import annotations

import io
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from toponav.evaluation.explanation_file import (
    EXPLANATION_FILE,
    CandidateRecord,
    DecisionRecord,
    Explanation,
    FrontierRecord,
    MapRecord,
    NodeRecord,
    PictureRecord,
    TermRecord,
    base64_text,
    runs_of,
    save_explanation,
)
from toponav.mapping.view import FREE, OCCUPIED, MapView
from toponav.memory.graph import TopologicalMemory
from toponav.policy.affordances import Affordances
from toponav.policy.decision import Decision, WeighedFrontier
from toponav.reasoning.base import PanoramaView
from toponav.reasoning.vlm.call_log import CallLog

HEAT_LEVELS = 24
"""Steps of the affordance between nothing and its maximum: finer than an eye tells apart."""

STOREY_M = (-0.3, 2.4)
"""Heights relative to the floor at which an object belongs to its storey."""

CEILING_M = 1.9
"""Points higher than this are left out of the picture: ceilings and lamps hide the room."""

PIXEL_M = 0.05
"""One pixel of the floor's picture: the voxels of the default map."""

VIEW_WIDTH, LONE_VIEW_WIDTH = 224, 400
"""Pixels of a view in a panorama, and of one of the few views of a short look."""

FEW_VIEWS = 3
QUALITY, EFFORT = 70, 2
"""Of WebP: more effort takes twice the time and saves nothing on such small pictures."""

DIGITS = 3
"""Decimals of metres and weights."""


class ExplanationRecorder:
    """A decision listener that writes `explanation.json.gz` when the episode is over."""

    def __init__(self, folder: Path, target: str, log: CallLog | None = None) -> None:
        """Begin an episode.

        Args:
            folder: Gets the file; an earlier episode's is removed.
            target: What is looked for.
            log: The model's exchanges, if a model is asked.
        """
        self._path = folder / EXPLANATION_FILE
        self._path.unlink(missing_ok=True)
        self._target = target
        self._log = log or CallLog()
        self._decisions: list[DecisionRecord] = []

    def on_decision(self, decision: Decision) -> None:
        """Keep one decision, a few kilobytes."""
        view, memory = decision.map_view, decision.memory
        nodes = () if memory is None else memory.nodes
        edges = () if memory is None else memory.edges
        self._decisions.append(
            DecisionRecord(
                index=decision.index,
                floor=view.floor,
                map=_map_record(view, decision.affordances),
                nodes=tuple(NodeRecord(**asdict(node)) for node in nodes),
                edges=tuple((e.source, e.target, _rounded(e.geodesic_m)) for e in edges),
                history=() if memory is None else memory.history,
                frontiers=tuple(map(_frontier_record, decision.frontiers)),
                candidates=tuple(
                    CandidateRecord.model_validate(asdict(one)) for one in decision.candidates
                ),
                terms=_terms_at_waypoint(decision),
                exchanges=len(self._log.exchanges),
                panorama=_strip(decision.panorama),
            )
        )

    def on_close(self, map_view: MapView | None, memory: TopologicalMemory | None) -> None:
        """Write the file, with the last map and a picture of its floor."""
        del memory
        explanation = Explanation(
            target=self._target,
            decisions=tuple(self._decisions),
            end=None if map_view is None else _map_record(map_view, None),
            picture=None if map_view is None else _picture(map_view),
        )
        save_explanation(explanation, self._path)


def _map_record(view: MapView, affordances: Affordances | None) -> MapRecord:
    """The grid with its frontiers, the objects on it and the affordances."""
    grid = view.grid
    cells = np.zeros(grid.cells.shape, np.int64)
    cells[grid.cells == FREE] = 1
    cells[grid.cells == OCCUPIED] = 2
    _mark(cells, view, view.frontiers[:, :2], np.full(len(view.frontiers), 3))
    objects = np.zeros(grid.cells.shape, np.int64)
    categories = []
    for category, cloud in sorted(view.objects.items()):
        height = cloud.points[:, 2] - view.floor_z
        here = cloud.points[(height > STOREY_M[0]) & (height < STOREY_M[1]), :2]
        if len(here):
            categories.append(category)
            _mark(objects, view, here, np.full(len(here), len(categories)))
    return MapRecord(
        origin=(_rounded(grid.origin[0]), _rounded(grid.origin[1])),
        resolution=grid.resolution,
        shape=(grid.cells.shape[0], grid.cells.shape[1]),
        cells=runs_of(cells),
        objects=runs_of(objects),
        categories=tuple(categories),
        heat=None if affordances is None else runs_of(_heat(view, affordances)),
    )


def _heat(view: MapView, affordances: Affordances) -> NDArray[np.int64]:
    """The highest affordance in each cell as 2 to 2 + HEAT_LEVELS; 1 where all is masked."""
    heat = np.zeros(view.grid.cells.shape, np.int64)
    total, highest = affordances.total, float(affordances.total.max(initial=0.0))
    level = np.rint(total / highest * HEAT_LEVELS) if highest > 0.0 else np.zeros(len(total))
    _mark(heat, view, affordances.points[:, :2], np.where(affordances.safe, 2 + level, 1))
    return heat


def _mark(
    layer: NDArray[np.int64],
    view: MapView,
    points: NDArray[np.floating],
    values: NDArray[np.integer] | NDArray[np.floating],
) -> None:
    """Raise the cells under (N, 2) points to their (N,) values."""
    index = view.grid.index_of(points)
    inside = view.grid.contains(index)
    np.maximum.at(layer, tuple(index[inside].T), values[inside].astype(np.int64))


def _terms_at_waypoint(decision: Decision) -> tuple[TermRecord, ...]:
    """Each term of the affordance where the agent goes."""
    affordances, waypoint = decision.affordances, decision.waypoint
    if affordances is None or waypoint is None or not len(affordances.points):
        return ()
    away = np.linalg.norm(affordances.points - waypoint, axis=1)
    nearest = int(np.argmin(away))
    return tuple(
        TermRecord(name=name, value=_rounded(float(term[nearest])))
        for name, term in affordances.terms.items()
    )


def _frontier_record(frontier: WeighedFrontier) -> FrontierRecord:
    return FrontierRecord(
        at=(_rounded(frontier.waypoint[0]), _rounded(frontier.waypoint[1])),
        cells=frontier.cells,
        path_cost=_rounded(frontier.path_cost),
        unknown_m2=_rounded(frontier.unknown_m2),
        likelihood=_rounded(frontier.likelihood),
        speaks=frontier.speaks,
        guided=frontier.guided,
        on_stairs=frontier.on_stairs,
        promise=_rounded(frontier.promise),
        rank=frontier.rank,
    )


def _strip(views: Sequence[PanoramaView]) -> str | None:
    """The views side by side, small; None without any."""
    if not views:
        return None
    width = LONE_VIEW_WIDTH if len(views) <= FEW_VIEWS else VIEW_WIDTH
    shape = views[0].image.shape
    width = min(width, shape[1])
    height = max(1, round(width * shape[0] / shape[1]))
    strip = Image.new("RGB", (width * len(views), height))
    for k, view in enumerate(views):
        small = Image.fromarray(view.image).resize((width, height), Image.Resampling.BILINEAR)
        strip.paste(small, (k * width, 0))
    return _webp(strip)


def _picture(view: MapView) -> PictureRecord | None:
    """The floor from above: in each pixel the colour of its highest point below the ceiling."""
    points, colors = view.scene.points, view.scene.colors
    height = points[:, 2] - view.floor_z
    here = (height > STOREY_M[0]) & (height < CEILING_M)
    if not here.any():
        return None
    upwards = np.flatnonzero(here)[np.argsort(height[here], kind="stable")]
    column, row = np.floor(points[upwards, :2] / PIXEL_M).astype(np.int64).T
    left, bottom, right, top = column.min(), row.min(), column.max() + 1, row.max() + 1
    pixels = np.zeros((top - bottom, right - left, 4), np.uint8)
    pixels[top - 1 - row, column - left, :3] = colors[upwards]
    pixels[top - 1 - row, column - left, 3] = 255
    return PictureRecord(
        floor=view.floor,
        low=(_rounded(left * PIXEL_M), _rounded(bottom * PIXEL_M)),
        high=(_rounded(right * PIXEL_M), _rounded(top * PIXEL_M)),
        image=_webp(Image.fromarray(pixels)),
    )


def _webp(image: Image.Image) -> str:
    stream = io.BytesIO()
    image.save(stream, "WEBP", quality=QUALITY, method=EFFORT)
    return base64_text(stream.getvalue())


def _rounded(value: float) -> float:
    return round(float(value), DIGITS)
