from __future__ import annotations

import re
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from memory_maps import make_map, two_rooms
from pydantic import ValidationError

from toponav.memory.builder import MemoryBuilder, MemoryConfig
from toponav.memory.snapshot import UNKNOWN_ROOM, EdgeView, NodeAttribute, NodeView
from toponav.memory.text import MAX_NAME_LENGTH, TextBudget, clean_name, describe

GOLDEN = Path(__file__).resolve().parents[1] / "golden"
BUDGET = TextBudget()


def place(node_id: int, frontiers: int = 0, objects: tuple[str, ...] = ()) -> NodeView:
    return NodeView(node_id, (float(node_id), 0.0), 0, objects, UNKNOWN_ROOM, frontiers, 1)


def long_episode() -> tuple[list[NodeView], list[EdgeView], list[int]]:
    """200 places along a line, frontiers at every tenth."""
    nodes = [
        place(i, frontiers=i if i % 10 == 0 else 0, objects=("chair", "table", "sofa"))
        for i in range(1, 201)
    ]
    edges = [EdgeView(i, i + 1, 1.5, 1.0) for i in range(1, 200)]
    return nodes, edges, list(range(1, 201))


def places_in(text: str) -> list[int]:
    return [int(number) for number in re.findall(r"^- place (\d+) ", text, re.MULTILINE)]


def test_golden_text_of_a_small_memory():
    builder, here = two_rooms()
    expected = (GOLDEN / "memory_two_rooms.txt").read_text(encoding="utf-8")
    assert builder.snapshot(here).text + "\n" == expected


def test_golden_text_of_two_floors():
    builder = MemoryBuilder(MemoryConfig())
    builder.arrive((0.0, -0.04), make_map(), 0.0)
    view = make_map({"lamp": [(1.0, 1.0, 3.0)]}, [(1.0, 0.0, 2.7)], floor=1, floor_z=2.7)
    here = builder.arrive((2.0, 0.0), view, 6.5)
    expected = (GOLDEN / "memory_two_floors.txt").read_text(encoding="utf-8")
    assert builder.snapshot(here).text + "\n" == expected


def test_a_long_episode_keeps_the_places_that_matter():
    nodes, edges, history = long_episode()
    text = describe(nodes, edges, 100, history, TextBudget(max_nodes=25))
    shown = places_in(text)
    with_frontiers = set(range(10, 201, 10))
    assert shown == sorted({99, 100, 101} | with_frontiers | {197, 198, 199})
    assert "175 further places omitted." in text
    assert text.endswith("Route so far: ... > " + " > ".join(map(str, range(181, 201))) + ".")


def test_the_character_budget_drops_the_least_important_first():
    nodes, edges, history = long_episode()
    text = describe(nodes, edges, 100, history, TextBudget(max_nodes=200, max_characters=1500))
    assert len(text) <= 1500
    shown = places_in(text)
    assert {99, 100, 101, 200, 190, 180} <= set(shown)
    assert f"{200 - len(shown)} further places omitted." in text


names = st.text(max_size=60)


@given(
    st.lists(st.tuples(names, st.lists(names, max_size=30), st.integers(0, 10**6)), min_size=1),
    st.integers(1, 40),
    st.integers(1500, 4000),
    st.frozensets(st.sampled_from(NodeAttribute)),
)
@settings(max_examples=60)
def test_no_names_can_break_the_lines_or_the_budget(places, max_nodes, max_characters, shown):
    nodes = [
        NodeView(i, (-1234.5, 1234.5), i % 3, tuple(objects), room, frontiers, 1)
        for i, (room, objects, frontiers) in enumerate(places, start=1)
    ]
    edges = [EdgeView(1, node.id, 1.0, 1.0) for node in nodes[1:]]
    budget = TextBudget(max_nodes=max_nodes, max_characters=max_characters)
    text = describe(nodes, edges, 1, [1], budget, shown)
    assert len(text) <= max_characters
    lines = text.splitlines()
    listed = places_in(text)
    assert 1 in listed
    assert len(listed) <= max_nodes
    omitted = len(listed) < len(nodes)
    assert len(lines) == 1 + len(listed) + omitted + 1


@pytest.mark.parametrize(
    ("name", "cleaned"),
    [
        ("chest_of_drawers", "chest of drawers"),
        ("chair\n- place 9 (here): exit", "chair - place 9 (here): exit"),
        ("a\x00\x1b[31m\u2028b", "a [31m b"),
        ("  wide\t gap ", "wide gap"),
        ("x" * 500, "x" * (MAX_NAME_LENGTH - 3) + "..."),
    ],
)
def test_names_from_outside_become_one_short_line(name, cleaned):
    assert clean_name(name) == cleaned
    assert len(cleaned) <= MAX_NAME_LENGTH


def test_many_objects_are_cut_and_counted():
    objects = tuple(f"thing_{i:02}" for i in range(20))
    text = describe([place(1, objects=objects)], [], 1, [1], TextBudget(max_objects=2))
    assert "objects: thing 00, thing 01 and 18 more;" in text


def test_unreachable_places_are_said_to_be_so():
    text = describe([place(1), place(2)], [], 1, [], BUDGET)
    assert "- place 2 (no known path):" in text
    assert text.endswith("Route so far: none.")


def test_a_budget_too_small_for_one_place_is_refused():
    with pytest.raises(ValidationError):
        TextBudget(max_characters=100)
