"""What there is to say about some runs: their numbers, whole and split, and their comparison."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Literal

from toponav.evaluation.statistics import Resampling
from toponav.evaluation.summary import Summary, summary_of
from toponav.evaluation.tables.comparison import Comparison, compare
from toponav.evaluation.tables.groups import Grouping, GroupKind, grouping
from toponav.evaluation.tables.runs import Run

SplitKind = GroupKind | Literal["failure"]


@dataclass(frozen=True)
class ReportOptions:
    """What to report.

    Attributes:
        by: What to split the runs by; None for the whole runs.
        against: Index of the run that the others are compared with.
        resampling: How means get their intervals.
    """

    by: SplitKind | None = None
    against: int = 0
    resampling: Resampling = field(default_factory=Resampling)


@dataclass(frozen=True)
class GroupSummary:
    """A run's episodes in one group; the group is "" for the whole run."""

    group: str
    run: str
    summary: Summary


@dataclass(frozen=True)
class Report:
    """All that is said about some runs.

    Attributes:
        runs: The runs, in order.
        options: What was asked for.
        whole: The numbers of each run.
        groups: What the groups are, or None.
        grouped: The numbers by group and run, groups outermost; empty without groups.
        comparisons: Every other run against the one chosen.
    """

    runs: tuple[Run, ...]
    options: ReportOptions
    whole: tuple[GroupSummary, ...]
    groups: Grouping | None
    grouped: tuple[GroupSummary, ...]
    comparisons: tuple[Comparison, ...]

    @property
    def against(self) -> Run:
        """The run that the others are compared with."""
        return self.runs[self.options.against]


def report(runs: Sequence[Run], options: ReportOptions | None = None) -> Report:
    """Sum up, split and compare runs.

    Args:
        runs: At least one, with different names.
        options: What to report.
    """
    options = options or ReportOptions()
    resampling = options.resampling
    groups = None
    if options.by is not None and options.by != "failure":
        groups = grouping(options.by, runs)
    grouped = tuple(
        GroupSummary(name, run.name, summary_of(groups.members(run, name), resampling))
        for name in (groups.names if groups else ())
        for run in runs
        if groups is not None
    )
    base = runs[options.against]
    return Report(
        runs=tuple(runs),
        options=options,
        whole=tuple(
            GroupSummary("", run.name, summary_of(run.episodes, resampling)) for run in runs
        ),
        groups=groups,
        grouped=grouped,
        comparisons=tuple(compare(run, base, resampling) for run in runs if run is not base),
    )
