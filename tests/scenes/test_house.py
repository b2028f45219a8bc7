"""House files: what is written is read back, and what is wrong is named in one line."""

import copy
import itertools
import json
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from toponav.errors import SceneError
from toponav.scenes.house import (
    House,
    HouseEpisode,
    HouseObject,
    Level,
    Opening,
    Room,
    Stairs,
    Wall,
)
from toponav.scenes.house_io import house_to_json, load_house, parse_house, save_house
from toponav.scenes.validation import validate_house

TWO_ROOMS = {
    "format": "toponav-house/1",
    "name": "two rooms",
    "levels": [
        {
            "rooms": [
                {"id": "a", "type": "kitchen", "polygon": [[0, 0], [4, 0], [4, 3], [0, 3]]},
                {"id": "b", "polygon": [[4, 0], [8, 0], [8, 3], [4, 3]]},
            ],
            "openings": [{"kind": "door", "rooms": ["a", "b"], "center": [4, 1.5]}],
            "objects": [
                {"id": "o", "category": "bed", "position": [1, 1, 0], "size": [1.4, 2, 0.5]}
            ],
        },
        {"floor": 2.8, "rooms": [{"id": "a", "polygon": [[0, 0], [4, 0], [4, 3]]}]},
    ],
    "stairs": [{"from_level": 0, "to_level": 1, "start": [0.5, 0.5], "end": [3.5, 0.5]}],
    "episodes": [{"target": "bed", "start": [6, 1, 0], "yaw": 1.5}],
}


def write(tmp_path, content):
    path = tmp_path / "house.json"
    path.write_text(content if isinstance(content, str) else json.dumps(content))
    return path


def test_defaults_of_the_format(tmp_path):
    house = load_house(write(tmp_path, TWO_ROOMS))
    kitchen, other = house.levels[0].rooms
    assert (kitchen.height, kitchen.enclosed, other.type) == (2.6, True, "unknown")
    door = house.levels[0].openings[0]
    assert (door.width, door.height) == (0.9, 2.05)
    assert house.levels[0].floor == 0.0 and house.levels[0].walls == []
    assert house.levels[0].objects[0].yaw == 0.0 and house.levels[0].objects[0].mesh is None


ROOM = ("levels", 0, "rooms", 0)
POLYGON = (*ROOM, "polygon")
OBJECT = ("levels", 0, "objects", 0)
OPENING = ("levels", 0, "openings", 0)
WALLS = ("levels", 0, "walls")
STAIRS = ("stairs", 0)

# (where in TWO_ROOMS, the wrong value, what the message must contain)
BROKEN = [
    (POLYGON, [[0, 0], [4, 3], [4, 0], [0, 3]], "rooms[0].polygon: edges 0 and 2 cross"),
    (POLYGON, [[0, 0], [4, 0]], "levels[0].rooms[0].polygon: a polygon needs at least 3 points"),
    (POLYGON, [[0, 0], [4, 0], [2, 0]], "levels[0].rooms[0].polygon: edges 0 and 1 cross"),
    (POLYGON, [[0, 0], [4, 0], [4, 3], [0, 0]], "points 3 and 0 coincide"),
    (POLYGON, [[0, 0], [4, 0], [4, 0], [0, 3]], "points 1 and 2 coincide"),
    (POLYGON, [[0, 0], [1e-3, 0], [1e-3, 1e-3]], "encloses only"),
    ((*POLYGON, 1), [4, 0, 1], "levels[0].rooms[0].polygon[1]"),
    ((*POLYGON, 1), [4, float("nan")], "levels[0].rooms[0].polygon[1][1]"),
    ((*POLYGON, 1), [4, float("inf")], "levels[0].rooms[0].polygon[1][1]"),
    ((*POLYGON, 1), [4, 1e200], "levels[0].rooms[0].polygon[1][1]"),
    ((*ROOM, "height"), 0, "levels[0].rooms[0].height"),
    ((*ROOM, "height"), "2.6", "levels[0].rooms[0].height"),
    ((*ROOM, "enclosed"), 1, "levels[0].rooms[0].enclosed"),
    ((*ROOM, "id"), "b", "rooms[1].id: 'b' is also the id of levels[0].rooms[0]"),
    ((*ROOM, "colour"), "red", "rooms[0].colour: unknown key; known keys: id, type, polygon,"),
    ((*OBJECT, "size"), [1, -2, 1], "levels[0].objects[0].size[1]"),
    ((*OBJECT, "position"), [1, 2], "levels[0].objects[0].position"),
    ((*OBJECT, "category"), "", "levels[0].objects[0].category"),
    ((*OBJECT, "mesh"), "no.glb", "levels[0].objects[0].mesh: no file "),
    ((*OPENING, "rooms"), ["a", "c"], "levels[0].openings[0].rooms[1]: no room 'c'"),
    ((*OPENING, "rooms"), ["a", "a"], "levels[0].openings[0].rooms: "),
    ((*OPENING, "rooms"), [], "levels[0].openings[0].rooms"),
    ((*OPENING, "center"), [5, 1.5], "openings[0].center: 1.00 m from the walls of room 'a'"),
    ((*OPENING, "width"), 0, "levels[0].openings[0].width"),
    ((*OPENING, "kind"), "gate", "levels[0].openings[0].kind"),
    (WALLS, [{"points": [[0, 0]]}], "levels[0].walls[0].points"),
    (WALLS, [{"points": [[0, 0], [0, 0]]}], "walls[0].points: points 0 and 1 coincide"),
    ((*STAIRS, "to_level"), 2, "stairs[0].to_level: no level 2; the house has 2"),
    ((*STAIRS, "to_level"), 0, "stairs[0].to_level: stairs join two levels"),
    ((*STAIRS, "from_level"), -1, "stairs[0].from_level"),
    ((*STAIRS, "end"), [0.5, 0.5], "stairs[0].end"),
    (("levels", 1, "floor"), None, "levels[1].floor"),
    (("episodes", 0, "start"), [0, 0], "episodes[0].start"),
    (("levels",), [], "levels: the house has no room"),
    (("levels",), {}, "levels: "),
    (("format",), "toponav-house/2", "format: this release reads 'toponav-house/1'"),
]


@pytest.mark.parametrize(("where", "value", "message"), BROKEN)
def test_each_mistake_is_named_in_one_line(tmp_path, where, value, message):
    content = copy.deepcopy(TWO_ROOMS)
    target = content
    for key in where[:-1]:
        target = target[key]
    target[where[-1]] = value
    path = write(tmp_path, content)
    with pytest.raises(SceneError) as caught:
        load_house(path)
    assert str(caught.value).startswith(f"{path}: ")
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("key", ["format", "name", "levels"])
def test_required_keys(tmp_path, key):
    content = {k: v for k, v in TWO_ROOMS.items() if k != key}
    with pytest.raises(SceneError, match=f"{key}: missing"):
        load_house(write(tmp_path, content))


@pytest.mark.parametrize("text", ["", "{", "[1, 2", '{"a": }', "nonsense", "[" * 100_000])
def test_what_is_not_json_is_located(tmp_path, text):
    with pytest.raises(SceneError, match=r"not JSON: .* at line \d+ column \d+"):
        load_house(write(tmp_path, text))


@pytest.mark.parametrize("content", ["[]", "3", "null", '"house"'])
def test_json_that_is_no_object(tmp_path, content):
    with pytest.raises(SceneError) as caught:
        load_house(write(tmp_path, content))
    assert "\n" not in str(caught.value)


def test_files_that_cannot_be_read(tmp_path):
    with pytest.raises(SceneError, match="no such file"):
        load_house(tmp_path / "absent.json")
    with pytest.raises(SceneError, match="cannot be read"):
        load_house(tmp_path)
    (tmp_path / "binary.json").write_bytes(b"\xff\xfe\x00{")
    with pytest.raises(SceneError, match="not a text file"):
        load_house(tmp_path / "binary.json")


def test_an_outer_door_and_a_wall_within_reach_are_fine(tmp_path):
    content = copy.deepcopy(TWO_ROOMS)
    # 0.3 m gap between the rooms, the opening in its middle.
    content["levels"][0]["rooms"][1]["polygon"] = [[4.3, 0], [8, 0], [8, 3], [4.3, 3]]
    content["levels"][0]["openings"] = [
        {"kind": "open", "rooms": ["a", "b"], "center": [4.15, 1.5], "width": 1.2},
        {"kind": "door", "rooms": ["a"], "center": [0, 1.5]},
    ]
    assert len(load_house(write(tmp_path, content)).levels[0].openings) == 2


def test_a_failed_save_leaves_the_old_file(tmp_path):
    path = write(tmp_path, TWO_ROOMS)
    before = path.read_bytes()
    with pytest.raises(SceneError):
        save_house(House(name="empty", levels=[]), path)
    assert path.read_bytes() == before
    with pytest.raises(SceneError, match="cannot be written"):
        save_house(load_house(path), path / "house.json")
    assert sorted(p.name for p in tmp_path.iterdir()) == ["house.json"]


def test_saved_files_are_stable_and_readable(tmp_path):
    house = load_house(write(tmp_path, TWO_ROOMS))
    save_house(house, tmp_path / "copy.json")
    first = (tmp_path / "copy.json").read_bytes()
    save_house(load_house(tmp_path / "copy.json"), tmp_path / "copy.json")
    assert (tmp_path / "copy.json").read_bytes() == first
    assert max(len(line) for line in first.decode().splitlines()) < 220
    assert '"rooms": ["a", "b"]' in first.decode()


def test_coordinates_of_both_windings_are_accepted():
    clockwise = Room(id="a", polygon=[(0, 0), (0, 3), (4, 3), (4, 0)])
    validate_house(House(name="h", levels=[Level(rooms=[clockwise])]))


coordinates = st.floats(-100, 100, allow_nan=False)
lengths = st.floats(0.05, 50)
names = st.text(min_size=1, max_size=8)


@st.composite
def houses(draw):
    """Valid houses: a row of rectangles with doors between them, on one or two levels."""
    levels = []
    for index in range(draw(st.integers(1, 2))):
        depth = draw(st.floats(2, 10))
        edges = [0.0]
        for width in draw(st.lists(st.floats(2, 8), min_size=1, max_size=4)):
            edges.append(edges[-1] + width)
        pairs = list(itertools.pairwise(edges))
        rooms = [
            Room(
                id=f"r{i}",
                type=draw(names),
                polygon=[(a, 0.0), (b, 0.0), (b, depth), (a, depth)],
                height=draw(lengths),
                enclosed=draw(st.booleans()),
            )
            for i, (a, b) in enumerate(pairs)
        ]
        openings = [
            Opening(kind=draw(st.sampled_from(["door", "open"])), rooms=[f"r{i}", f"r{i + 1}"],
                    center=(edges[i + 1], depth / 2), width=draw(lengths), height=draw(lengths))
            for i in range(len(pairs) - 1)
        ]  # fmt: skip
        objects = [
            HouseObject(
                id=f"o{i}",
                category=draw(names),
                position=(draw(coordinates), draw(coordinates), draw(coordinates)),
                size=(draw(lengths), draw(lengths), draw(lengths)),
                yaw=draw(st.floats(-10, 10)),
            )
            for i in range(draw(st.integers(0, 3)))
        ]
        walls = [Wall(points=[(0.0, 0.0), (draw(st.floats(1, 5)), 1.0)], height=draw(lengths))]
        levels.append(Level(floor=3.0 * index, rooms=rooms, openings=openings, objects=objects,
                            walls=walls[: draw(st.integers(0, 1))]))  # fmt: skip
    stairs = []
    if len(levels) == 2:
        stairs = [Stairs(from_level=0, to_level=1, start=(0.0, 0.0), end=(0.0, draw(lengths)))]
    episodes = [
        HouseEpisode(target=draw(names), start=(draw(coordinates), 0.0, 0.0), yaw=draw(coordinates))
        for _ in range(draw(st.integers(0, 2)))
    ]
    return House(name=draw(names), levels=levels, stairs=stairs, episodes=episodes)


@settings(max_examples=60)
@given(houses())
def test_round_trip_is_exact(house):
    validate_house(house)
    assert parse_house(house_to_json(house), Path("house.json")) == house
