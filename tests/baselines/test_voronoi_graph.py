"""The reduced Voronoi graph: thinning, junctions and ends, short lines contracted, ways."""

from __future__ import annotations

import networkx as nx
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.ndimage import label

from drawn_map import drawn_map
from toponav.baselines.voronoi_graph import EIGHT, VoronoiGraph, thinned, voronoi_graph
from toponav.mapping.view import FREE

CORRIDORS = drawn_map(
    "###############",
    "#.............#",
    "######...######",
    "     #...#     ",
    "     #...#     ",
    "     #...#     ",
    "     #####     ",
    enlarged=5,
)
"""A corridor along x, 6.5 m long, and one down from its middle."""


def graph_of(merge_m: float) -> VoronoiGraph:
    return voronoi_graph(CORRIDORS.grid.cells == FREE, CORRIDORS.grid, merge_m)


def test_a_crossing_becomes_one_node_joined_to_its_three_ends() -> None:
    graph = graph_of(merge_m=0.8)
    degrees = sorted(degree for _, degree in graph.graph.degree())
    assert degrees == [1, 1, 1, 3]
    middle = graph.nodes[next(node for node, degree in graph.graph.degree() if degree == 3)]
    np.testing.assert_allclose(middle, [3.75, 0.75], atol=0.4)
    ends = graph.nodes[[node for node, degree in graph.graph.degree() if degree == 1]]
    for xy in ((0.6, 0.75), (6.9, 0.75), (3.75, 2.6)):
        assert np.hypot(*(ends - xy).T).min() <= 0.5


def test_lengths_are_those_of_the_lines() -> None:
    graph = graph_of(merge_m=0.8)
    for first, second, data in graph.graph.edges(data=True):
        straight = float(np.hypot(*(graph.nodes[first] - graph.nodes[second])))
        assert data["length"] == pytest.approx(straight, abs=0.4)


@pytest.mark.parametrize("merge_m", [0.0, 0.5, 1.5, 100.0])
def test_no_line_shorter_than_the_merge_distance_is_left(merge_m: float) -> None:
    graph = graph_of(merge_m)
    assert all(data["length"] >= merge_m for *_, data in graph.graph.edges(data=True))
    assert nx.is_connected(graph.graph)


def test_the_neighbours_on_the_ways_to_goals_are_told() -> None:
    line: nx.Graph[int] = nx.path_graph(4)
    nx.set_edge_attributes(line, 1.0, "length")
    graph = VoronoiGraph(np.column_stack([np.arange(4.0), np.zeros(4)]), line)
    assert graph.nearest((1.2, 5.0)) == 1
    assert graph.leads_to(1, frozenset({3})) == {2}
    assert graph.leads_to(1, frozenset({0, 3})) == {0, 2}
    assert graph.leads_to(1, frozenset({1})) == frozenset()


def test_nothing_free_is_an_empty_graph() -> None:
    graph = voronoi_graph(np.zeros((4, 4), np.bool_), CORRIDORS.grid, 0.5)
    assert graph.nodes.shape == (0, 2)


@given(st.integers(0, 2**32 - 1), st.floats(0.3, 0.9))
def test_thinning_keeps_the_pieces_and_adds_nothing(seed: int, share: float) -> None:
    free: NDArray[np.bool_] = np.random.default_rng(seed).random((12, 15)) < share
    line = thinned(free)
    assert not (line & ~free).any()
    pieces, count = label(free, structure=EIGHT)
    kept = set(np.unique(pieces[line])) - {0}
    # Zhang and Suen's rule takes a lone square of four cells away; nothing else may vanish.
    for piece in set(range(1, count + 1)) - kept:
        assert (pieces == piece).sum() == 4
    assert label(line, structure=EIGHT)[1] == len(kept)
    np.testing.assert_array_equal(thinned(line), line)
