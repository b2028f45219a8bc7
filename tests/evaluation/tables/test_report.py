"""A report of runs, as tables and as data, against cases worked by hand."""

from __future__ import annotations

import json
import math
from typing import get_args

import pytest

from made_results import made_result, made_run, missed
from toponav.evaluation.funnel import FAILURES, SearchTrace
from toponav.evaluation.results import json_ready
from toponav.evaluation.statistics import Estimate, Resampling
from toponav.evaluation.summary import summarize, summary_of
from toponav.evaluation.tables.failures import OUTCOMES, outcome_counts, outcome_of, stage_rates
from toponav.evaluation.tables.report import Report, ReportOptions, SplitKind, report
from toponav.evaluation.tables.report_data import report_data
from toponav.evaluation.tables.report_tables import report_tables

QUICK = Resampling(resamples=200)
FIRST = made_run("first", [
    made_result("a", 0, steps=30),
    made_result("b", 0, target="sofa", steps=50),
    missed("b", 1, target="sofa", steps=500, failure="never visible"),
    missed("b", 2, distance_to_goal=math.inf, steps=500, failure="stuck", floor_change=True),
])  # fmt: skip
SECOND = made_run("second", [made_result("a", 0, steps=20), made_result("b", 0, target="sofa")])


def told(by: SplitKind | None = None, against: int = 0) -> Report:
    return report([FIRST, SECOND], ReportOptions(by, against, QUICK))


def test_the_numbers_of_a_run_by_hand() -> None:
    summary = summary_of(FIRST.episodes, QUICK)
    assert summary.n == 4
    assert summary.success["0.1"].value == 0.5
    assert summary.success["0.1"].interval == pytest.approx((0.1500, 0.8500), abs=1e-4)
    assert summary.means["steps"].value == 270.0
    assert summary.means["dtg"].value == pytest.approx((0.05 + 0.05 + 2.0) / 3)
    assert (summary.means["dtg"].n, summary.unreachable, summary.errors) == (3, 1, 0)
    assert summary.means["vlm_cost_usd"].value == 0.0


def test_eval_and_table_report_the_same_numbers() -> None:
    row = summarize(FIRST.episodes)
    run = report_data(told())["runs"][0]
    assert run["n"] == row["n"]
    assert run["unreachable"] == row["unreachable"]
    for radius, rate in row["sr"].items():
        assert run["sr"][radius]["rate"] == rate["rate"]
        assert run["sr"][radius]["interval"] == rate["interval"]
    for key in ("spl", "soft_spl", "dtg", "steps"):
        assert run[key]["value"] == row[key]


def test_data_hold_every_promised_key_and_survive_json() -> None:
    data = report_data(told("category"))
    assert json.loads(json.dumps(json_ready(data), allow_nan=False))["runs"]
    for run in data["runs"]:
        assert {"name", "n", "sr", "spl", "soft_spl", "dtg", "outcomes", "stages"} <= run.keys()
        assert list(run["sr"]) == ["0.1", "0.2", "0.25", "1.0"]
        for key in ("spl", "soft_spl", "dtg", "steps", "seconds"):
            assert {"value", "interval"} <= run[key].keys()
    assert [(g["group"], g["run"], g["n"]) for g in data["groups"]] == [
        ("bed", "first", 2), ("bed", "second", 1), ("sofa", "first", 2), ("sofa", "second", 1),
    ]  # fmt: skip
    (comparison,) = data["comparisons"]
    assert (comparison["run"], comparison["against"], comparison["common"]) == (
        "second", "first", 2,
    )  # fmt: skip
    assert comparison["sr"]["p"] == 1.0


def test_the_main_table_and_what_is_said_under_it() -> None:
    runs, differences = report_tables(told())
    assert [row[0] for row in runs.rows] == ["first", "second"]
    assert runs.texts()[0][1:3] == ["4", "50.0 [15.0,\N{NO-BREAK SPACE}85.0]"]
    assert any(note.startswith("first: toponav (preset default)") for note in runs.notes)
    assert any("Wilson" in note and "200 resamples of episodes" in note for note in runs.notes)
    assert differences.title == "Difference from first on the common episodes"
    assert [row[:2] for row in differences.rows] == [("second", 2)]


def test_any_run_can_be_the_one_that_others_are_compared_with() -> None:
    differences = report_tables(told(against=1))[-1]
    assert differences.title == "Difference from second on the common episodes"
    assert differences.rows[0][0] == "first"


@pytest.mark.parametrize("by", [kind for kinds in get_args(SplitKind) for kind in
                                (get_args(kinds) or (kinds,)) if kind != "failure"])  # fmt: skip
def test_groups_share_out_the_episodes(by: SplitKind) -> None:
    split = told(by)
    for run in split.runs:
        sizes = [row.summary.n for row in split.grouped if row.run == run.name]
        assert sum(sizes) == len(run.episodes)
    assert len(report_tables(split)[0].rows) == len(split.grouped)


def test_clustered_intervals_say_so() -> None:
    options = ReportOptions(resampling=Resampling(resamples=200, unit="scene"))
    tables = report_tables(report([FIRST, SECOND], options))
    notes = " ".join(note for table in tables for note in table.notes)
    assert "resamples of scenes" in notes
    assert "Wilson" not in notes
    assert "Newcombe" not in notes


def test_what_cannot_be_compared_is_said_in_a_line() -> None:
    elsewhere = made_run("other", [made_result("b", 0, target="bed")], detector="noisy")
    nowhere = made_run("third", [made_result("z", 0)])
    notes = report_tables(report([SECOND, elsewhere, nowhere], ReportOptions(resampling=QUICK)))[
        -1
    ].notes
    assert "other: no episode in common with second" in notes
    assert "third: no episode in common with second" in notes
    assert any(note.startswith("other: 1 episodes of the same scene") for note in notes)
    assert any("detector (oracle there, noisy here)" in note for note in notes)


def test_one_run_is_compared_with_nothing() -> None:
    single = report([FIRST], ReportOptions(resampling=QUICK))
    assert single.comparisons == ()
    assert len(report_tables(single)) == 1


def test_every_episode_has_one_outcome() -> None:
    counts = outcome_counts(FIRST)
    assert tuple(counts) == OUTCOMES
    assert sum(counts.values()) == 4
    assert (counts["succeeded"], counts["never visible"], counts["stuck"]) == (2, 1, 1)
    for failure in FAILURES:
        assert outcome_of(missed(failure=failure)) == failure
    assert outcome_of(missed(failure="")) == "not recorded"


def test_the_funnel_by_hand() -> None:
    episodes = [
        made_result(index=0, search=SearchTrace(3, 4, 5, 0.05)),
        missed(index=1, search=SearchTrace(3, 9, None, 1.0)),
        missed(index=2, search=SearchTrace(3, None, None, 1.0), stop_called=True),
        missed(index=3),
    ]
    rates = {stage: rate.value for stage, rate in stage_rates(made_run("r", episodes)).items()}
    assert rates == {
        "visible": 0.75, "detected": 0.5, "approached": 0.25, "stopped": 0.5, "succeeded": 0.25,
    }  # fmt: skip


def test_the_funnel_shows_the_runs_side_by_side() -> None:
    outcomes, stages, _ = report_tables(told("failure"))
    assert [column.title for column in outcomes.columns] == [
        "outcome", "first: n", "first [%]", "second: n", "second [%]",
    ]  # fmt: skip
    by_name = {row[0]: row[1:] for row in outcomes.rows}
    assert by_name["stuck"][0] == 1
    assert isinstance(by_name["stuck"][1], Estimate)
    assert by_name["stuck"][1].value == 0.25
    assert "not recorded" not in by_name
    assert [row[0] for row in stages.rows][-1] == "succeeded"
