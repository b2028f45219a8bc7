"""What is overlooked: rates and their persistence."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from toponav.perception.draws import Draws
from toponav.perception.eyesight import FAULTLESS, Eyesight

sizes = st.floats(1e-3, 1.0)
ranges = st.floats(0.1, 30.0)
chances = st.sampled_from([0.1, 0.5, 0.9])


@given(small=sizes, large=sizes, near=ranges, far=ranges)
def test_larger_and_nearer_things_are_found_more_often(
    small: float, large: float, near: float, far: float
) -> None:
    sight = Eyesight()
    small, large = sorted((small, large))
    near, far = sorted((near, far))
    assert 0.0 <= sight.recall(small, far) <= sight.recall(large, near) <= sight.largest_recall
    assert sight.recall(small, near, cut=True) <= sight.recall(small, near)


def test_the_curve_passes_through_its_parameters() -> None:
    sight = Eyesight(largest_recall=0.9, half_size=0.05, half_range_m=8.0, cut_recall=0.5)
    assert sight.recall(0.05, 0.1) == pytest.approx(0.45, abs=1e-6)
    assert sight.recall(0.05, 8.0) == pytest.approx(0.225)
    assert sight.recall(0.05, 0.1, cut=True) == pytest.approx(0.225, abs=1e-6)
    assert FAULTLESS.recall(1e-3, 30.0, cut=True) == pytest.approx(1.0)


def outcomes(sight: Eyesight, chance: float) -> np.ndarray:
    """(things, sides, images) found or not."""
    draws = Draws(11)
    found = [
        [[sight.happens(draws, (thing,), (side, 0), image, chance) for image in range(4)]
         for side in range(3)]
        for thing in range(400)
    ]  # fmt: skip
    return np.array(found)


@pytest.mark.parametrize("chance", [0.2, 0.6, 0.95])
def test_the_chance_is_kept_whatever_the_shares(chance: float) -> None:
    for shares in ((0.0, 0.0), (0.45, 0.35), (0.0, 1.0)):
        found = outcomes(Eyesight(object_share=shares[0], side_share=shares[1]), chance)
        independent = found.reshape(400, -1).mean(axis=1)
        assert found.mean() == pytest.approx(chance, abs=4.0 * independent.std() / np.sqrt(400))


def test_misses_persist_most_from_the_same_side() -> None:
    found = outcomes(Eyesight(), 0.6)
    from_side = (found[:, 0, 0] == found[:, 0, 1]).mean()
    of_thing = (found[:, 0, 0] == found[:, 1, 0]).mean()
    by_chance = 0.6**2 + 0.4**2
    assert from_side > of_thing + 0.05 > by_chance + 0.1


def test_without_shares_of_its_own_an_image_never_changes_the_outcome() -> None:
    found = outcomes(Eyesight(object_share=0.4, side_share=0.6), 0.6)
    assert (found == found[:, :, :1]).all()
    assert not (found == found[:, :1]).all()


def test_shares_beyond_the_whole_are_refused() -> None:
    with pytest.raises(ValueError, match="must not exceed 1"):
        Eyesight(object_share=0.6, side_share=0.6)
