from __future__ import annotations

import json
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from memory_maps import make_map, two_rooms

from toponav.errors import InputError
from toponav.memory.builder import MemoryBuilder, MemoryConfig
from toponav.memory.graph import TopologicalMemory
from toponav.memory.serialization import load_memory, save_memory

GOLDEN = Path(__file__).resolve().parents[1] / "golden" / "memory_two_rooms.json"
coordinate = st.floats(-50.0, 50.0)


def assert_same(a: TopologicalMemory, b: TopologicalMemory) -> None:
    assert a.nodes == b.nodes
    assert a.edges == b.edges
    assert a.history == b.history
    assert a.next_id == b.next_id


def test_golden_file(tmp_path):
    builder, _ = two_rooms()
    save_memory(builder.memory, tmp_path / "memory.json")
    written = (tmp_path / "memory.json").read_text(encoding="utf-8")
    assert written == GOLDEN.read_text(encoding="utf-8")
    assert_same(load_memory(GOLDEN), builder.memory)


@given(st.lists(st.tuples(coordinate, coordinate, st.text()), max_size=8))
@settings(max_examples=40)
def test_round_trip(tmp_path_factory, walk):
    builder = MemoryBuilder(MemoryConfig(d_merge=20.0))
    view = make_map()
    for x, y, room in walk:
        builder.set_room(builder.arrive((x, y), view, 7.5), room)
    path = tmp_path_factory.mktemp("memory") / "memory.json"
    save_memory(builder.memory, path)
    assert_same(load_memory(path), builder.memory)


def test_saving_replaces_the_old_file_and_leaves_nothing_else(tmp_path):
    path = tmp_path / "memory.json"
    path.write_text("old")
    save_memory(two_rooms()[0].memory, path)
    assert_same(load_memory(path), two_rooms()[0].memory)
    assert [file.name for file in tmp_path.iterdir()] == ["memory.json"]


def test_a_failed_save_keeps_the_old_file(tmp_path, monkeypatch):
    path = tmp_path / "memory.json"
    path.write_text("old")

    def full_disk(file_descriptor):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.fsync", full_disk)
    with pytest.raises(InputError, match="No space left"):
        save_memory(two_rooms()[0].memory, path)
    assert path.read_text() == "old"
    assert [file.name for file in tmp_path.iterdir()] == ["memory.json"]


def test_saving_below_a_file_is_an_error(tmp_path):
    (tmp_path / "file").write_text("mine")
    with pytest.raises(InputError, match="cannot write memory"):
        save_memory(TopologicalMemory(), tmp_path / "file" / "memory.json")


def golden_with(*path_and_value: object) -> str:
    """The golden file with the value at a path replaced."""
    *path, last, value = path_and_value
    data = json.loads(GOLDEN.read_text(encoding="utf-8"))
    target = data
    for key in path:
        target = target[key]
    target[last] = value
    return json.dumps(data)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("{", "is not JSON"),
        ("", "is not JSON"),
        ("[" * 100_000, "is not JSON"),
        ("[]", "has format None"),
        ('{"format": "toponav-memory/2"}', "has format 'toponav-memory/2'"),
        ('{"format": "toponav-memory/1"}', "nodes: Field required"),
        (golden_with("surprise", 1), "surprise: Extra inputs"),
        (golden_with("nodes", 0, "id", "1"), "nodes.0.id: Input should be a valid integer"),
        (golden_with("nodes", 0, "id", 99), "node id 99"),
        (golden_with("nodes", 0, "id", 2), "node id 2 is repeated"),
        (golden_with("nodes", 0, "visits", 5), "node 1 has 5 visits but 1"),
        (golden_with("nodes", 0, "frontier_count", -1), "nodes.0.frontier_count"),
        (golden_with("nodes", 0, "position", [0.0]), "nodes.0.position"),
        (golden_with("nodes", 0, "position", [0.0, float("nan")]), "NaN is not a number"),
        (golden_with("nodes", 0, "position", [0.0, float("inf")]), "Infinity is not a number"),
        (golden_with("edges", 0, "geodesic_m", -1.0), "length of -1.0"),
        (golden_with("edges", 0, "target", 77), "no node 77"),
        (golden_with("history", [1, 77]), "no node 77"),
    ],
    ids=lambda value: value[:24],
)
def test_bad_files_are_refused_in_one_line(tmp_path, text, message):
    path = tmp_path / "memory.json"
    path.write_text(text)
    with pytest.raises(InputError) as caught:
        load_memory(path)
    assert message in str(caught.value)
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)


def test_an_overflowing_number_is_refused(tmp_path):
    path = tmp_path / "memory.json"
    path.write_text(GOLDEN.read_text(encoding="utf-8").replace("-4.0", "-1e999", 1))
    with pytest.raises(InputError, match="position"):
        load_memory(path)


@pytest.mark.parametrize("content", [b"\xff\xfe\x00", None])
def test_unreadable_files_are_refused(tmp_path, content):
    path = tmp_path / "memory.json"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(InputError, match="memory"):
        load_memory(path)
