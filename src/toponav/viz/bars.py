"""Grouped bars with intervals: rates of several runs side by side."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from toponav.errors import InputError
from toponav.evaluation.metrics import BENCHMARK_RADIUS_M
from toponav.evaluation.statistics import Estimate, rate_estimate
from toponav.evaluation.tables.failures import OUTCOMES, outcome_counts
from toponav.evaluation.tables.report import Report
from toponav.files import temporary_beside

if TYPE_CHECKING:
    from matplotlib.axes import Axes

KINDS = (".png", ".svg", ".pdf")

COLORS = ("#0072B2", "#E69F00", "#009E73", "#CC79A7", "#56B4E9", "#D55E00", "#F0E442", "#000000")
"""Okabe and Ito's palette, which people with colour-blindness can tell apart."""

GROUP_WIDTH = 0.8
"""Of the distance between two groups, what their bars take."""

HEIGHT_IN, INCHES_A_BAR, LEAST_WIDTH_IN, MOST_WIDTH_IN = 3.6, 0.28, 4.8, 24.0
"""Size of a picture; its width grows with the number of bars."""

MANY_GROUPS, LONG_NAME = 4, 12
"""More groups than this whose names are longer than that are written aslant."""

WITHOUT_DATE: dict[str, dict[str, Any]] = {
    ".png": {},
    ".svg": {"Date": None},
    ".pdf": {"CreationDate": None},
}
"""Metadata by kind of file that makes the same picture the same file."""


@dataclass(frozen=True)
class Series:
    """One run's bars.

    Attributes:
        name: For the legend.
        rates: A rate a group, from 0 to 1; a rate without a value has no bar.
    """

    name: str
    rates: tuple[Estimate, ...]


@dataclass(frozen=True)
class BarChart:
    """What to draw.

    Attributes:
        title: Over the picture.
        y_label: What the rates are; they are drawn in percent.
        groups: Names of the groups.
        series: At least one; each has a rate for every group.
    """

    title: str
    y_label: str
    groups: tuple[str, ...]
    series: tuple[Series, ...]


def report_chart(report: Report) -> BarChart:
    """The runs' success rates by group or, of a report by failure, the shares of the outcomes.

    Raises:
        InputError: The report has no groups.
    """
    if report.options.by == "failure":
        shares = {
            run.name: tuple(
                rate_estimate(count, len(run.episodes)) for count in outcome_counts(run).values()
            )
            for run in report.runs
        }
        return _chart("What became of the episodes", "episodes [%]", OUTCOMES, shares)
    if report.groups is None:
        raise InputError("a report without groups has no bars; split it by something")
    rates: dict[str, tuple[Estimate, ...]] = {run.name: () for run in report.runs}
    for row in report.grouped:
        rates[row.run] += (row.summary.success[str(BENCHMARK_RADIUS_M)],)
    title = f"Success by {report.groups.title}"
    return _chart(title, f"SR@{BENCHMARK_RADIUS_M} [%]", report.groups.names, rates)


def _chart(
    title: str, y_label: str, groups: tuple[str, ...], rates: Mapping[str, tuple[Estimate, ...]]
) -> BarChart:
    series = tuple(Series(name, values) for name, values in rates.items())
    return BarChart(title, y_label, groups, series)


def check_kind(path: Path) -> None:
    """Make sure that bars can be drawn into a file of this name, before anything is computed.

    Raises:
        InputError: They cannot.
    """
    if path.suffix.lower() not in KINDS:
        raise InputError(f"{path}: a picture is a {', '.join(KINDS)} file; choose one of these")


def save_bars(chart: BarChart, path: Path) -> None:
    """Draw the chart; the file's suffix says as what.

    Raises:
        InputError: No such kind of picture.
        OSError: The file cannot be written.
    """
    check_kind(path)
    from matplotlib import rc_context
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    bars = len(chart.groups) * (len(chart.series) + 1)
    width = min(max(bars * INCHES_A_BAR, LEAST_WIDTH_IN), MOST_WIDTH_IN)
    with rc_context({"svg.hashsalt": "toponav", "text.parse_math": False}):
        figure = Figure(figsize=(width, HEIGHT_IN), dpi=150, layout="constrained")
        FigureCanvasAgg(figure)
        axes = figure.add_subplot()
        draw_bars(axes, chart)
        path.parent.mkdir(parents=True, exist_ok=True)
        temporary = temporary_beside(path)
        try:
            figure.savefig(temporary, metadata=WITHOUT_DATE[path.suffix.lower()])
            temporary.replace(path)
        finally:
            temporary.unlink(missing_ok=True)


def draw_bars(axes: Axes, chart: BarChart) -> None:
    """Draw the chart's bars, intervals and names into `axes`, in percent."""
    centers = np.arange(len(chart.groups))
    width = GROUP_WIDTH / len(chart.series)
    drawn = []
    for k, series in enumerate(chart.series):
        offset = (k - (len(chart.series) - 1) / 2) * width
        values, errors = _heights(series.rates)
        color = COLORS[k % len(COLORS)]
        whiskers = {"linewidth": 0.8, "capsize": 2}
        drawn.append(
            axes.bar(centers + offset, values, width, yerr=errors, color=color, error_kw=whiskers)
        )
    legend = axes.legend(
        drawn, [str(k) for k in range(len(drawn))],
        loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False,
    )  # fmt: skip
    for text, series in zip(legend.get_texts(), chart.series, strict=True):
        text.set_text(series.name)  # set here: matplotlib leaves out names that begin with "_"
    tilted = len(chart.groups) > MANY_GROUPS and max(map(len, chart.groups)) > LONG_NAME
    axes.set_xticks(centers, chart.groups, rotation=30 if tilted else 0,
                    ha="right" if tilted else "center")  # fmt: skip
    axes.set_ylim(0.0, 100.0)
    axes.set_ylabel(chart.y_label)
    axes.set_title(chart.title)
    axes.spines[["top", "right"]].set_visible(False)


def _heights(rates: Sequence[Estimate]) -> tuple[list[float], np.ndarray[Any, Any]]:
    """Percents, and how far the intervals reach (2, G) below and above; 0 where there is none."""
    values = [np.nan if rate.value is None else 100.0 * rate.value for rate in rates]
    errors = np.zeros((2, len(rates)))
    for k, rate in enumerate(rates):
        if rate.value is not None and rate.interval is not None:
            low, high = rate.interval
            errors[:, k] = 100.0 * max(rate.value - low, 0.0), 100.0 * max(high - rate.value, 0.0)
    return values, errors
