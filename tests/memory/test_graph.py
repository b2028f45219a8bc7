from __future__ import annotations

import math

import pytest

from toponav.errors import InputError
from toponav.memory.graph import TopologicalMemory, path_lengths
from toponav.memory.snapshot import UNKNOWN_ROOM, EdgeView, NodeView


def chain(*positions: tuple[float, float]) -> TopologicalMemory:
    memory = TopologicalMemory()
    for position in positions:
        node = memory.add_node(position, floor=0)
        memory.record_arrival(node.id)
        if node.id > 1:
            memory.connect(node.id - 1, node.id, 2.0, 1.0)
    return memory


def test_ids_start_at_one_and_are_never_reused():
    memory = chain((0, 0), (1, 0))
    memory.merge(1, 2)
    assert memory.add_node((5, 5), 0).id == 3


def test_merging_averages_positions_keeps_the_first_and_passes_edges_on():
    memory = chain((0, 0), (5, 0), (10, 0), (0, 1))
    memory.connect(2, 4, 9.0, 9.0)
    memory.connect(1, 2, 7.0, 0.5)
    merged = memory.merge(4, 1)
    assert (merged.id, merged.position, merged.visits) == (1, (0.0, 0.5), 2)
    assert memory.history == (1, 2, 3, 1)
    assert 4 not in memory
    assert memory.edges == (
        EdgeView(1, 2, 2.0, 0.5),
        EdgeView(1, 3, 2.0, 1.0),
        EdgeView(2, 3, 2.0, 1.0),
    )


def test_merging_unites_what_is_known_until_it_is_recomputed():
    memory = chain((0, 0), (1, 0))
    memory.describe_node(1, objects=("bed", "lamp"), frontier_count=2)
    memory.describe_node(2, objects=("bed", "chair"), frontier_count=7)
    merged = memory.merge(1, 2)
    assert (merged.objects, merged.frontier_count) == (("bed", "chair", "lamp"), 7)


def test_merging_neighbours_leaves_no_self_loop():
    memory = chain((0, 0), (1, 0), (2, 0))
    memory.merge(1, 2)
    assert memory.edges == (EdgeView(1, 3, 2.0, 1.0),)


@pytest.mark.parametrize(
    ("first", "later", "kept"),
    [
        ("kitchen", "bedroom", "kitchen"),
        (UNKNOWN_ROOM, "bedroom", "bedroom"),
        ("kitchen", UNKNOWN_ROOM, "kitchen"),
    ],
)
def test_merging_keeps_the_earliest_known_room(first, later, kept):
    memory = chain((0, 0), (1, 0))
    memory.describe_node(1, room_type=first)
    memory.describe_node(2, room_type=later)
    assert memory.merge(2, 1).room_type == kept


@pytest.mark.parametrize("length", [-1.0, math.inf, math.nan])
def test_lengths_must_be_finite_and_not_negative(length):
    memory = chain((0, 0), (1, 0))
    with pytest.raises(InputError, match="length"):
        memory.connect(1, 2, 1.0, length)
    with pytest.raises(InputError, match="length"):
        memory.set_geodesic(1, 2, length)


def test_unknown_nodes_and_self_loops_are_errors():
    memory = chain((0, 0))
    with pytest.raises(InputError, match="no node 7"):
        memory.connect(1, 7, 1.0, 1.0)
    with pytest.raises(InputError, match="itself"):
        memory.connect(1, 1, 1.0, 1.0)
    with pytest.raises(InputError, match="itself"):
        memory.merge(1, 1)
    with pytest.raises(InputError, match="no node 7"):
        memory.record_arrival(7)


def test_parts_rebuild_the_memory():
    memory = chain((0, 0), (5, 0), (0, 1))
    memory.merge(1, 3)
    again = TopologicalMemory.from_parts(memory.nodes, memory.edges, memory.history, memory.next_id)
    assert again.nodes == memory.nodes
    assert again.edges == memory.edges
    assert again.history == memory.history
    assert again.add_node((0, 0), 0).id == 4


NODE = NodeView(1, (0.0, 0.0), 0, (), UNKNOWN_ROOM, 0, 1)
OTHER = NodeView(2, (1.0, 0.0), 0, (), UNKNOWN_ROOM, 0, 0)


@pytest.mark.parametrize(
    ("nodes", "edges", "history", "next_id", "message"),
    [
        ([NODE, NODE], [], [1], 3, "repeated"),
        ([NODE, OTHER], [], [1], 2, "node id 2"),
        ([NODE, OTHER], [EdgeView(2, 1, 1.0, 1.0)], [1], 3, "smaller id"),
        ([NODE, OTHER], [EdgeView(1, 2, 1.0, 1.0)] * 2, [1], 3, "repeated"),
        ([NODE], [EdgeView(1, 2, 1.0, 1.0)], [1], 3, "no node 2"),
        ([NODE], [], [1, 9], 3, "no node 9"),
        ([NODE, OTHER], [], [1, 2], 3, "visits"),
    ],
)
def test_parts_that_break_an_invariant_are_refused(nodes, edges, history, next_id, message):
    with pytest.raises(InputError, match=message):
        TopologicalMemory.from_parts(nodes, edges, history, next_id)


def test_path_lengths_take_the_shortest_way_and_skip_what_is_not_connected():
    edges = [
        EdgeView(1, 2, 9.0, 1.0),
        EdgeView(2, 3, 9.0, 1.5),
        EdgeView(1, 3, 9.0, 4.0),
        EdgeView(4, 5, 1.0, 1.0),
    ]
    assert path_lengths(edges, 1) == {1: 0.0, 2: 1.0, 3: 2.5}
    assert path_lengths([], 8) == {8: 0.0}
