"""Shapes that cannot be what a detector says."""

from __future__ import annotations

import numpy as np
import pytest

from toponav.policy.plausibility import MIN_POINTS, implausibilities

FLOOR_Z = 2.8
"""Of the storey that the thing is on."""


def block(x_m: float, y_m: float, low_m: float, high_m: float) -> np.ndarray:
    """Points 5 cm apart of a block, its lower end so high above the floor."""
    axes = [np.arange(0.0, max(side, 0.01), 0.05) for side in (x_m, y_m, high_m - low_m)]
    points = np.stack(np.meshgrid(*axes), axis=-1).reshape(-1, 3)
    return points + np.array([4.0, -1.0, FLOOR_Z + low_m])


def seat(x_m: float, y_m: float, seat_m: float, back_m: float) -> np.ndarray:
    """A block with a back along its longer side, a quarter of it deep."""
    return np.concatenate([block(x_m, y_m, 0.1, seat_m), block(x_m, y_m / 4.0, seat_m, back_m)])


def ways(points: np.ndarray, category: str, *, all_round: bool = True) -> int:
    return implausibilities(points, FLOOR_Z, category, all_round=all_round)


@pytest.mark.parametrize(
    ("category", "thing"),
    [
        ("sofa", seat(1.8, 0.8, 0.45, 0.8)),
        ("chair", seat(0.45, 0.45, 0.45, 0.9)),
        ("chair", block(0.1, 0.45, 0.5, 0.9)),  # no more than the back is seen
        ("bed", block(1.6, 2.0, 0.45, 0.5)),  # no more than the mattress is seen
        ("toilet", block(0.4, 0.6, 0.0, 0.75)),
        ("tv_monitor", block(1.1, 0.0, 1.2, 1.8)),
        ("tv_monitor", block(1.1, 0.3, 0.0, 1.1)),  # with the stand below it
        ("plant", block(0.3, 0.3, 1.5, 2.0)),
        ("picture", block(0.6, 0.0, 1.4, 1.8)),
    ],
)
def test_things_as_they_stand_in_homes_are_plausible(category: str, thing: np.ndarray) -> None:
    assert ways(thing, category) == 0


@pytest.mark.parametrize(
    ("category", "thing"),
    [
        ("sofa", seat(0.3, 0.3, 0.1, 0.6)),  # too small
        ("sofa", block(1.6, 0.4, 0.1, 0.7)),  # a stand for a television
        ("chair", block(0.9, 0.6, 0.35, 0.55)),  # a coffee table
        ("chair", block(1.4, 0.8, 0.65, 0.75)),  # a table
        ("bed", seat(1.8, 0.8, 0.45, 0.8)),  # a sofa
        ("toilet", seat(1.5, 0.7, 0.3, 0.55)),  # a bath
        ("tv_monitor", block(0.3, 0.1, 0.75, 0.95)),  # a laptop
        ("tv_monitor", block(0.6, 0.0, 0.1, 0.85)),  # the front of an oven
        ("plant", block(0.7, 0.0, 1.3, 1.9)),  # a poster of one
        ("toilet", block(0.4, 0.4, 0.95, 1.35)),  # too high up
        ("bed", block(2.7, 0.1, 0.2, 2.5)),  # the walls of a corridor
    ],
)
def test_one_thing_is_wrong_with_it(category: str, thing: np.ndarray) -> None:
    assert ways(thing, category) == 1


def test_several_things_may_be_wrong() -> None:
    assert ways(block(0.2, 0.0, 2.0, 2.2), "sofa") == 4


def test_from_one_side_the_back_of_a_chair_is_as_flat_as_a_picture() -> None:
    back = block(0.0, 0.45, 0.1, 0.9)
    assert ways(back, "chair", all_round=False) == 0
    assert ways(back, "chair") == 1


def test_of_a_few_points_nothing_is_said() -> None:
    assert ways(block(0.3, 0.3, 2.0, 2.2)[: MIN_POINTS - 1], "sofa") == 0
