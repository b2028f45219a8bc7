"""How the viewer is laid out: the world, what the agent sees, what it thinks, how it gets on."""

from __future__ import annotations

from typing import Any

CAMERA = "world/agent/camera"
RGB, DEPTH = f"{CAMERA}/rgb", f"{CAMERA}/depth"
MAP, GRAPH, PLAN, AGENT = "world/map", "world/graph", "world/plan", "world/agent"
AFFORDANCES = "world/affordances"
PANORAMA = "panorama"
ANSWER, MEMORY_TEXT, LOG = "reasoner/answer", "reasoner/memory", "reasoner/log"
METRICS = "metrics"


def blueprint(rr: Any) -> Any:
    """The default layout; a user may change it and the viewer keeps the change."""
    views = rr.blueprint
    return views.Blueprint(
        views.Horizontal(
            views.Vertical(
                views.Spatial3DView(
                    origin="world", name="World", contents=["$origin/**", f"- {AFFORDANCES}/**"],
                ),
                views.Spatial2DView(origin=PANORAMA, name="Panorama"),
                row_shares=[3, 2],
            ),
            views.Vertical(
                views.Horizontal(
                    views.Spatial2DView(origin=RGB, name="RGB"),
                    views.Spatial2DView(origin=DEPTH, name="Depth"),
                ),
                views.Tabs(
                    views.TextDocumentView(origin=ANSWER, name="Reasoner"),
                    views.TextDocumentView(origin=MEMORY_TEXT, name="Memory"),
                    views.TextLogView(origin=LOG, name="Log"),
                    views.Spatial3DView(
                        origin="world", name="Affordances",
                        contents=[f"{AFFORDANCES}/total", f"{GRAPH}/**", f"{PLAN}/**"],
                    ),
                ),
                views.TimeSeriesView(origin=METRICS, name="Metrics"),
            ),
            column_shares=[3, 2],
        ),
        views.TimePanel(timeline="step", state="collapsed"),
        collapse_panels=True,
    )  # fmt: skip
