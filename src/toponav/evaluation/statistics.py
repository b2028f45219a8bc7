"""How sure a figure is: intervals of rates and means, and paired tests on the same episodes.

Rates get Wilson's interval, means the percentile bootstrap. Two runs on the same episodes are
compared episode by episode, which takes the differences between episodes out of the noise.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from toponav.config_model import ConfigModel
from toponav.evaluation.metrics import finite_mean, wilson_interval

CONFIDENCE = 0.95
"""Of every interval; `wilson_interval`'s default is the same."""

DRAWS_AT_ONCE = 1_000_000
"""Bounds the memory of a bootstrap: some tens of megabytes whatever the number of episodes."""


class Resampling(ConfigModel):
    """How means are resampled."""

    resamples: int = Field(default=10_000, ge=100)
    """Resamples of the bootstrap."""

    seed: int = Field(default=0, ge=0)
    """Seeds the resampling: the same episodes give the same interval."""

    unit: Literal["episode", "scene"] = "episode"
    """What is drawn: single episodes, as the field does, or whole scenes with all their episodes,
    which does not take the episodes of one house for independent."""


@dataclass(frozen=True)
class Estimate:
    """A figure and how sure it is.

    Attributes:
        value: A rate or a mean; None without data.
        interval: 95 % interval (low, high); None where none can be given.
        n: Episodes that it rests on.
    """

    value: float | None
    interval: tuple[float, float] | None
    n: int


@dataclass(frozen=True)
class PairedOutcomes:
    """The successes of two runs on the same episodes.

    Attributes:
        both: Episodes in which both succeeded.
        first_only: Only the first run succeeded.
        second_only: Only the second run succeeded.
        neither: Both failed.
    """

    both: int
    first_only: int
    second_only: int
    neither: int

    @classmethod
    def of(cls, first: Sequence[bool], second: Sequence[bool]) -> PairedOutcomes:
        """Count the outcomes of episodes that stand in the same order."""
        pairs = list(zip(first, second, strict=True))
        return cls(
            both=pairs.count((True, True)),
            first_only=pairs.count((True, False)),
            second_only=pairs.count((False, True)),
            neither=pairs.count((False, False)),
        )

    @property
    def n(self) -> int:
        """Episodes in all."""
        return self.both + self.first_only + self.second_only + self.neither

    @property
    def p_value(self) -> float:
        """McNemar's exact test, two-sided; 1 where the runs never differ.

        How likely so uneven a split of the episodes in which they differ is, were each as likely
        to go to either run.
        """
        discordant = self.first_only + self.second_only
        if discordant == 0:
            return 1.0
        from scipy.stats import binomtest

        return float(binomtest(self.first_only, discordant).pvalue)


def rate_estimate(successes: int, trials: int) -> Estimate:
    """A rate with Wilson's interval; the value is None without trials."""
    return Estimate(
        successes / trials if trials else None, wilson_interval(successes, trials), trials
    )


def rate_difference(outcomes: PairedOutcomes) -> Estimate:
    """First success rate less the second, with Newcombe's interval for paired rates.

    Method 10 of R. G. Newcombe, "Improved confidence intervals for the difference between binomial
    proportions based on paired data", Statistics in Medicine 17 (1998): the two Wilson intervals,
    joined by the correlation of the outcomes. Unlike a bootstrap it has a width even when no
    episode tells the runs apart.
    """
    n = outcomes.n
    if n == 0:
        return Estimate(None, None, 0)
    first, second = outcomes.both + outcomes.first_only, outcomes.both + outcomes.second_only
    low1, high1 = wilson_interval(first, n)
    low2, high2 = wilson_interval(second, n)
    rate1, rate2 = first / n, second / n
    phi = _correlation(outcomes)
    below = _joined(rate1 - low1, high2 - rate2, phi)
    above = _joined(high1 - rate1, rate2 - low2, phi)
    difference = (outcomes.first_only - outcomes.second_only) / n
    return Estimate(difference, (difference - below, difference + above), n)


def _joined(half1: float, half2: float, phi: float) -> float:
    """Half-width of a difference from those of its parts, which correlate by phi."""
    return math.sqrt(max(0.0, half1**2 - 2.0 * phi * half1 * half2 + half2**2))


def _correlation(outcomes: PairedOutcomes) -> float:
    """Newcombe's phi: Pearson's, with a continuity correction where it is positive."""
    a, b, c, d = outcomes.both, outcomes.first_only, outcomes.second_only, outcomes.neither
    margins = (a + b) * (c + d) * (a + c) * (b + d)
    if margins == 0:
        return 0.0
    product = float(a * d - b * c)
    if product > 0.0:
        product = max(product - outcomes.n / 2.0, 0.0)
    return product / math.sqrt(margins)


def mean_estimates(
    values: NDArray[np.float64], scenes: Sequence[str], resampling: Resampling
) -> list[Estimate]:
    """Means of columns with percentile bootstrap intervals.

    All columns share one resampling. Values that are not finite are left out of their column's
    mean, and `n` counts those that are left. Fewer than two units say nothing about spread: then
    there is no interval. Of differences between two runs this is the paired bootstrap.

    Args:
        values: (N, M), an episode a row.
        scenes: The N episodes' scenes.
        resampling: How.

    Returns:
        M estimates.
    """
    finite = np.isfinite(values)
    unit = _units(scenes, resampling)
    sums = _summed(np.where(finite, values, 0.0), unit)
    counts = _summed(finite.astype(np.float64), unit)
    intervals = _intervals(_resampled_means(sums, counts, resampling))
    return [
        Estimate(
            value=finite_mean(values[:, k].tolist())[0],
            interval=intervals[k] if np.count_nonzero(counts[:, k]) > 1 else None,
            n=int(finite[:, k].sum()),
        )
        for k in range(values.shape[1])
    ]


def _units(scenes: Sequence[str], resampling: Resampling) -> NDArray[np.int64]:
    """(N,) which unit each episode belongs to."""
    if resampling.unit == "episode":
        return np.arange(len(scenes))
    return np.unique(np.array(scenes, dtype=str), return_inverse=True)[1]


def _summed(values: NDArray[np.float64], unit: NDArray[np.int64]) -> NDArray[np.float64]:
    """(U, M) sums of (N, M) values over each unit's episodes."""
    sums = np.zeros((int(unit.max(initial=-1)) + 1, values.shape[1]))
    np.add.at(sums, unit, values)
    return sums


def _resampled_means(
    sums: NDArray[np.float64], counts: NDArray[np.float64], resampling: Resampling
) -> NDArray[np.float64]:
    """(B, M) means of resamples of the U units; NaN where a resample drew nothing finite."""
    units, columns = sums.shape
    means = np.full((resampling.resamples, columns), np.nan)
    if units == 0:
        return means
    rng = np.random.default_rng(resampling.seed)
    both = np.hstack([sums, counts])
    chunk = max(1, DRAWS_AT_ONCE // units)
    for first in range(0, resampling.resamples, chunk):
        rows = min(chunk, resampling.resamples - first)
        drawn = rng.integers(units, size=(rows, units)) + units * np.arange(rows)[:, None]
        times = np.bincount(drawn.ravel(), minlength=rows * units).reshape(rows, units)
        totals = times.astype(np.float64) @ both
        with np.errstate(divide="ignore", invalid="ignore"):
            means[first : first + rows] = totals[:, :columns] / totals[:, columns:]
    return means


def _intervals(means: NDArray[np.float64]) -> list[tuple[float, float] | None]:
    """The percentile interval of each column; None for a column without any mean."""
    tail = (1.0 - CONFIDENCE) / 2.0
    intervals: list[tuple[float, float] | None] = []
    for column in means.T:
        known = column[~np.isnan(column)]
        if len(known):
            low, high = np.quantile(known, (tail, 1.0 - tail))
            intervals.append((float(low), float(high)))
        else:
            intervals.append(None)
    return intervals
