"""A report as data for programs: what `toponav table --json` prints."""

from __future__ import annotations

from typing import Any

from toponav.evaluation.statistics import CONFIDENCE, Estimate
from toponav.evaluation.summary import Summary
from toponav.evaluation.tables.comparison import Comparison
from toponav.evaluation.tables.failures import outcome_counts, stage_rates
from toponav.evaluation.tables.report import Report
from toponav.evaluation.tables.runs import Run


def report_data(report: Report) -> dict[str, Any]:
    """One JSON object: the runs with their outcomes and stages, the groups, the comparisons."""
    rows = zip(report.runs, report.whole, strict=True)
    data: dict[str, Any] = {
        "runs": [{**_run_data(run), **_summary_data(row.summary)} for run, row in rows],
        "comparisons": [_comparison_data(comparison) for comparison in report.comparisons],
        "intervals": {"confidence": CONFIDENCE, **report.options.resampling.model_dump()},
    }
    if report.groups is not None:
        data["by"] = report.options.by
        data["groups"] = [
            {"group": row.group, "run": row.run, **_summary_data(row.summary)}
            for row in report.grouped
        ]
    return data


def _run_data(run: Run) -> dict[str, Any]:
    counts, n = outcome_counts(run), len(run.episodes)
    return {
        "name": run.name,
        "folder": str(run.folder),
        "method": run.config.get("method"),
        "preset": run.config.get("preset"),
        "protocol": run.protocol,
        "outcomes": {name: {"n": k, "share": k / n} for name, k in counts.items()},
        "stages": {name: _estimate_data(rate, "rate") for name, rate in stage_rates(run).items()},
    }


def _summary_data(summary: Summary) -> dict[str, Any]:
    return {
        "n": summary.n,
        "sr": {radius: _estimate_data(rate, "rate") for radius, rate in summary.success.items()},
        **{key: _estimate_data(mean, "value") for key, mean in summary.means.items()},
        "unreachable": summary.unreachable,
        "errors": summary.errors,
    }


def _comparison_data(comparison: Comparison) -> dict[str, Any]:
    return {
        "run": comparison.run,
        "against": comparison.against,
        "common": comparison.common,
        "elsewhere": comparison.elsewhere,
        "sr": {
            **_estimate_data(comparison.success, "difference"),
            "won": comparison.outcomes.first_only,
            "lost": comparison.outcomes.second_only,
            "p": comparison.outcomes.p_value if comparison.common else None,
        },
        **{key: _estimate_data(mean, "difference") for key, mean in comparison.means.items()},
        "protocol_difference": comparison.note or None,
    }


def _estimate_data(estimate: Estimate, name: str) -> dict[str, Any]:
    interval = None if estimate.interval is None else list(estimate.interval)
    return {name: estimate.value, "interval": interval, "n": estimate.n}
