"""A report as tables for people."""

from __future__ import annotations

from dataclasses import replace

from toponav.evaluation.metrics import BENCHMARK_RADIUS_M
from toponav.evaluation.statistics import Resampling
from toponav.evaluation.summary import EFFORT, QUALITY, RADII, Summary
from toponav.evaluation.tables.comparison import COMPARED
from toponav.evaluation.tables.failures import outcome_table, stage_table
from toponav.evaluation.tables.report import Report
from toponav.evaluation.tables.table import Cell, Column, Table


def report_tables(report: Report) -> list[Table]:
    """What was asked for, the comparison of the runs last.

    The first table's notes state every run's protocol and how the intervals were come by.
    """
    if report.options.by == "failure":
        tables = [outcome_table(report.runs), stage_table(report.runs)]
    else:
        tables = [_main_table(report)]
    settings = [f"{run.name}: {run.settings()}" for run in report.runs]
    notes = (*settings, *tables[0].notes, *_method_notes(report.options.resampling))
    tables[0] = replace(tables[0], notes=notes)
    return tables + ([_comparison_table(report)] if report.comparisons else [])


def _main_table(report: Report) -> Table:
    """The numbers of the runs, or of their groups."""
    if report.groups is None:
        rows = tuple((r.run, *_cells(r.summary)) for r in report.whole)
        return Table("Runs", (Column("run", label=True), *_columns()), rows)
    rows = tuple((r.group, r.run, *_cells(r.summary)) for r in report.grouped)
    labels = Column(report.groups.title, label=True), Column("run", label=True)
    return Table(f"Runs by {report.groups.title}", (*labels, *_columns()), rows)


def _method_notes(resampling: Resampling) -> tuple[str, ...]:
    by_scene = resampling.unit == "scene"
    kinds = "bootstrap" if by_scene else "Wilson for rates, bootstrap for means"
    return (
        "success at r: stop was called, and the geodesic distance to the nearest viewpoint of the "
        "target (DTG) is under r; SPL at 0.1 m; no path: DTG is infinite and not in its mean",
        f"brackets: 95 % intervals, {kinds} ({resampling.resamples} resamples of "
        f"{resampling.unit}s, seed {resampling.seed})",
    )


def _comparison_table(report: Report) -> Table:
    """Paired differences from one run."""
    rows = tuple(
        (
            c.run, c.common, c.success, c.outcomes.first_only, c.outcomes.second_only,
            c.outcomes.p_value if c.common else None,
            *(c.means[measure.key] for measure in COMPARED),
        )
        for c in report.comparisons
    )  # fmt: skip
    columns = (
        Column("run", label=True),
        Column("common"),
        Column(f"SR@{BENCHMARK_RADIUS_M} [points]", digits=1, percent=True, signed=True),
        Column("won"),
        Column("lost"),
        Column("McNemar p", digits=4),
        *(Column(m.title, digits=m.digits, signed=True) for m in COMPARED),
    )
    title = f"Difference from {report.against.name} on the common episodes"
    return Table(title, columns, rows, _comparison_notes(report))


def _comparison_notes(report: Report) -> tuple[str, ...]:
    against = report.against.name
    notes = []
    for comparison in report.comparisons:
        if comparison.common == 0:
            notes.append(f"{comparison.run}: no episode in common with {against}")
        if comparison.elsewhere:
            notes.append(
                f"{comparison.run}: {comparison.elsewhere} episodes of the same scene and index "
                f"left out, since their start or target is another than in {against}"
            )
        if comparison.note:
            notes.append(comparison.note)
    by_scene = report.options.resampling.unit == "scene"
    success = "bootstrap" if by_scene else "Newcombe for paired rates"
    notes.append(
        f"won: succeeded where {against} failed; interval of the success difference: {success}; "
        "p: McNemar's exact test, two-sided, for each comparison by itself"
    )
    return tuple(notes)


def _columns() -> tuple[Column, ...]:
    return (
        Column("n", label=True),
        *(Column(f"SR@{radius} [%]", digits=1, percent=True) for radius in RADII),
        *(Column(measure.title, digits=measure.digits) for measure in QUALITY),
        Column("no path"),
        Column("errors"),
        *(Column(measure.title, digits=measure.digits, panel=1) for measure in EFFORT),
    )


def _cells(summary: Summary) -> tuple[Cell, ...]:
    return (
        summary.n,
        *(summary.success[radius] for radius in RADII),
        *(summary.means[measure.key] for measure in QUALITY),
        summary.unreachable,
        summary.errors,
        *(summary.means[measure.key] for measure in EFFORT),
    )
