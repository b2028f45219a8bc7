"""Draws that depend on what they are about."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import kstest

from toponav.perception.draws import Draws, blended, key_of

keys = st.integers(-(2**62), 2**62)


@given(seed=st.integers(0, 2**40), key=keys, other=keys)
def test_a_draw_is_a_function_of_seed_stream_and_keys(seed: int, key: int, other: int) -> None:
    draw = Draws(seed).uniform("a", key, other)
    assert 0.0 < draw < 1.0
    assert draw == Draws(seed).uniform("a", key, other)
    assert draw != Draws(seed + 1).uniform("a", key, other)
    assert draw != Draws(seed).uniform("b", key, other)
    if key != other:
        assert draw != Draws(seed).uniform("a", other, key)


def test_arrays_of_keys_are_drawn_as_their_elements_are() -> None:
    rows, columns = np.arange(-3, 4)[:, None], np.array([0, 5, 2**40])
    table = Draws(7).uniform("a", rows, columns)
    assert table.shape == (7, 3)
    assert table[2, 1] == Draws(7).uniform("a", -1, 5)


@pytest.mark.parametrize("count", [4000])
def test_draws_are_uniform_and_uncorrelated_even_for_neighbouring_keys(count: int) -> None:
    draws = Draws(1).uniform("a", np.arange(count))
    assert kstest(draws, "uniform").pvalue > 0.01
    assert abs(np.corrcoef(draws[:-1], draws[1:])[0, 1]) < 4.0 / np.sqrt(count)
    assert kstest(Draws(1).normal("a", np.arange(count)), "norm").pvalue > 0.01


def test_a_blend_is_uniform_and_as_correlated_as_its_shares_say() -> None:
    draws, things = Draws(3), np.arange(4000)
    common = draws.normal("common", things)
    blends = [blended((0.6, 0.4), (common, draws.normal("own", things, k))) for k in (0, 1)]
    assert all(kstest(blend, "uniform").pvalue > 0.01 for blend in blends)
    # Normal scores with correlation r have Spearman's 6 / pi asin(r / 2).
    expected = 6.0 / np.pi * np.arcsin(0.6 / 2.0)
    assert np.corrcoef(*blends)[0, 1] == pytest.approx(expected, abs=0.03)


def test_keys_of_names_differ() -> None:
    assert len({key_of(name) for name in ("bed", "sofa", b"sofa", "chair")}) == 3
