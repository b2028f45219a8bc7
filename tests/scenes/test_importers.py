"""Imported homes: plans without overlaps in which an agent reaches every room."""

import copy
import json
import math
from functools import cache
from itertools import combinations

import networkx as nx
import numpy as np
import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely import LineString, Point, Polygon, box, unary_union
from shapely.affinity import rotate

from shared_data import shared_data
from toponav.categories import canonical
from toponav.envs.simulator.navigation import NavigableSurface
from toponav.errors import SceneError
from toponav.scenes.domestigraph import import_domestigraph
from toponav.scenes.house_io import house_to_json
from toponav.scenes.meshing import build_scene
from toponav.scenes.plan_grid import CELL_M, simple_room
from toponav.scenes.plan_rooms import RoomBox, plan_rooms
from toponav.scenes.plan_storeys import find_storeys
from toponav.scenes.procthor import import_procthor
from toponav.scenes.procthor_assets import asset_category

AGENT_RADIUS_M = 0.18
WALL_M = 0.12

HOMES = [
    "00006-HkseAnWCgqk",
    "00016-qk9eeNeR4vw",
    "00020-XYyR54sxe6b",
    "00023-zepmXAdrpjR",
    "00031-Wo6kuutE9i7",
    "00034-6imZUJGRUq4",
    "00043-Jfyvj3xn2aJ",
    "00057-1UnKg1rAb8A",
    "00062-ACZZiU6BXLz",
    "00081-5biL7VEkByM",
    "00096-6HRFAUDqpTb",
    "00109-GTV2Y73Sn5t",
    "00141-iigzG1rtanx",
    "00149-UuwwmrTsfBN",
    "00155-iLDo95ZbDJq",
    "00166-RaYrxWt5pR1",
    "00173-qZ4B7U6XE5Y",
    "00179-MVVzj944atG",
    "00203-VoVGtfYrpuQ",
    "00210-j2EJhFEQGCL",
    "00222-g8Xrdbe9fir",
    "00238-j6fHrce9pHR",
    "00245-741Fdj7NLF9",
    "00251-wsAYBFtQaL7",
    "00256-92vYG1q49FY",
]


@cache
def imported_home(name):
    return import_domestigraph(shared_data(f"layouts/domestigraph/{name}.yaml"))


def flight_footprint(stairs):
    return LineString([stairs.start, stairs.end]).buffer(stairs.width / 2, cap_style="flat")


def passage(opening, room):
    """The ground that an opening frees: as wide as it is, through walls within 0.2 m."""
    ring = room.exterior
    center = Point(opening.center)
    along = ring.project(center)
    a, b = (ring.interpolate((along + d) % ring.length) for d in (-0.05, 0.05))
    angle = math.atan2(b.y - a.y, b.x - a.x)
    x, y = opening.center
    half = opening.width / 2
    return rotate(box(x - half, y - 0.2, x + half, y + 0.2), angle, (x, y), use_radians=True)


def walkable_pieces(house, index):
    """Where the agent's centre can be on one level: each piece is connected."""
    level = house.levels[index]
    rooms = {room.id: Polygon(room.polygon) for room in level.rooms}
    walls = unary_union([room.exterior.buffer(WALL_M / 2) for room in rooms.values()])
    passages = [
        passage(opening, rooms[opening.rooms[0]])
        for opening in level.openings
        if len(opening.rooms) == 2
    ]
    flights = [flight_footprint(s) for s in house.stairs if index in (s.from_level, s.to_level)]
    furniture = [
        rotate(
            box(
                o.position[0] - o.size[0] / 2,
                o.position[1] - o.size[1] / 2,
                o.position[0] + o.size[0] / 2,
                o.position[1] + o.size[1] / 2,
            ),
            o.yaw,
            use_radians=True,
        )
        for o in level.objects
        if o.position[2] - level.floor < 0.88 and o.size[2] > 0.1
    ]
    free = unary_union(list(rooms.values())).difference(walls).union(unary_union(passages))
    free = free.difference(unary_union(flights + furniture)).buffer(-AGENT_RADIUS_M)
    return [piece for piece in getattr(free, "geoms", [free]) if piece.area > 0.01]


def reachable_rooms(house):
    """Rooms, as (level, id), with floor that the agent reaches from the largest of all pieces."""
    graph = nx.Graph()
    pieces = [walkable_pieces(house, index) for index in range(len(house.levels))]
    for index, parts in enumerate(pieces):
        graph.add_nodes_from((index, i) for i in range(len(parts)))
    for stairs in house.stairs:
        start, end = np.array(stairs.start), np.array(stairs.end)
        ahead = (end - start) / np.linalg.norm(end - start) * 0.4
        ends = []
        for level, point in ((stairs.from_level, start - ahead), (stairs.to_level, end + ahead)):
            near = [
                (level, i) for i, p in enumerate(pieces[level]) if p.distance(Point(point)) < 0.1
            ]
            assert len(near) == 1, f"the landing at {point} of level {level} is not free"
            ends += near
        graph.add_edge(*ends)
    largest = max(graph, key=lambda node: pieces[node[0]][node[1]].area)
    reached = nx.node_connected_component(graph, largest)
    return {
        (level, room.id)
        for level, i in reached
        for room in house.levels[level].rooms
        if Polygon(room.polygon).intersection(pieces[level][i]).area > 0.1
    }


def assert_sound(house):
    """No two rooms of a level overlap, and the agent reaches every one."""
    for level in house.levels:
        polygons = [Polygon(room.polygon) for room in level.rooms]
        for a, b in combinations(polygons, 2):
            assert a.intersection(b).area < 1e-6
    rooms = {(i, room.id) for i, level in enumerate(house.levels) for room in level.rooms}
    assert reachable_rooms(house) == rooms


@pytest.mark.parametrize("name", HOMES)
def test_real_homes_can_be_walked(name):
    path = shared_data(f"layouts/domestigraph/{name}.yaml")
    house = imported_home(name)
    assert_sound(house)
    content = yaml.safe_load(path.read_text())["rooms"]
    for level in house.levels:
        for room in level.rooms:
            if room.id in content:
                assert room.type == content[room.id]["label"]
                footprint = content[room.id]["dims"]
                # A room shrinks where others overlap it; it grows by walls and a landing at most.
                assert Polygon(room.polygon).area < footprint["x"] * footprint["z"] + 8.0


@pytest.mark.parametrize("name", HOMES[:6])
def test_imported_homes_bring_episodes(name):
    house = imported_home(name)
    assert len(house.episodes) == 2
    for episode in house.episodes:
        start = Point(episode.start[:2])
        (level,) = (level for level in house.levels if level.floor == episode.start[2])
        assert episode.target in {canonical(item.category) for item in level.objects}
        assert any(Polygon(room.polygon).contains(start) for room in level.rooms)


@pytest.mark.parametrize("name", ["00096-6HRFAUDqpTb", "00222-g8Xrdbe9fir"])
def test_the_simulator_agrees_that_every_room_can_be_reached(name):
    """Up and down the stairs, on the surface that the simulated agent stands on."""
    house = imported_home(name)
    assert len(house.levels) > 1
    scene = build_scene(house)
    surface = NavigableSurface.build(scene.mesh, floors=scene.floors)
    distances = surface.distance_field([house.episodes[0].start])
    for index, level in enumerate(house.levels):
        pieces = unary_union(walkable_pieces(house, index))
        for room in level.rooms:
            inside = pieces.intersection(Polygon(room.polygon)).representative_point()
            point = surface.snap((inside.x, inside.y, level.floor))
            assert point is not None and math.isfinite(distances.at(point))


@pytest.mark.parametrize("seed", [7, 14, 18, 31, 33, 38, 43, 50, 56, 59])
def test_distorted_homes_can_be_walked(tmp_path, seed):
    """Real homes with their boxes moved and resized at random: gaps and overlaps of all kinds."""
    rng = np.random.default_rng(seed)
    path = shared_data(f"layouts/domestigraph/{HOMES[seed % len(HOMES)]}.yaml")
    content = yaml.safe_load(path.read_text())
    for room in content["rooms"].values():
        for axis in "xz":
            room["centroid"][axis] += float(rng.normal(0.0, 0.5))
            room["dims"][axis] *= float(rng.uniform(0.75, 1.25))
        room["dims"]["y"] *= float(rng.uniform(0.8, 1.2))
    content["connections"] = [pair for pair in content["connections"] if rng.random() < 0.9]
    distorted = tmp_path / "distorted.yaml"
    distorted.write_text(yaml.safe_dump(content))
    assert_sound(import_domestigraph(distorted))


def test_most_rooms_of_the_real_homes_are_kept():
    kept = total = 0
    for name in HOMES:
        path = shared_data(f"layouts/domestigraph/{name}.yaml")
        rooms = set(yaml.safe_load(path.read_text())["rooms"])
        house = imported_home(name)
        kept += len(rooms & {room.id for level in house.levels for room in level.rooms})
        total += len(rooms)
    assert kept >= 0.9 * total


def test_the_same_file_and_seed_give_the_same_house():
    path = shared_data("layouts/domestigraph/00057-1UnKg1rAb8A.yaml")
    assert house_to_json(import_domestigraph(path)) == house_to_json(import_domestigraph(path))


def graph_file(tmp_path, rooms, connections):
    """Rooms as {n: (label, (x0, x1), (y0, y1), (z0, z1))}, y up."""
    content = {
        "rooms": {
            f"room_{n}": {
                "label": label,
                "centroid": dict(zip("xyz", (sum(s) / 2 for s in spans), strict=True)),
                "dims": dict(zip("xyz", (s[1] - s[0] for s in spans), strict=True)),
            }
            for n, (label, *spans) in rooms.items()
        },
        "connections": [list(pair) for pair in connections],
    }
    path = tmp_path / "home.yaml"
    path.write_text(yaml.safe_dump(content))
    return path


UP = (0.0, 2.5)


def test_a_wall_between_boxes_becomes_one_line_with_a_door(tmp_path):
    path = graph_file(
        tmp_path,
        {1: ("bedroom", (0, 4), UP, (0, 3)), 2: ("office", (4.2, 8), UP, (0, 3))},
        [(1, 2), (2, 1)],
    )
    house = import_domestigraph(path)
    assert_sound(house)
    (level,) = house.levels
    (door,) = level.openings
    # Habitat's z is our -y; the wall lies half way between the boxes.
    assert door.center == pytest.approx((4.1, -1.5), abs=0.05)
    assert (door.kind, door.width, sorted(door.rooms)) == ("door", 0.9, ["room_1", "room_2"])
    a, b = (Polygon(room.polygon) for room in level.rooms)
    assert a.intersection(b).length == pytest.approx(3.0)
    assert (a.area, b.area) == pytest.approx((12.3, 11.7))


def test_living_rooms_and_halls_join_openly(tmp_path):
    path = graph_file(
        tmp_path,
        {1: ("kitchen/living room", (0, 4), UP, (0, 3)), 2: ("hallway", (4, 8), UP, (0, 3))},
        [(1, 2)],
    )
    (opening,) = import_domestigraph(path).levels[0].openings
    assert (opening.kind, opening.width) == ("open", 1.4)


def test_the_smaller_room_wins_an_overlap(tmp_path):
    path = graph_file(
        tmp_path,
        {1: ("living room", (0, 6), UP, (0, 6)), 2: ("bathroom", (4, 6), UP, (4, 6))},
        [(1, 2)],
    )
    house = import_domestigraph(path)
    assert_sound(house)
    areas = {room.type: Polygon(room.polygon).area for room in house.levels[0].rooms}
    assert areas == pytest.approx({"living room": 32.0, "bathroom": 4.0})


def test_a_room_around_another_is_cut_open(tmp_path):
    path = graph_file(
        tmp_path,
        {1: ("living room", (0, 8), UP, (0, 8)), 2: ("closet", (3, 5), UP, (3, 4.5))},
        [(1, 2)],
    )
    house = import_domestigraph(path)
    assert_sound(house)
    areas = {room.type: Polygon(room.polygon).area for room in house.levels[0].rooms}
    assert areas["closet"] == pytest.approx(3.0)
    assert 59.0 < areas["living room"] < 61.0


def test_rooms_apart_get_a_hallway(tmp_path):
    path = graph_file(
        tmp_path,
        {1: ("bedroom", (0, 4), UP, (0, 3)), 2: ("office", (7, 10), UP, (0, 3))},
        [(1, 2)],
    )
    house = import_domestigraph(path)
    assert_sound(house)
    assert [room.type for room in house.levels[0].rooms] == ["bedroom", "office", "hallway"]
    corridor = Polygon(house.levels[0].rooms[2].polygon)
    assert corridor.bounds[2] - corridor.bounds[0] == pytest.approx(3.0)
    assert len(corridor.exterior.coords) == 5


def test_unreachable_rooms_are_left_out(tmp_path):
    path = graph_file(
        tmp_path,
        {
            1: ("bedroom", (0, 4), UP, (0, 3)),
            2: ("office", (4, 8), UP, (0, 3)),
            3: ("outdoor area", (20, 60), UP, (0, 40)),
            4: ("garage", (12, 16), UP, (0, 3)),
        },
        [(1, 2)],
    )
    house = import_domestigraph(path)
    assert {room.id for room in house.levels[0].rooms} == {"room_1", "room_2"}


def test_a_box_that_others_cover_is_replaced_by_them(tmp_path):
    path = graph_file(
        tmp_path,
        {
            1: ("living room", (0, 4), UP, (0, 4)),
            2: ("kitchen", (0, 4), UP, (0, 4)),
            3: ("office", (4, 8), UP, (0, 4)),
        },
        [(1, 2), (1, 3)],
    )
    house = import_domestigraph(path)
    assert_sound(house)
    assert len(house.levels[0].rooms) == 2
    assert len(house.levels[0].openings) == 1


def test_storeys_are_joined_by_stairs(tmp_path):
    path = graph_file(
        tmp_path,
        {
            1: ("hallway", (0, 8), (0, 2.5), (0, 3)),
            2: ("kitchen", (0, 8), (0, 2.5), (3, 7)),
            3: ("hallway", (0, 8), (2.8, 5.3), (0, 3)),
            4: ("bedroom", (0, 8), (2.8, 5.3), (3, 7)),
        },
        [(1, 2), (1, 3), (3, 4)],
    )
    house = import_domestigraph(path)
    assert_sound(house)
    assert [level.floor for level in house.levels] == [0.0, 2.8]
    (stairs,) = house.stairs
    run = math.dist(stairs.start, stairs.end)
    assert math.degrees(math.atan2(2.8, run)) < 45.0
    below = Polygon(house.levels[0].rooms[0].polygon)
    above = Polygon(house.levels[1].rooms[0].polygon)
    assert below.covers(flight_footprint(stairs)) and above.covers(flight_footprint(stairs))


def storey_of(spans):
    boxes = [RoomBox(key, "office", (5.0 * key, 0.0), (5.0 * key + 4.0, 4.0)) for key in spans]
    connections = [(key, key + 1) for key in spans if key + 1 in spans]
    storeys = find_storeys(boxes, spans, connections)
    return [storey.rooms for storey in storeys]


def test_storeys_from_heights():
    # Half a room, a stairwell, a step and a half-level beside it are all on the first floor.
    assert storey_of({1: (0, 2.5), 2: (1.0, 2.5), 3: (0, 5.3), 4: (-0.4, 2.1), 5: (1.2, 3.6)}) == [
        (1, 2, 3, 4, 5)
    ]
    assert storey_of({1: (0, 2.5), 2: (2.8, 5.3), 3: (5.6, 8.0)}) == [(1,), (2,), (3,)]


def test_half_levels_above_one_another_are_raised_to_storeys():
    boxes = [RoomBox(key, "office", (0.0, 0.0), (4.0, 4.0)) for key in (1, 2)]
    storeys = find_storeys(boxes, {1: (0.0, 2.3), 2: (1.5, 3.8)}, [(1, 2)])
    assert [storey.rooms for storey in storeys] == [(1,), (2,)]
    assert storeys[1].floor - storeys[0].floor >= 2.4


positions = st.floats(-6, 6)
extents = st.floats(0.3, 7)


@settings(max_examples=80)
@given(st.lists(st.tuples(positions, positions, extents, extents), min_size=1, max_size=7))
def test_any_boxes_become_disjoint_simple_polygons(spans):
    boxes = [
        RoomBox(key, "office", (x, y), (x + dx, y + dy)) for key, (x, y, dx, dy) in enumerate(spans)
    ]
    grid, absorbers = plan_rooms(boxes)
    shapes = {}
    for item in boxes:
        mask = grid.mask(item.key)
        if not mask.any():
            assert item.key in absorbers or not any(grid.mask(b.key).any() for b in boxes)
            continue
        shapes[item.key] = shape = Polygon(grid.polygon(item.key))
        assert shape.is_valid and shape.exterior.is_ccw
        assert shape.area == pytest.approx(mask.sum() * CELL_M**2)
        # Wide enough everywhere for the agent: what erosion takes, dilation gives back.
        inner = shape.buffer(-0.34, join_style="mitre")
        assert inner.buffer(0.34, join_style="mitre").area == pytest.approx(shape.area, rel=1e-6)
        assert shape.within(box(*item.low, *item.high).buffer(1.0, join_style="mitre"))
    for a, b in combinations(shapes.values(), 2):
        assert a.intersection(b).area < 1e-9


@settings(max_examples=60)
@given(st.integers(0, 2**32 - 1))
def test_simple_rooms_of_random_masks_are_simple(seed):
    rng = np.random.default_rng(seed)
    mask = np.zeros((30, 30), bool)
    for _ in range(rng.integers(1, 9)):
        i, j = rng.integers(2, 20, 2)
        mask[i : i + rng.integers(3, 10), j : j + rng.integers(3, 10)] = rng.random() < 0.7
    mask[:1] = mask[-1:] = mask[:, :1] = mask[:, -1:] = False
    others = (rng.random(mask.shape) < 0.1) & ~mask
    room = simple_room(mask, others, 3)
    if room.any():
        cells = [box(i, j, i + 1, j + 1) for i, j in np.argwhere(room)]
        shape = unary_union(cells)
        assert isinstance(shape, Polygon) and not shape.interiors
        assert not (room & others).any()


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("", "input should be a valid dictionary"),
        ("a: [1", "not YAML: "),
        ("rooms: {}\nconnections: []", "rooms: "),
        ("rooms: {kitchen: 3}\nconnections: []", "rooms.kitchen: "),
        ("rooms: {room_1: {label: x}}", "rooms.room_1.centroid: missing"),
        (
            "rooms: {r1: {label: x, centroid: {x: 0, y: 0, z: 0}, dims: {x: 1, y: 1, z: 1}}}",
            "rooms.r1: rooms are called room_1",
        ),
        (
            "rooms: {room_1: {label: x, centroid: {x: .nan, y: 0, z: 0}, "
            "dims: {x: 1, y: 1, z: 1}}}",
            "rooms.room_1.centroid.x",
        ),
        (
            "rooms: {room_1: {label: x, centroid: {x: 0, y: 0, z: 0}, dims: {x: 0, y: 1, z: 1}}}",
            "rooms.room_1.dims.x",
        ),
        (
            "rooms: {room_1: {label: x, centroid: {x: 0, y: 0, z: 0}, "
            "dims: {x: 3, y: 3, z: 3}}}\nconnections: [[1, 2]]",
            "connections[0]: no room room_2",
        ),
        (
            "rooms: {room_1: {label: x, centroid: {x: 0, y: 0, z: 0}, "
            "dims: {x: 3000, y: 3, z: 3000}}}",
            "rooms span 3000 m x 3000 m",
        ),
    ],
)
def test_broken_room_graphs_are_named_in_one_line(tmp_path, content, message):
    path = tmp_path / "home.yaml"
    path.write_text(content)
    with pytest.raises(SceneError) as caught:
        import_domestigraph(path)
    assert str(caught.value).startswith(f"{path}: ")
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


PROCTHOR_HOUSES = [f"house_{index}.json" for index in range(4)]


@pytest.mark.parametrize("name", PROCTHOR_HOUSES)
def test_procthor_houses(name):
    path = shared_data(f"scenes/procthor/{name}")
    house = import_procthor(path)
    source = json.loads(path.read_text())
    (level,) = house.levels
    assert {room.id for room in level.rooms} == {room["id"] for room in source["rooms"]}
    assert len(level.openings) == len(source["doors"])
    for room, original in zip(level.rooms, source["rooms"], strict=True):
        corners = [(c["x"], c["z"]) for c in original["floorPolygon"]]
        assert Polygon(room.polygon).equals(Polygon(corners))
    names = {item["id"] for item in source["objects"]}
    names |= {child["id"] for item in source["objects"] for child in item.get("children", [])}
    assert names <= {item.id for item in level.objects}
    for item in level.objects:
        assert item.position[2] >= 0.0
    unfurnished = house.model_copy(update={"levels": [level.model_copy(update={"objects": []})]})
    assert_sound(unfurnished)


def test_procthor_furniture_faces_away_from_walls():
    house = import_procthor(shared_data("scenes/procthor/house_1.json"))
    (level,) = house.levels
    beds = [item for item in level.objects if item.category == "bed"]
    assert len(beds) == 3
    # The beds' heads are at the wall y = 8.403 of their room: they face -y, as local -y does.
    for bed in beds:
        assert abs(math.remainder(bed.yaw, 2 * math.pi)) < 1e-6
        assert bed.position[1] + bed.size[1] / 2 == pytest.approx(8.403, abs=0.35)


def test_procthor_categories():
    names = {
        "Bed|2|3": "bed",
        "RoboTHORbedkritter|4|1": "bed",
        "DogBed|1|1": "dog_bed",
        "Chair_201|1|0": "chair",
        "ArmChair|7|1": "chair",
        "Television_27|1": "tv_monitor",
        "TV_Stand_203|1": "tv_stand",
        "HousePlant|6|2": "plant",
        "Wall_Decor_Painting_1V|4": "picture",
        "Dining_Table_221|6": "table",
        "RoboTHOR_dining_table_extendable|1": "table",
        "CountertopLx|6": "counter",
        "bin|3": "refuse_bin",
        "Fridge|6|1": "fridge",
        "SprayBottle|6": "spray_bottle",
    }
    assert {name: asset_category(name) for name in names} == names


def test_broken_procthor_houses(tmp_path):
    good = {
        "rooms": [
            {
                "id": "room|1",
                "roomType": "Kitchen",
                "floorPolygon": [{"x": x, "y": 0, "z": z} for x, z in ((0, 0), (0, 4), (4, 4))],
            }
        ],
        "walls": [],
        "doors": [],
        "objects": [],
    }
    door = {
        "id": "door|1|2",
        "holePolygon": [{"x": 0, "y": 0, "z": 0}, {"x": 1, "y": 2, "z": 0}],
        "room0": "room|1",
        "room1": "room|1",
        "wall0": "wall|1",
    }

    def problem(**changes):
        path = tmp_path / "house.json"
        path.write_text(json.dumps({**copy.deepcopy(good), **changes}))
        with pytest.raises(SceneError) as caught:
            import_procthor(path)
        assert "\n" not in str(caught.value)
        return str(caught.value)

    assert "doors: 'door|1|2' is in wall 'wall|1'" in problem(doors=[door])
    assert "rooms: " in problem(rooms=[])
    assert "walls" in problem(walls=None)
    assert "objects[0].position: missing" in problem(objects=[{"id": "a", "rotation": door}])
