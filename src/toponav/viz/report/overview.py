"""What the page shows before an episode is opened: the tables, and a line an episode."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from toponav.categories import readable
from toponav.evaluation.results import EpisodeResult, json_ready
from toponav.evaluation.statistics import Resampling
from toponav.evaluation.tables.failures import OUTCOMES, outcome_of
from toponav.evaluation.tables.report import ReportOptions, SplitKind, report
from toponav.evaluation.tables.report_tables import report_tables
from toponav.evaluation.tables.runs import Run
from toponav.evaluation.tables.table import Table, split_interval

SPLITS: tuple[SplitKind, ...] = ("category", "distance", "failure")
"""The tables after that of the whole runs."""


def overview(runs: Sequence[Run], resampling: Resampling) -> dict[str, Any]:
    """Runs, their tables and their episodes as JSON values."""
    return {
        "runs": [_run(run) for run in runs],
        "tables": [_table(table) for table in _tables(runs, resampling)],
        "outcomes": list(OUTCOMES),
    }


def _tables(runs: Sequence[Run], resampling: Resampling) -> list[Table]:
    """The whole runs and their comparison, then the splits."""
    tables = report_tables(report(runs, ReportOptions(resampling=resampling)))
    for split in SPLITS:
        parts = report_tables(report(runs, ReportOptions(by=split, resampling=resampling)))
        compared = len(runs) > 1
        for table in parts[:-1] if compared else parts:
            tables.append(Table(table.title, table.columns, table.rows))
    return tables


def _table(table: Table) -> dict[str, Any]:
    return {
        "title": table.title,
        "panels": [
            {
                "columns": [{"title": one.title, "label": one.label} for one in panel.columns],
                "rows": [[split_interval(text) for text in row] for row in panel.texts()],
            }
            for panel in table.panels()
        ],
        "notes": table.notes,
    }


def _run(run: Run) -> dict[str, Any]:
    return {
        "name": run.name,
        "settings": run.settings(),
        "method": run.episodes[0].method,
        "episodes": [_episode(result) for result in run.episodes],
    }


def _episode(result: EpisodeResult) -> dict[str, Any]:
    """What the list, the filters and the head of an episode show."""
    data: dict[str, Any] = json_ready(
        {
            "scene": result.scene,
            "index": result.index,
            "target": readable(result.target),
            "method": result.method,
            "succeeded": result.succeeded,
            "outcome": outcome_of(result),
            "ended": result.ended,
            "steps": result.steps,
            "decisions": result.decisions,
            "spl": result.spl,
            "softSpl": result.soft_spl,
            "distance": result.distance_to_goal,
            "shortest": result.shortest_path,
            "length": result.path_length,
            "collisions": result.collisions,
            "floorChange": result.floor_change,
            "visible": result.search.visible_step,
            "detected": result.search.detected_step,
            "approached": result.search.approached_step,
            "calls": result.vlm.calls,
            "cost": result.vlm.cost_usd,
            "seconds": result.seconds.get("total"),
        }
    )
    return data
