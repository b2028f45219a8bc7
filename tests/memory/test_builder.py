from __future__ import annotations

import math
from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from memory_maps import make_map, open_grid, two_rooms

from toponav.errors import InputError
from toponav.mapping.view import OCCUPIED, OccupancyGrid
from toponav.memory.builder import MemoryBuilder, MemoryConfig
from toponav.memory.snapshot import UNKNOWN_ROOM
from toponav.memory.traversability import is_clear

coordinate = st.floats(-4.0, 4.0, allow_subnormal=False)
walks = st.lists(st.tuples(coordinate, coordinate), min_size=1, max_size=25)


def walled_grid() -> OccupancyGrid:
    """A wall along x = 0 with a gap around the origin."""
    grid = open_grid()
    middle = grid.cells.shape[0] // 2
    grid.cells[middle, : middle - 5] = OCCUPIED
    grid.cells[middle, middle + 5 :] = OCCUPIED
    return grid


@given(walks)
@settings(max_examples=60)
def test_walks_keep_every_invariant(walk):
    view = make_map(grid=walled_grid())
    config = MemoryConfig()
    builder = MemoryBuilder(config)
    arrivals = [builder.arrive(position, view, 1.0) for position in walk]
    memory = builder.memory
    assert arrivals[-1] == memory.history[-1]
    assert len(memory.history) == len(walk) == sum(node.visits for node in memory.nodes)
    for node in memory.nodes:
        assert node.visits == memory.history.count(node.id)
    for a, b in combinations(memory.nodes, 2):
        near = math.dist(a.position, b.position) < config.d_merge
        assert not (near and is_clear(view.grid, a.position, b.position))
    joined = {(edge.source, edge.target) for edge in memory.edges}
    for a, b in zip(memory.history, memory.history[1:], strict=False):
        assert a == b or (min(a, b), max(a, b)) in joined
    for edge in memory.edges:
        ends = memory.node(edge.source).position, memory.node(edge.target).position
        assert edge.geodesic_m >= math.dist(*ends) - 1e-9


def test_nodes_merge_at_their_centroid_under_the_earliest_id():
    view = make_map()
    builder = MemoryBuilder(MemoryConfig(d_merge=1.0))
    assert builder.arrive((0.0, 0.0), view, 0.0) == 1
    assert builder.arrive((3.0, 0.0), view, 3.0) == 2
    assert builder.arrive((0.6, 0.0), view, 2.4) == 1
    assert builder.memory.node(1).position == (0.3, 0.0)
    assert builder.memory.history == (1, 2, 1)


def test_a_distance_of_exactly_d_merge_does_not_merge():
    view = make_map()
    builder = MemoryBuilder(MemoryConfig(d_merge=1.0))
    builder.arrive((0.0, 0.0), view, 0.0)
    assert builder.arrive((1.0, 0.0), view, 1.0) == 2


def test_a_wall_between_keeps_nodes_apart():
    builder = MemoryBuilder(MemoryConfig())
    view = make_map(grid=walled_grid())
    builder.arrive((-0.3, 3.0), view, 0.0)
    assert builder.arrive((0.4, 3.0), view, 8.0) == 2
    assert builder.arrive((-0.3, 3.4), view, 8.0) == 1


def test_floors_never_merge():
    builder = MemoryBuilder(MemoryConfig())
    builder.arrive((0.0, 0.0), make_map(), 0.0)
    upstairs = builder.arrive((0.1, 0.0), make_map(floor=1, floor_z=2.7), 6.0)
    assert builder.memory.node(upstairs).floor == 1
    assert [edge.geodesic_m for edge in builder.memory.edges] == [6.0]


def test_merging_goes_on_until_nothing_is_left_to_merge():
    view = make_map()
    builder = MemoryBuilder(MemoryConfig(d_merge=1.0))
    builder.arrive((0.0, 0.0), view, 0.0)
    builder.arrive((1.5, 0.0), view, 1.5)
    # 0.8 joins 1.5 at 1.15, which is out of reach of 0; from there 0.7 lands at 0.925.
    assert builder.arrive((0.8, 0.0), view, 0.7) == 2
    assert builder.memory.node(2).position == pytest.approx((1.15, 0.0))
    assert builder.arrive((0.7, 0.0), view, 0.4) == 1
    assert builder.memory.node(1).position == pytest.approx((0.4625, 0.0))
    assert builder.memory.history == (1, 1, 1, 1)
    assert builder.memory.edges == ()


@given(walks, st.integers(0, 2**32 - 1))
@settings(max_examples=30)
def test_objects_and_frontiers_match_brute_force(walk, seed):
    rng = np.random.default_rng(seed)
    objects = {
        name: rng.uniform((-6, -6, -1), (6, 6, 4), (20, 3)).round(2).tolist()
        for name in ("bed", "chair", "sofa")
    }
    view = make_map(objects=objects, frontiers=rng.uniform(-6, 6, (40, 3)), floor_z=0.5)
    config = MemoryConfig(r_topo=2.0, min_object_points=2)
    builder = MemoryBuilder(config)
    for position in walk:
        here = builder.arrive(position, view, 1.0)
    before = builder.memory.node(here)
    builder.refresh(view)
    assert builder.memory.node(here) == before
    for node in builder.memory.nodes:
        near = {
            name: sum(
                0.2 <= np.float32(z) <= 3.0
                and math.dist((np.float32(x), np.float32(y)), node.position) < 2.0
                for x, y, z in points
            )
            for name, points in objects.items()
        }
        assert node.objects == tuple(sorted(n for n, count in near.items() if count >= 2))
        frontiers = [f for f in view.frontiers if math.dist(f[:2], node.position) < 2.0]
        assert node.frontier_count == len(frontiers)
        assert builder.frontier_points_of(node.id, view).tolist() == [f.tolist() for f in frontiers]


def test_refresh_leaves_other_floors_as_they_were():
    builder = MemoryBuilder(MemoryConfig())
    down = builder.arrive((0.0, 0.0), make_map({"bed": [(1, 0, 0.3)]}, [(0, 1, 0)]), 0.0)
    upstairs = make_map({"bed": [(1, 0, 0.3)], "sofa": [(1, 0, 3.0)]}, floor=1, floor_z=2.7)
    up = builder.arrive((0.0, 0.0), upstairs, 6.0)
    builder.refresh(upstairs)
    assert builder.memory.node(down).objects == ("bed",)
    assert builder.memory.node(down).frontier_count == 1
    assert builder.memory.node(up).objects == ("sofa",)
    assert builder.frontier_points_of(down, upstairs).shape == (0, 3)


def test_frontiers_are_forgotten_as_they_are_explored():
    builder = MemoryBuilder(MemoryConfig())
    here = builder.arrive((0.0, 0.0), make_map(frontiers=[(1, 1, 0)]), 0.0)
    builder.refresh(make_map())
    assert builder.memory.node(here).frontier_count == 0


def test_the_first_room_type_stays():
    builder = MemoryBuilder(MemoryConfig())
    here = builder.arrive((0.0, 0.0), make_map(), 0.0)
    builder.set_room(here, UNKNOWN_ROOM)
    builder.set_room(here, "kitchen")
    builder.set_room(here, "bedroom")
    assert builder.memory.node(here).room_type == "kitchen"


def test_edge_lengths_come_from_the_planner_and_never_exceed_what_was_travelled():
    view = make_map()
    builder = MemoryBuilder(MemoryConfig())
    builder.arrive((0.0, 0.0), view, 0.0)
    builder.arrive((3.0, 0.0), view, 5.0, lambda a, b: 4.0)
    builder.arrive((3.0, 4.0), view, 6.0, lambda a, b: math.inf)
    builder.arrive((0.0, 4.0), view, 7.0, lambda a, b: 0.1)
    lengths = [(edge.travelled_m, edge.geodesic_m) for edge in builder.memory.edges]
    assert lengths == [(5.0, 4.0), (6.0, 6.0), (7.0, 3.0)]


def test_without_a_planner_a_clear_line_counts_and_else_the_way_travelled():
    view = make_map(grid=walled_grid())
    builder = MemoryBuilder(MemoryConfig())
    builder.arrive((-2.0, 3.0), view, 0.0)
    builder.arrive((2.0, 3.0), view, 9.0)
    builder.arrive((2.0, 6.0), view, 4.0)
    assert [edge.geodesic_m for edge in builder.memory.edges] == [9.0, 3.0]


def test_a_memory_of_an_earlier_episode_is_continued_without_an_edge_to_it():
    first, _ = two_rooms()
    again = MemoryBuilder(MemoryConfig(), first.memory)
    edges = again.memory.edges
    again.arrive((4.0, -7.0), make_map(), 99.0)
    assert again.memory.edges == edges


@pytest.mark.parametrize(
    ("switch", "attribute", "hidden", "word"),
    [
        ("include_rooms", "room_type", UNKNOWN_ROOM, "bedroom"),
        ("include_objects", "objects", (), "fridge"),
        ("include_frontiers", "frontier_count", 0, "frontiers"),
    ],
)
def test_ablated_attributes_are_in_neither_nodes_nor_text(switch, attribute, hidden, word):
    builder, here = two_rooms()
    whole = builder.snapshot(here)
    ablated = MemoryBuilder(MemoryConfig(**{switch: False}), builder.memory).snapshot(here)
    assert any(getattr(node, attribute) != hidden for node in whole.nodes)
    assert all(getattr(node, attribute) == hidden for node in ablated.nodes)
    assert word in whole.text
    assert word not in ablated.text
    others = {"room_type", "objects", "frontier_count", "visits", "position"} - {attribute}
    for name in others:
        assert [getattr(n, name) for n in ablated.nodes] == [getattr(n, name) for n in whole.nodes]


def test_a_snapshot_needs_a_known_node():
    builder, _ = two_rooms()
    with pytest.raises(InputError, match="no node 77"):
        builder.snapshot(77)
