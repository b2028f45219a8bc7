"""Dijkstra on 16 neighbours against SciPy's, on a graph that is built another way."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.sparse import coo_array
from scipy.sparse.csgraph import dijkstra

from toponav.control.shortest_paths import (
    EVERYWHERE,
    NEIGHBOURS,
    NO_PARENT,
    costs_between,
    ground_of,
    shortest_paths,
)


def supercover(di: int, dj: int) -> list[tuple[int, int]]:
    """Cells whose inside, or whose corner, the segment between two cells' centres touches."""
    t = np.linspace(0.0, 1.0, 4001)[:, None]
    points = 0.5 + t * np.array([di, dj])
    near = [points + shift for shift in np.array([(1, 1), (1, -1), (-1, 1), (-1, -1)]) * 1e-6]
    return sorted({(int(a), int(b)) for a, b in np.floor(np.concatenate(near))})


MOVES = [(i, j) for i in range(-2, 3) for j in range(-2, 3) if math.gcd(i, j) == 1]


def scipy_costs(traversable: np.ndarray, cell_cost: np.ndarray, seeds: np.ndarray) -> np.ndarray:
    rows, columns = traversable.shape
    begin, end, weight = [], [], []
    for di, dj in MOVES:
        touched = supercover(di, dj)
        for i, j in np.argwhere(traversable):
            cells = [(i + a, j + b) for a, b in touched]
            if all(0 <= a < rows and 0 <= b < columns and traversable[a, b] for a, b in cells):
                begin.append(i * columns + j)
                end.append((i + di) * columns + j + dj)
                mean = 0.5 * (cell_cost[i, j] + cell_cost[i + di, j + dj])
                weight.append(math.hypot(di, dj) * mean)
    n = rows * columns
    graph = coo_array((weight, (begin, end)), shape=(n, n)).tocsr()
    sources = [i * columns + j for i, j in seeds if traversable[i, j]]
    if not sources:
        return np.full((rows, columns), np.inf)
    return dijkstra(graph, indices=sources, min_only=True).reshape(rows, columns)


def random_case(seed: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    shape = tuple(rng.integers(1, 18, 2))
    traversable = rng.random(shape) < rng.uniform(0.5, 1.0)
    cell_cost = rng.uniform(0.1, 2.0, shape)
    seeds = np.stack([rng.integers(0, shape[k], 3) for k in range(2)], axis=-1)
    return traversable, cell_cost, seeds


@pytest.mark.parametrize("seed", range(25))
def test_costs_are_scipys(seed: int) -> None:
    traversable, cell_cost, seeds = random_case(seed)
    cost, _ = shortest_paths(ground_of(traversable, cell_cost), seeds, EVERYWHERE)
    np.testing.assert_allclose(cost, scipy_costs(traversable, cell_cost, seeds), rtol=1e-12)


@pytest.mark.parametrize("seed", range(25))
def test_following_the_parents_costs_what_the_field_says(seed: int) -> None:
    traversable, cell_cost, seeds = random_case(seed)
    cost, parent = shortest_paths(ground_of(traversable, cell_cost), seeds, EVERYWHERE)
    columns = traversable.shape[1]
    for i, j in np.argwhere(np.isfinite(cost)):
        total, cell = 0.0, (int(i), int(j))
        while parent[cell] != NO_PARENT:
            after = divmod(int(parent[cell]), columns)
            total += math.dist(cell, after) * 0.5 * (cell_cost[cell] + cell_cost[after])
            cell = after
        assert list(cell) in seeds.tolist()
        assert total == pytest.approx(cost[i, j])
    assert (parent[~np.isfinite(cost)] == NO_PARENT).all()


def test_the_order_of_the_seeds_does_not_matter() -> None:
    ground = ground_of(np.ones((15, 15), np.bool_), np.ones((15, 15)))
    seeds = np.array([(0, 0), (14, 14), (0, 14)])
    forward, backward = (shortest_paths(ground, s, EVERYWHERE) for s in (seeds, seeds[::-1]))
    np.testing.assert_array_equal(forward[0], backward[0])
    np.testing.assert_array_equal(forward[1], backward[1])


@pytest.mark.parametrize("seed", range(25))
def test_a_search_that_ends_early_agrees_as_far_as_it_went(seed: int) -> None:
    traversable, cell_cost, seeds = random_case(seed)
    ground = ground_of(traversable, cell_cost)
    everything, parents = shortest_paths(ground, seeds, EVERYWHERE)
    wanted = np.argwhere(np.isfinite(everything))[-3:]
    cost, parent = shortest_paths(ground, seeds, (wanted, 0.5))
    limit = everything[tuple(wanted.T)].max(initial=-np.inf) + 0.5 if len(wanted) else np.inf
    np.testing.assert_array_equal(cost, np.where(everything <= limit, everything, np.inf))
    np.testing.assert_array_equal(parent, np.where(everything <= limit, parents, NO_PARENT))


def test_no_seed_reaches_nothing() -> None:
    ground = ground_of(np.ones((4, 5), np.bool_), np.ones((4, 5)))
    cost, parent = shortest_paths(ground, np.zeros((0, 2), np.int64), EVERYWHERE)
    assert np.isinf(cost).all()
    assert (parent == NO_PARENT).all()


def test_lengths_stay_within_three_percent_of_straight_ones() -> None:
    n = 61
    ground = ground_of(np.ones((n, n), np.bool_), np.ones((n, n)))
    cost, _ = shortest_paths(ground, np.array([(n // 2, n // 2)]), EVERYWHERE)
    i, j = np.indices((n, n)) - n // 2
    straight = np.hypot(i, j)
    assert (cost >= straight - 1e-9).all()
    assert (cost <= 1.03 * straight + 1e-9).all()


def test_the_neighbours_are_all_moves_of_at_most_two_that_pass_no_cell_centre() -> None:
    assert sorted(map(tuple, NEIGHBOURS.tolist())) == sorted(MOVES)


@pytest.mark.parametrize("within", [math.inf, 3.0])
@pytest.mark.parametrize("seed", range(15))
def test_costs_between_cells_are_those_of_searches_from_each(seed: int, within: float) -> None:
    traversable, cell_cost, cells = random_case(seed)
    cells = np.vstack([cells, cells[:1]])
    limits = np.full((len(cells), len(cells)), within)
    ground = ground_of(traversable, cell_cost)
    known, _ = shortest_paths(ground, np.argwhere(traversable)[:1], EVERYWHERE)
    between = costs_between(ground, cells, limits, known)
    for k, cell in enumerate(cells):
        cost, _ = shortest_paths(ground, cell[None], EVERYWHERE)
        expected = cost[tuple(cells.T)]
        np.testing.assert_allclose(between[k], np.where(expected <= within, expected, np.inf))
