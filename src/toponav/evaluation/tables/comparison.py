"""Two runs on the same episodes, compared episode by episode."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from toponav.evaluation.funnel import ERROR
from toponav.evaluation.results import EpisodeResult
from toponav.evaluation.statistics import (
    Estimate,
    PairedOutcomes,
    Resampling,
    mean_estimates,
    rate_difference,
)
from toponav.evaluation.summary import MEASURES, measured
from toponav.evaluation.tables.runs import Run

SAME_START_M = 0.01
"""Episodes whose shortest paths differ by less begin at the same place."""

COMPARED = tuple(m for m in MEASURES if m.key in {"spl", "soft_spl", "dtg", "steps"})


@dataclass(frozen=True)
class Comparison:
    """A run less another one, on their common episodes.

    Attributes:
        run: Name of the run.
        against: Name of the other one.
        common: Episodes that both ran.
        elsewhere: Episodes of the same key that the two began elsewhere or for another target.
        outcomes: Successes at the benchmark's radius; the run is the first.
        success: Difference of the success rates.
        means: Difference of the means by key of `COMPARED`; a distance only where both have one.
        note: One line on the protocols, "" where they agree.
    """

    run: str
    against: str
    common: int
    elsewhere: int
    outcomes: PairedOutcomes
    success: Estimate
    means: Mapping[str, Estimate]
    note: str


def compare(run: Run, against: Run, resampling: Resampling) -> Comparison:
    """Compare `run` with `against`; without a common episode the differences have no value."""
    pairs, elsewhere = common_episodes(run, against)
    ours, theirs = [pair[0] for pair in pairs], [pair[1] for pair in pairs]
    outcomes = PairedOutcomes.of([r.succeeded for r in ours], [r.succeeded for r in theirs])
    return Comparison(
        run=run.name,
        against=against.name,
        common=len(pairs),
        elsewhere=elsewhere,
        outcomes=outcomes,
        success=_success_difference(ours, theirs, outcomes, resampling),
        means=_mean_differences(ours, theirs, resampling),
        note=run.protocol_difference(against),
    )


def common_episodes(
    run: Run, against: Run
) -> tuple[list[tuple[EpisodeResult, EpisodeResult]], int]:
    """The episodes that both ran, as pairs in the order of `run`, and how many only look alike.

    Episodes are the same if they share scene, index, target and start. A record does not hold the
    start, but the shortest path from it; drawn episodes of another seed are told apart by it. An
    episode that an error kept from beginning is paired by its key alone: to leave it out would
    spare the run that failed it.
    """
    others = {episode.key: episode for episode in against.episodes}
    alike = [(own, others[own.key]) for own in run.episodes if own.key in others]
    pairs = [(own, other) for own, other in alike if _same_episode(own, other)]
    return pairs, len(alike) - len(pairs)


def _same_episode(first: EpisodeResult, second: EpisodeResult) -> bool:
    if _never_began(first) or _never_began(second):
        return True
    paths = first.shortest_path, second.shortest_path
    if not all(map(math.isfinite, paths)):
        return first.target == second.target and paths[0] == paths[1]
    return first.target == second.target and abs(paths[0] - paths[1]) < SAME_START_M


def _never_began(episode: EpisodeResult) -> bool:
    return episode.failure == ERROR and not math.isfinite(episode.shortest_path)


def _success_difference(
    ours: Sequence[EpisodeResult],
    theirs: Sequence[EpisodeResult],
    outcomes: PairedOutcomes,
    resampling: Resampling,
) -> Estimate:
    """Newcombe's interval, or the bootstrap's where scenes are resampled."""
    if resampling.unit == "episode" or not ours:
        return rate_difference(outcomes)
    differences = [
        [float(own.succeeded) - float(other.succeeded)]
        for own, other in zip(ours, theirs, strict=True)
    ]
    return mean_estimates(np.array(differences), [own.scene for own in ours], resampling)[0]


def _mean_differences(
    ours: Sequence[EpisodeResult], theirs: Sequence[EpisodeResult], resampling: Resampling
) -> dict[str, Estimate]:
    with np.errstate(invalid="ignore"):  # no path in either: no difference
        differences = measured(ours, COMPARED) - measured(theirs, COMPARED)
    estimates = mean_estimates(differences, [own.scene for own in ours], resampling)
    return dict(zip((measure.key for measure in COMPARED), estimates, strict=True))
