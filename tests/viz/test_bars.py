"""Bars: as high as their rates, as uncertain as their intervals, the same file every time."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure
from PIL import Image

from made_results import made_result, made_run, missed
from toponav.errors import InputError
from toponav.evaluation.statistics import Estimate, Resampling, rate_estimate
from toponav.evaluation.tables.failures import OUTCOMES
from toponav.evaluation.tables.report import ReportOptions, report
from toponav.viz.bars import BarChart, Series, draw_bars, report_chart, save_bars

NOTHING = Estimate(None, (0.0, 1.0), 0)
CHART = BarChart(
    "Success by category of $x_1$",
    "SR@0.1 [%]",
    ("bed", "tv monitor"),
    (
        Series("ours", (rate_estimate(8, 10), rate_estimate(1, 4))),
        Series("_theirs", (rate_estimate(5, 10), NOTHING)),
    ),
)
QUICK = Resampling(resamples=100)


def test_a_bar_is_as_high_as_its_rate_and_its_line_as_long_as_the_interval() -> None:
    (axes,) = Figure().subplots(1, 1, squeeze=False)[0]
    draw_bars(axes, CHART)
    ours, theirs = (c for c in axes.containers if hasattr(c, "patches"))
    assert [bar.get_height() for bar in ours] == [80.0, 25.0]
    assert theirs[0].get_height() == 50.0
    assert np.isnan(theirs[1].get_height())
    (line,) = ours.errorbar.lines[2]
    low, high = rate_estimate(8, 10).interval or (0.0, 0.0)
    assert line.get_segments()[0][:, 1] == pytest.approx([100 * low, 100 * high])
    legend = axes.get_legend()
    assert legend is not None
    assert [text.get_text() for text in legend.get_texts()] == ["ours", "_theirs"]
    assert [label.get_text() for label in axes.get_xticklabels()] == ["bed", "tv monitor"]


@pytest.mark.parametrize("kind", ["png", "svg", "pdf"])
def test_the_same_chart_is_the_same_file(tmp_path: Path, kind: str) -> None:
    paths = [tmp_path / name / f"bars.{kind}" for name in "ab"]
    for path in paths:
        save_bars(CHART, path)
    assert paths[0].read_bytes() == paths[1].read_bytes()
    assert [path.name for path in paths[0].parent.iterdir()] == [f"bars.{kind}"]


def test_a_picture_shows_the_colours_of_its_bars(tmp_path: Path) -> None:
    save_bars(CHART, tmp_path / "bars.png")
    pixels = np.asarray(Image.open(tmp_path / "bars.png").convert("RGB"))
    for color in ((0x00, 0x72, 0xB2), (0xE6, 0x9F, 0x00)):
        assert (pixels == color).all(axis=2).sum() > 500


def test_another_kind_of_picture_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"\.png, \.svg, \.pdf"):
        save_bars(CHART, tmp_path / "bars.bmp")


def test_a_report_by_groups_as_a_chart() -> None:
    runs = [
        made_run("a", [made_result(), made_result(index=1, target="sofa")]),
        made_run("b", [missed(), missed(index=1)]),
    ]
    chart = report_chart(report(runs, ReportOptions("category", resampling=QUICK)))
    assert chart.groups == ("bed", "sofa")
    assert [series.name for series in chart.series] == ["a", "b"]
    assert [[rate.value for rate in series.rates] for series in chart.series] == [
        [1.0, 1.0], [0.0, None],
    ]  # fmt: skip


def test_a_report_by_failure_as_a_chart() -> None:
    run = made_run("a", [made_result(), missed(index=1, failure="stuck")])
    chart = report_chart(report([run], ReportOptions("failure", resampling=QUICK)))
    shares = dict(zip(chart.groups, (rate.value for rate in chart.series[0].rates), strict=True))
    assert shares == {**dict.fromkeys(OUTCOMES, 0.0), "succeeded": 0.5, "stuck": 0.5}


def test_a_report_without_groups_has_no_chart() -> None:
    with pytest.raises(InputError, match="no bars"):
        report_chart(report([made_run("a", [made_result()])], ReportOptions(resampling=QUICK)))
