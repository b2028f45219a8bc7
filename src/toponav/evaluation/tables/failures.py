"""The failure funnel of runs: what became of their episodes, and how far the searches got."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence

from toponav.evaluation.funnel import FAILURES
from toponav.evaluation.results import EpisodeResult
from toponav.evaluation.statistics import Estimate, rate_estimate
from toponav.evaluation.tables.runs import Run
from toponav.evaluation.tables.table import Cell, Column, Table

SUCCEEDED = "succeeded"
NOT_RECORDED = "not recorded"
"""Failures in results that do not say why they are."""

RUNS_A_PANEL = 4
"""Runs side by side on one panel."""

OUTCOMES = (SUCCEEDED, *FAILURES, NOT_RECORDED)

STAGES: dict[str, Callable[[EpisodeResult], bool]] = {
    "visible": lambda r: r.search.visible_step is not None,
    "detected": lambda r: r.search.detected_step is not None,
    "approached": lambda r: r.search.approached_step is not None,
    "stopped": lambda r: r.stop_called,
    SUCCEEDED: lambda r: r.succeeded,
}
"""The stages of a search, each with how a record tells that it was reached."""


def outcome_of(episode: EpisodeResult) -> str:
    """One of `OUTCOMES`, at the benchmark's radius."""
    if episode.succeeded:
        return SUCCEEDED
    return episode.failure if episode.failure in FAILURES else NOT_RECORDED


def outcome_counts(run: Run) -> dict[str, int]:
    """Episodes by outcome, all outcomes in order; they add up to the run's episodes."""
    counts = Counter(map(outcome_of, run.episodes))
    return {outcome: counts[outcome] for outcome in OUTCOMES}


def stage_rates(run: Run) -> dict[str, Estimate]:
    """Share of the episodes that reached each stage at any time, with Wilson's interval."""
    n = len(run.episodes)
    return {name: rate_estimate(sum(map(of, run.episodes)), n) for name, of in STAGES.items()}


def outcome_table(runs: Sequence[Run]) -> Table:
    """Counts and shares of every outcome, runs side by side."""
    columns = [Column("outcome", label=True)]
    for k, run in enumerate(runs):
        columns += [
            Column(f"{run.name}: n", panel=k // RUNS_A_PANEL),
            Column(f"{run.name} [%]", digits=1, percent=True, panel=k // RUNS_A_PANEL),
        ]
    counts = [outcome_counts(run) for run in runs]
    rows = []
    for outcome in OUTCOMES:
        if outcome == NOT_RECORDED and not any(count[outcome] for count in counts):
            continue
        cells: list[Cell] = [outcome]
        for run, count in zip(runs, counts, strict=True):
            cells += [count[outcome], rate_estimate(count[outcome], len(run.episodes))]
        rows.append(tuple(cells))
    return Table("What became of the episodes", tuple(columns), tuple(rows))


def stage_table(runs: Sequence[Run]) -> Table:
    """How many searches reached each stage, runs side by side."""
    columns = (
        Column("stage", label=True),
        *(
            Column(f"{run.name} [%]", digits=1, percent=True, panel=k // RUNS_A_PANEL)
            for k, run in enumerate(runs)
        ),
    )
    rates = [stage_rates(run) for run in runs]
    rows: list[tuple[Cell, ...]] = [(stage, *(rate[stage] for rate in rates)) for stage in STAGES]
    notes = ("a stage counts wherever it was reached, whether or not those before it were",)
    return Table("How far the searches got", columns, tuple(rows), notes)
