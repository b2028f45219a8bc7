"""Intervals and tests against SciPy, against simulation and against cases worked by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest
import scipy.stats
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import ValidationError

from toponav.evaluation import statistics
from toponav.evaluation.metrics import wilson_interval
from toponav.evaluation.statistics import (
    PairedOutcomes,
    Resampling,
    mean_estimates,
    rate_difference,
    rate_estimate,
)

PLAIN = Resampling(resamples=2_000)
SCENES = Resampling(resamples=2_000, unit="scene")

counts = st.integers(0, 40)
outcomes = st.builds(PairedOutcomes, counts, counts, counts, counts)


def column(*values: float) -> np.ndarray:
    return np.array(values, dtype=np.float64)[:, None]


def test_a_rate_has_wilsons_interval() -> None:
    estimate = rate_estimate(8, 10)
    assert estimate.value == 0.8
    assert estimate.n == 10
    expected = scipy.stats.binomtest(8, 10).proportion_ci(method="wilson")
    assert estimate.interval == pytest.approx((expected.low, expected.high), abs=1e-6)
    assert rate_estimate(0, 0).value is None


def test_the_bootstrap_agrees_with_scipys() -> None:
    values = np.random.default_rng(1).exponential(size=80)
    ours = mean_estimates(values[:, None], ["s"] * 80, Resampling(resamples=20_000))[0]
    reference = scipy.stats.bootstrap(
        (values,), np.mean, method="percentile", n_resamples=20_000, random_state=2
    ).confidence_interval
    assert ours.value == pytest.approx(values.mean())
    assert ours.interval == pytest.approx((reference.low, reference.high), abs=0.02)


def test_the_bootstrap_covers_the_true_mean_as_often_as_it_says() -> None:
    rng = np.random.default_rng(5)
    hits = 0
    for _ in range(300):
        (estimate,) = mean_estimates(
            rng.uniform(size=(40, 1)), ["s"] * 40, Resampling(resamples=400)
        )
        assert estimate.interval is not None
        hits += estimate.interval[0] <= 0.5 <= estimate.interval[1]
    assert 0.90 <= hits / 300 <= 0.98


def test_the_same_seed_gives_the_same_interval_and_another_one_does_not() -> None:
    values = column(*range(30))
    first, again = (mean_estimates(values, ["s"] * 30, PLAIN) for _ in range(2))
    other = mean_estimates(values, ["s"] * 30, PLAIN.model_copy(update={"seed": 1}))
    assert first == again
    assert other != first


def test_drawing_in_pieces_changes_nothing_but_the_memory(monkeypatch: pytest.MonkeyPatch) -> None:
    values = np.random.default_rng(0).normal(size=(50, 1))
    whole = mean_estimates(values, ["s"] * 50, PLAIN)
    monkeypatch.setattr(statistics, "DRAWS_AT_ONCE", 320)
    assert mean_estimates(values, ["s"] * 50, PLAIN) == whole


def test_infinite_values_are_left_out_and_counted() -> None:
    (estimate,) = mean_estimates(column(1.0, 3.0, math.inf, math.nan), ["s"] * 4, PLAIN)
    assert (estimate.value, estimate.n) == (2.0, 2)
    assert estimate.interval == (1.0, 3.0)


@pytest.mark.parametrize("values", [(), (2.0,), (math.inf, math.inf), (2.0, math.inf)])
def test_fewer_than_two_values_have_no_interval(values: tuple[float, ...]) -> None:
    (estimate,) = mean_estimates(np.array(values).reshape(-1, 1), ["s"] * len(values), PLAIN)
    assert estimate.interval is None
    assert estimate.value == (2.0 if 2.0 in values else None)


@given(st.lists(st.floats(-100.0, 100.0), min_size=2, max_size=30))
@settings(max_examples=40)
def test_an_interval_lies_between_the_least_and_the_greatest_value(values: list[float]) -> None:
    (estimate,) = mean_estimates(column(*values), ["s"] * len(values), Resampling(resamples=100))
    assert estimate.interval is not None
    low, high = estimate.interval
    assert min(values) - 1e-9 <= low <= high <= max(values) + 1e-9


def test_scenes_that_are_drawn_whole_give_a_wider_interval_when_their_episodes_are_alike() -> None:
    of_scene = np.random.default_rng(3).normal(size=12)
    values = np.repeat(of_scene, 20)[:, None]
    names = [f"s{k}" for k in range(12) for _ in range(20)]
    plain, clustered = (mean_estimates(values, names, how)[0] for how in (PLAIN, SCENES))
    assert plain.value == clustered.value
    assert plain.interval is not None
    assert clustered.interval is not None
    width = [interval[1] - interval[0] for interval in (plain.interval, clustered.interval)]
    assert width[1] == pytest.approx(width[0] * math.sqrt(20), rel=0.15)


def test_scenes_of_one_episode_each_are_episodes() -> None:
    values = np.random.default_rng(4).normal(size=(30, 1))
    names = [f"s{k:02d}" for k in range(30)]
    assert mean_estimates(values, names, SCENES) == mean_estimates(values, names, PLAIN)
    assert mean_estimates(values, ["one"] * 30, SCENES)[0].interval is None


def test_outcomes_are_counted_in_pairs() -> None:
    first, second = [True, True, False, False, True], [True, False, True, False, False]
    assert PairedOutcomes.of(first, second) == PairedOutcomes(1, 2, 1, 1)
    with pytest.raises(ValueError, match="zip"):
        PairedOutcomes.of(first, second[:-1])


@pytest.mark.parametrize(
    ("won", "lost", "p"), [(0, 0, 1.0), (1, 1, 1.0), (3, 0, 0.25), (6, 0, 2 / 64), (0, 6, 2 / 64)]
)
def test_mcnemar_by_hand(won: int, lost: int, p: float) -> None:
    assert PairedOutcomes(5, won, lost, 7).p_value == pytest.approx(p)


@given(outcomes)
def test_mcnemar_is_the_sum_of_the_splits_that_are_no_likelier(of: PairedOutcomes) -> None:
    n = of.first_only + of.second_only
    chances = [math.comb(n, k) / 2**n for k in range(n + 1)]
    likely = chances[of.first_only]
    assert of.p_value == pytest.approx(sum(c for c in chances if c <= likely * (1 + 1e-9)))


@given(outcomes)
def test_a_difference_lies_in_its_interval_which_mirrors_when_the_runs_change_places(
    of: PairedOutcomes,
) -> None:
    estimate = rate_difference(of)
    if of.n == 0:
        assert estimate.value is None
        return
    assert estimate.value is not None
    assert estimate.interval is not None
    low, high = estimate.interval
    assert -1.0 - 1e-9 <= low <= estimate.value <= high <= 1.0 + 1e-9
    mirrored = rate_difference(PairedOutcomes(of.both, of.second_only, of.first_only, of.neither))
    assert mirrored.interval == pytest.approx((-high, -low))


def test_newcombes_interval_without_correlation_joins_wilsons_by_pythagoras() -> None:
    of = PairedOutcomes(25, 25, 25, 25)  # ad = bc: independent outcomes
    low, high = wilson_interval(50, 100)
    half = math.hypot(0.5 - low, high - 0.5)
    assert rate_difference(of).interval == pytest.approx((-half, half))


def test_newcombes_interval_covers_the_true_difference_as_often_as_it_says() -> None:
    rng = np.random.default_rng(11)
    true = 0.30 - 0.10
    hits = 0
    for both, first, second, neither in rng.multinomial(60, (0.5, 0.3, 0.1, 0.1), size=2_000):
        interval = rate_difference(PairedOutcomes(both, first, second, neither)).interval
        assert interval is not None
        hits += interval[0] <= true <= interval[1]
    assert 0.93 <= hits / 2_000 <= 0.975


def test_agreement_makes_the_paired_interval_narrower() -> None:
    def width(of: PairedOutcomes) -> float:
        interval = rate_difference(of).interval
        assert interval is not None
        return interval[1] - interval[0]

    assert width(PairedOutcomes(45, 5, 5, 45)) < 0.7 * width(PairedOutcomes(25, 25, 25, 25))


@pytest.mark.parametrize("wrong", [{"resamples": 10}, {"seed": -1}, {"unit": "house"}])
def test_a_resampling_that_means_nothing_is_refused(wrong: dict[str, object]) -> None:
    with pytest.raises(ValidationError):
        Resampling.model_validate(wrong)
