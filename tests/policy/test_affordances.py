"""Section III-E's terms against brute force, hand-worked maps and their stated properties."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from policy_maps import make_view
from pydantic import ValidationError

from toponav.policy.affordances import (
    AffordanceConfig,
    acquisition,
    exploration,
    normalized_affordance,
)

EPSILON = 1e-6
NOTHING = np.zeros((0, 3))


def clouds(min_size: int = 1) -> st.SearchStrategy[np.ndarray]:
    coordinates = st.floats(-10, 10, width=32).map(lambda x: round(x, 3))
    shapes = st.integers(min_size, 12).map(lambda n: (n, 3))
    return hnp.arrays(np.float32, shapes, elements=coordinates.map(np.float32))


def brute_force(points: np.ndarray, targets: np.ndarray) -> np.ndarray:
    """N(d) straight from the paper's definition."""
    d = np.linalg.norm(
        points[:, None].astype(np.float64) - targets[None].astype(np.float64), axis=-1
    ).min(axis=1)
    return 1.0 - (d - d.min()) / (d.max() - d.min() + EPSILON)


@given(clouds(), clouds())
def test_the_normalized_affordance_is_the_papers(points: np.ndarray, targets: np.ndarray) -> None:
    # Nearly equal distances divide rounding errors by epsilon, hence the absolute tolerance.
    got = normalized_affordance(points, targets, EPSILON)
    np.testing.assert_allclose(got, brute_force(points, targets), atol=1e-6)
    assert got.max() == 1.0
    assert got.min() >= 0.0


@given(clouds(), clouds())
def test_a_point_nearer_to_the_targets_is_worth_no_less(
    points: np.ndarray, targets: np.ndarray
) -> None:
    distance = np.linalg.norm(
        points[:, None].astype(np.float64) - targets[None].astype(np.float64), axis=-1
    ).min(axis=1)
    value = normalized_affordance(points, targets, EPSILON)
    assert (np.diff(value[np.argsort(distance)]) <= 1e-6).all()


def test_equal_distances_are_all_worth_one() -> None:
    ring = np.array([[1, 0, 0], [0, 1, 0], [-1, 0, 0]], np.float32)
    assert normalized_affordance(ring, np.zeros((1, 3)), EPSILON).tolist() == [1.0, 1.0, 1.0]


@pytest.mark.parametrize("points", [NOTHING, np.ones((4, 3))])
def test_an_empty_set_gives_zeros(points: np.ndarray) -> None:
    assert normalized_affordance(points, NOTHING, EPSILON).tolist() == [0.0] * len(points)


CORRIDOR = np.stack([np.arange(5.0), np.zeros(5), np.zeros(5)], axis=-1)
"""Five floor points one metre apart along x."""


def test_exploration_terms_by_hand() -> None:
    view = make_view(CORRIDOR, frontiers=[(4.0, 0.0, 0.0)])
    result = exploration(
        view,
        direction_points=np.array([[2.0, 0.0, 0.0]]),
        node_frontiers=np.array([[3.0, 0.0, 0.0]]),
        history=np.array([[0.0, 0.0, 0.0]]),
        config=AffordanceConfig(),
    )
    expected = {
        "dir": [0, 0.5, 1, 0.5, 0],
        "node": [0, 1 / 3, 2 / 3, 1, 2 / 3],
        "front": [0, 0.25, 0.5, 0.75, 1],
        "hist": [0, 0.25, 0.5, 0.75, 1],
    }
    assert list(result.terms) == list(expected)
    for name, values in expected.items():
        np.testing.assert_allclose(result.terms[name], values, atol=1e-5)
    np.testing.assert_allclose(result.total, np.sum(list(expected.values()), axis=0), atol=1e-5)


def test_acquisition_terms_by_hand() -> None:
    view = make_view(CORRIDOR)
    target, direction = np.array([[4.0, 0.0, 0.0]]), np.array([[0.0, 0.0, 0.0]])
    result = acquisition(view, direction, target, AffordanceConfig(weight_dir=0.5))
    assert list(result.terms) == ["dir", "sem"]
    np.testing.assert_allclose(result.terms["dir"], [1, 0.75, 0.5, 0.25, 0], atol=1e-5)
    np.testing.assert_allclose(result.terms["sem"], [0, 0.25, 0.5, 0.75, 1], atol=1e-5)
    np.testing.assert_allclose(result.total, [0.5, 0.625, 0.75, 0.875, 1], atol=1e-5)


@pytest.mark.parametrize("term", ["dir", "node", "front", "hist"])
def test_a_zero_weight_ablates_a_term_and_leaves_it_recorded(term: str) -> None:
    view = make_view(CORRIDOR, frontiers=[(4.0, 0.0, 0.0)])
    sets = (CORRIDOR[2:3], CORRIDOR[3:4], CORRIDOR[:1])
    full = exploration(view, *sets, AffordanceConfig())
    ablated = exploration(view, *sets, AffordanceConfig(**{f"weight_{term}": 0.0}))
    np.testing.assert_allclose(full.total - ablated.total, full.terms[term], atol=1e-12)
    np.testing.assert_array_equal(ablated.terms[term], full.terms[term])


def test_every_term_of_an_empty_set_is_zero_history_included() -> None:
    result = exploration(make_view(CORRIDOR), NOTHING, NOTHING, NOTHING, AffordanceConfig())
    assert all(not term.any() for term in result.terms.values())
    assert result.safe.all()
    assert not result.total.any()


def test_a_map_without_floor_has_no_affordances() -> None:
    result = exploration(make_view(), CORRIDOR, CORRIDOR, CORRIDOR, AffordanceConfig())
    assert result.points.shape == (0, 3)
    assert result.total.shape == result.safe.shape == (0,)


def test_points_near_obstacles_are_zeroed_and_far_ones_kept() -> None:
    """The mask follows the paper's text; its formula, read literally, would do the opposite."""
    view = make_view(CORRIDOR, obstacles=[(0.0, 0.0, 0.5)], frontiers=[(0.0, 0.0, 0.0)])
    result = exploration(view, NOTHING, NOTHING, NOTHING, AffordanceConfig(sigma=0.3))
    # 1 - A_obs is about 0, 0.18, 0.43, 0.71, 1: the distances are 0.5, 1.12, 2.06, 3.04, 4.03.
    assert result.safe.tolist() == [False, False, True, True, True]
    np.testing.assert_array_equal(result.total, np.where(result.safe, result.terms["front"], 0))
    assert result.terms["front"][0] == 1.0


@given(st.floats(0.0, 0.9), st.floats(0.0, 0.9))
def test_a_larger_sigma_keeps_no_more_points(a: float, b: float) -> None:
    low, high = sorted((a, b))
    obstacles = [(0.0, 0.0, 0.5)]
    kept = [
        exploration(
            make_view(CORRIDOR, obstacles), NOTHING, NOTHING, NOTHING, AffordanceConfig(sigma=s)
        ).safe
        for s in (low, high)
    ]
    assert not (kept[1] & ~kept[0]).any()


@pytest.mark.parametrize("length", [2.0, 20.0, 200.0])
def test_the_metric_clearance_holds_in_maps_of_every_size(length: float) -> None:
    x = np.array([0.1, 0.17, 0.19, 1.0, length])
    floor = np.stack([x, 0 * x, 0 * x], axis=-1)
    config = AffordanceConfig(sigma=0.0)
    result = exploration(
        make_view(floor, obstacles=[(0.0, 0.0, 0.5)]), NOTHING, NOTHING, NOTHING, config
    )
    assert result.safe.tolist() == [False, False, True, True, True]


@pytest.mark.parametrize(
    "values", [{"sigma": 1.0}, {"weight_dir": -1.0}, {"epsilon": 0.0}, {"weight_obs": 1.0}]
)
def test_impossible_values_are_refused(values: dict[str, float]) -> None:
    with pytest.raises(ValidationError):
        AffordanceConfig(**values)
