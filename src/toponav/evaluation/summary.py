"""The numbers of a run: the one place where episodes become rates and means.

`toponav eval` writes them at the end of a run, `toponav table` sets them side by side.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from toponav.evaluation.funnel import ERROR
from toponav.evaluation.metrics import SUCCESS_RADII_M, finite_mean
from toponav.evaluation.statistics import Estimate, Resampling, mean_estimates, rate_estimate

if TYPE_CHECKING:
    from toponav.evaluation.results import EpisodeResult

RADII = tuple(map(str, SUCCESS_RADII_M))


@dataclass(frozen=True)
class Measure:
    """A quantity of an episode whose mean is reported.

    Attributes:
        key: Its name in JSON.
        title: Its name in tables, with the unit.
        digits: Decimals that are worth printing.
        of: Reads it from a record; infinite where it does not exist.
    """

    key: str
    title: str
    digits: int
    of: Callable[[EpisodeResult], float]


QUALITY = (
    Measure("spl", "SPL", 3, lambda r: r.spl),
    Measure("soft_spl", "SoftSPL", 3, lambda r: r.soft_spl),
    Measure("dtg", "DTG [m]", 2, lambda r: r.distance_to_goal),
)
"""How well the target was found."""

EFFORT = (
    Measure("steps", "steps", 0, lambda r: r.steps),
    Measure("decisions", "decisions", 1, lambda r: r.decisions),
    Measure("path_length", "path [m]", 1, lambda r: r.path_length),
    Measure("collisions", "collisions", 1, lambda r: r.collisions),
    Measure("vlm_calls", "VLM calls", 1, lambda r: r.vlm.calls),
    Measure("vlm_cost_usd", "VLM cost [USD]", 4, lambda r: r.vlm.cost_usd),
    Measure("seconds", "seconds", 1, lambda r: r.seconds.get("total", np.nan)),
)
"""What an episode took."""

MEASURES = QUALITY + EFFORT


@dataclass(frozen=True)
class Summary:
    """The numbers of some episodes.

    Attributes:
        n: Episodes.
        success: Success rate by radius in metres, with Wilson's interval (or, where scenes are
            resampled, the bootstrap's).
        means: Mean by key of `MEASURES`; a distance that is infinite is not in it.
        unreachable: Episodes whose distance to the goal is infinite.
        errors: Episodes that an error ended.
    """

    n: int
    success: Mapping[str, Estimate]
    means: Mapping[str, Estimate]
    unreachable: int
    errors: int


def summary_of(episodes: Sequence[EpisodeResult], resampling: Resampling | None = None) -> Summary:
    """The numbers of some episodes; without a resampling, means have no intervals."""
    return Summary(
        n=len(episodes),
        success=_success(episodes, resampling),
        means=_means(episodes, resampling),
        unreachable=finite_mean([episode.distance_to_goal for episode in episodes])[1],
        errors=sum(episode.failure == ERROR for episode in episodes),
    )


def measured(episodes: Sequence[EpisodeResult], measures: Sequence[Measure]) -> NDArray[np.float64]:
    """(N, M) values of the measures."""
    values = [[float(measure.of(episode)) for measure in measures] for episode in episodes]
    return np.array(values, dtype=np.float64).reshape(len(episodes), len(measures))


def summarize(results: Iterable[EpisodeResult]) -> dict[str, Any]:
    """The row of `summary.json`: n, SR by radius with Wilson intervals, SPL, SoftSPL, DTG."""
    summary = summary_of(list(results))
    return {
        "n": summary.n,
        "sr": {
            radius: {"rate": rate.value, "interval": list(rate.interval or ())}
            for radius, rate in summary.success.items()
        },
        **{measure.key: summary.means[measure.key].value for measure in QUALITY},
        "unreachable": summary.unreachable,
        "steps": summary.means["steps"].value,
    }


def _success(
    episodes: Sequence[EpisodeResult], resampling: Resampling | None
) -> dict[str, Estimate]:
    if resampling is not None and resampling.unit == "scene":
        hits = [[float(episode.success[radius]) for radius in RADII] for episode in episodes]
        values = np.array(hits).reshape(len(episodes), len(RADII))
        scenes = [episode.scene for episode in episodes]
        return dict(zip(RADII, mean_estimates(values, scenes, resampling), strict=True))
    return {
        radius: rate_estimate(sum(episode.success[radius] for episode in episodes), len(episodes))
        for radius in RADII
    }


def _means(episodes: Sequence[EpisodeResult], resampling: Resampling | None) -> dict[str, Estimate]:
    keys = [measure.key for measure in MEASURES]
    values = measured(episodes, MEASURES)
    if resampling is not None:
        scenes = [episode.scene for episode in episodes]
        return dict(zip(keys, mean_estimates(values, scenes, resampling), strict=True))
    n = len(episodes)
    estimates = []
    for column in values.T:
        mean, infinite = finite_mean(column.tolist())
        estimates.append(Estimate(mean, None, n - infinite))
    return dict(zip(keys, estimates, strict=True))
