"""Houses become meshes: checked by volumes, areas, rays and walks, not by their triangles."""

import math
from collections import Counter

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely import Polygon, contains_xy, union_all

from shared_data import shared_data
from toponav.envs.simulator.agent_body import AgentBody
from toponav.envs.simulator.navigation import NavigableSurface
from toponav.envs.simulator.raycaster import RayCaster
from toponav.errors import SceneError
from toponav.scenes.building.flights import MAX_RISER_M
from toponav.scenes.building.passages import WALL_THICKNESS_M
from toponav.scenes.finishes import OUTSIDE
from toponav.scenes.house import House
from toponav.scenes.loading import load_house_spec
from toponav.scenes.meshing import build_scene

T = WALL_THICKNESS_M
FRAME_M = 0.02
"""What a door frame may take off a passage."""


def room(name, x0, y0, x1, y1, **more):
    return {"id": name, "polygon": [[x0, y0], [x1, y0], [x1, y1], [x0, y1]], **more}


def door(rooms, center, **more):
    return {"kind": "door", "rooms": rooms, "center": center, **more}


def thing(name, category="zebra", position=(1, 1, 0), size=(0.5, 0.4, 0.3), **more):
    return {"id": name, "category": category, "position": position, "size": size, **more}


def house(rooms, openings=(), objects=(), walls=(), **more):
    level = {"rooms": rooms, "openings": openings, "objects": objects, "walls": walls}
    return House.model_validate({"name": "test", "levels": [level], **more})


def scene(*args, **more):
    return build_scene(house(*args, **more))


def corners(built, category=None, name=None):
    ids = [
        i.id for i in built.mesh.instances
        if (category is None or i.category == category) and (name is None or i.name == name)
    ]  # fmt: skip
    return built.mesh.vertices[built.mesh.faces[np.isin(built.mesh.face_instance, ids)]]


def volume(triangles):
    a, b, c = triangles.swapaxes(0, 1)
    return float((a * np.cross(b, c)).sum() / 6.0)


def area(triangles):
    a, b, c = triangles.swapaxes(0, 1)
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2.0)


class Rays:
    """Casts rays and tells the category, name and distance of what they hit."""

    def __init__(self, built):
        self._mesh = built.mesh
        self._caster = RayCaster(built.mesh)

    def hit(self, start, direction, reach=math.inf):
        hits = self._caster.cast([start], [direction])
        if hits.face[0] < 0 or hits.distance[0] > reach:
            return None
        return self._mesh.instances[self._mesh.face_instance[hits.face[0]]]

    def blocked(self, start, end):
        return self.hit(start, np.subtract(end, start), 1.0) is not None

    def distance(self, start, direction):
        return float(self._caster.cast([start], [direction]).distance[0])


def ring_area(width, depth):
    """Plan area of the walls around a rectangle."""
    return (width + T) * (depth + T) - (width - T) * (depth - T)


def two_rooms(gap=0.0, **opening):
    """A room west of another one, joined by an opening in the middle of the wall or gap."""
    rooms = [room("west", 0, 0, 4, 3), room("east", 4 + gap, 0, 8 + gap, 3)]
    center = [4 + gap / 2, 1.5]
    return rooms, [door(["west", "east"], center, **opening)]


def clear_width(rays, x0, x1, z, middle, step=0.002):
    """Width of the gap around y = middle through which level rays along x pass."""
    offsets = np.arange(-1.4, 1.4, step)
    free = np.array([not rays.blocked((x0, middle + d, z), (x1, middle + d, z)) for d in offsets])
    return free.sum() * step


# --- walls -------------------------------------------------------------------------------------


def test_walls_of_one_room_are_a_closed_solid_centred_on_its_outline():
    built = scene([room("a", 0, 0, 4, 3, height=2.5)])
    assert volume(corners(built, "wall")) == pytest.approx(ring_area(4, 3) * 2.5)
    rays = Rays(built)
    assert rays.distance((2, 1.5, 1), (1, 0, 0)) == pytest.approx(2 - T / 2, abs=1e-5)
    assert rays.distance((2, 1.5, 1), (0, -1, 0)) == pytest.approx(1.5 - T / 2, abs=1e-5)
    assert rays.distance((-3, 1.5, 1), (1, 0, 0)) == pytest.approx(3 - T / 2, abs=1e-5)


def test_a_shared_wall_is_built_once():
    built = scene([room("a", 0, 0, 4, 3), room("b", 4, 0, 8, 3)])
    expected = 2 * ring_area(4, 3) - T * (3 + T)
    assert volume(corners(built, "wall")) == pytest.approx(expected * 2.6)


def test_walls_are_as_high_as_the_higher_of_their_rooms():
    built = scene([room("low", 0, 0, 4, 3, height=2.4), room("high", 4, 0, 8, 3, height=3.0)])
    expected = ring_area(4, 3) * 3.0 + (ring_area(4, 3) - T * (3 + T)) * 2.4
    assert volume(corners(built, "wall")) == pytest.approx(expected)
    rays = Rays(built)
    assert rays.hit((6, 1.5, 2.8), (-1, 0, 0)).name == "high/wall"


@settings(max_examples=25)
@given(angle=st.floats(0.0, 2 * math.pi), dx=st.floats(-50, 50), dy=st.floats(-50, 50))
def test_turning_a_house_changes_no_volume_or_area(angle, dx, dy):
    rooms, openings = two_rooms(gap=0.25, width=1.0, height=2.0)
    c, s = math.cos(angle), math.sin(angle)

    def turned(p):
        return [c * p[0] - s * p[1] + dx, s * p[0] + c * p[1] + dy]

    moved = [{**r, "polygon": [turned(p) for p in r["polygon"]]} for r in rooms]
    moved_openings = [{**o, "center": turned(o["center"])} for o in openings]
    built, reference = scene(moved, moved_openings), scene(rooms, openings)
    for category in ("wall", "floor", "ceiling", "door"):
        ours, theirs = corners(built, category), corners(reference, category)
        assert area(ours) == pytest.approx(area(theirs), rel=1e-3)
    walls = volume(corners(built, "wall") - [dx, dy, 0])
    assert walls == pytest.approx(volume(corners(reference, "wall")), rel=1e-3)


def test_an_opening_takes_its_volume_out_of_the_wall_and_leaves_a_lintel():
    rooms, openings = two_rooms(width=0.9, height=2.05)
    solid, cut = scene(rooms), scene(rooms, openings)
    lost = volume(corners(solid, "wall")) - volume(corners(cut, "wall"))
    assert lost == pytest.approx(0.9 * T * 2.05)
    rays = Rays(cut)
    assert not rays.blocked((3, 1.5, 0.5), (5, 1.5, 0.5))
    assert rays.hit((3, 1.5, 2.3), (1, 0, 0)).category == "wall"
    assert rays.hit((4, 1.5, 1.0), (0, 0, 1)).category == "door"
    assert rays.distance((4, 1.5, 1.0), (0, 0, 1)) == pytest.approx(1.05, abs=FRAME_M)


@pytest.mark.parametrize("gap", [0.0, 0.15, 0.4, 1.0])
@pytest.mark.parametrize("kind", ["door", "open"])
def test_a_passage_is_as_wide_as_it_says_and_floored_throughout(gap, kind):
    rooms, openings = two_rooms(gap, width=0.9, height=2.05)
    openings[0]["kind"] = kind
    rays = Rays(scene(rooms, openings))
    width = clear_width(rays, 3.0, 5.0 + gap, 0.5, 1.5)
    narrowest = 0.9 - (FRAME_M if kind == "door" else 0.0)
    assert narrowest - 0.005 <= width <= 0.905
    for x in np.arange(3.0, 5.0 + gap, 0.01):
        assert rays.hit((x, 1.5, 1.0), (0, 0, -1)).category == "floor"
        assert rays.distance((x, 1.5, 1.0), (0, 0, -1)) == pytest.approx(1.0, abs=1e-5)


def test_an_opening_of_full_height_has_no_lintel():
    rooms, openings = two_rooms(width=1.2, height=2.6)
    openings[0]["kind"] = "open"
    rays = Rays(scene(rooms, openings))
    assert not rays.blocked((3, 1.5, 2.59), (5, 1.5, 2.59))


def test_an_opening_as_wide_as_its_wall_leaves_the_side_walls_whole():
    rooms, openings = two_rooms(width=3.0, height=2.2)
    openings[0]["kind"] = "open"
    built = scene(rooms, openings)
    rays = Rays(built)
    assert not rays.blocked((3, 0.1, 1), (5, 0.1, 1))
    for x in np.linspace(3.3, 4.7, 29):
        assert rays.distance((x, 1.5, 1), (0, -1, 0)) == pytest.approx(1.5 - T / 2, abs=1e-5)
        assert rays.distance((x, -2, 1), (0, 1, 0)) == pytest.approx(2 - T / 2, abs=1e-5)


def test_an_opening_cuts_free_standing_walls_within_its_reach_only():
    rooms, openings = two_rooms(width=0.9)
    near = {"points": [[4.4, 0.5], [4.4, 2.5]]}
    far = {"points": [[5.2, 0.5], [5.2, 2.5]]}
    rays = Rays(scene(rooms, openings, walls=[near, far]))
    assert not rays.blocked((3.5, 1.5, 1), (5.0, 1.5, 1))
    assert rays.hit((3.5, 1.5, 1), (1, 0, 0), 1.7 - T / 2 + 1e-3) is not None
    assert rays.blocked((4.2, 2.3, 1), (4.6, 2.3, 1))


def test_a_door_into_a_closet_does_not_break_through_its_back():
    rooms = [
        room("hall", 0, 0, 4, 3),
        room("closet", 4, 0, 4.5, 3),
        room("study", 4.5, 0, 8, 3),
    ]
    rays = Rays(scene(rooms, [door(["hall", "closet"], [4, 1.5])]))
    assert not rays.blocked((3, 1.5, 1), (4.3, 1.5, 1))
    assert rays.hit((4.2, 1.5, 1), (1, 0, 0)).name == "closet/wall"
    assert rays.distance((4.2, 1.5, 1), (1, 0, 0)) == pytest.approx(0.3 - T / 2, abs=1e-5)


def test_an_outer_door_is_shut():
    built = scene([room("a", 0, 0, 4, 3)], [door(["a"], [2, 0], width=0.9)])
    rays = Rays(built)
    for x in np.linspace(1.6, 2.4, 17):
        for z in np.linspace(0.02, 2.0, 12):
            assert rays.hit((x, 1.5, z), (0, -1, 0), 1.6).category == "door"


def test_a_room_that_is_not_enclosed_has_no_walls():
    open_plan = [room("a", 0, 0, 4, 3), room("b", 4, 0, 8, 3, enclosed=False)]
    built = scene(open_plan)
    assert volume(corners(built, "wall")) == pytest.approx(ring_area(4, 3) * 2.6)
    assert Rays(built).hit((6, 1.5, 1), (1, 0, 0)) is None


def test_a_free_standing_wall_follows_its_points():
    wall = {"points": [[1, 1], [3, 1], [3, 2]], "height": 1.2, "thickness": 0.2}
    built = scene([room("a", 0, 0, 5, 4)], walls=[wall])
    plain = scene([room("a", 0, 0, 5, 4)])
    # A mitred corner adds half the thickness to both legs.
    expected = (2.1 + 1.1) * 0.2 * 1.2 - 0.2 * 0.2 * 1.2
    assert volume(corners(built, "wall")) - volume(corners(plain, "wall")) == pytest.approx(
        expected
    )
    assert not Rays(built).blocked((2, 0.5, 1.3), (2, 1.5, 1.3))


def test_wall_faces_belong_to_the_room_that_they_face():
    rooms = [
        room("bath", 0, 0, 4, 3, type="bathroom"),
        room("bed", 4, 0, 8, 3, type="bedroom"),
    ]
    built = scene(rooms)
    rays = Rays(built)
    assert rays.hit((2, 1.5, 1), (1, 0, 0)).name == "bath/wall"
    assert rays.hit((6, 1.5, 1), (-1, 0, 0)).name == "bed/wall"
    assert rays.hit((-2, 1.5, 1), (1, 0, 0)).name == "level 0/outside/wall"
    materials = {
        instance.name: {
            built.mesh.materials[k].name
            for k in built.mesh.face_material[built.mesh.face_instance == instance.id]
        }
        for instance in built.mesh.instances
    }
    assert materials["bath/wall"] == {"tiles"}
    assert materials["bed/wall"] == {"plaster"}
    assert OUTSIDE.material in built.mesh.materials


def test_a_wall_face_is_divided_where_rooms_change():
    rooms = [room("a", 0, 0, 4, 3, enclosed=False), room("b", 4, 0, 8, 3, enclosed=False)]
    built = scene(rooms, walls=[{"points": [[1, 1.5], [7, 1.5]]}])
    for name, low, high in (("a/wall", 1, 4), ("b/wall", 4, 7)):
        face = corners(built, name=name)
        face = face[np.ptp(face[..., 2], axis=1) > 0]
        assert face[..., 0].min() == pytest.approx(low, abs=1e-4)
        assert face[..., 0].max() == pytest.approx(high, abs=1e-4)


# --- floors and ceilings -----------------------------------------------------------------------


def test_concave_rooms_have_floors_and_ceilings_of_their_own_shape():
    polygon = [[0, 0], [5, 0], [5, 2], [3, 2], [3, 4], [5, 4], [5, 6], [0, 6]]
    built = scene([{"id": "c", "polygon": polygon[::-1], "height": 2.7}])
    for category, z, up in (("floor", 0.0, 1.0), ("ceiling", 2.7, -1.0)):
        faces = corners(built, category)
        assert area(faces) == pytest.approx(Polygon(polygon).area)
        np.testing.assert_allclose(faces[..., 2], z)
        normals = np.cross(faces[:, 1] - faces[:, 0], faces[:, 2] - faces[:, 0])
        assert (up * normals[:, 2] > 0).all()
        middles = faces.mean(axis=1)
        assert contains_xy(Polygon(polygon), middles[:, 0], middles[:, 1]).all()


def test_overlapping_rooms_have_one_floor():
    built = scene([room("a", 0, 0, 4, 3), room("b", 3, 1, 7, 5)])
    union = union_all(
        [Polygon(r["polygon"]) for r in (room("a", 0, 0, 4, 3), room("b", 3, 1, 7, 5))]
    )
    assert area(corners(built, "floor")) == pytest.approx(union.area)


def test_textures_repeat_in_metres():
    built = scene([room("a", 0, 0, 4, 3, type="bathroom")])
    mesh = built.mesh
    (floor,) = (i.id for i in mesh.instances if i.category == "floor")
    faces = mesh.face_instance == floor
    points, uv = mesh.vertices[mesh.faces[faces]], mesh.face_uv[faces]
    np.testing.assert_allclose(np.ptp(uv[..., 0]) / np.ptp(points[..., 0]), 1 / 0.4, rtol=1e-5)
    (wall,) = (i.id for i in mesh.instances if i.name == "a/wall")
    faces = mesh.face_instance == wall
    points, uv = mesh.vertices[mesh.faces[faces]], mesh.face_uv[faces]
    edges = np.linalg.norm(points[:, 1] - points[:, 0], axis=1)
    repeats = np.linalg.norm(uv[:, 1] - uv[:, 0], axis=1)
    np.testing.assert_allclose(repeats / edges, 1 / 0.3, rtol=1e-4)


# --- stairs ------------------------------------------------------------------------------------


def two_storeys(angle=0.0, reverse=False, rise=2.8):
    """A flight of 4 m by 1 m in the middle of a 8 m by 6 m hall, below the same hall."""
    c, s = math.cos(angle), math.sin(angle)
    flight = {
        "from_level": 0,
        "to_level": 1,
        "start": [-2 * c, -2 * s],
        "end": [2 * c, 2 * s],
        "width": 1.0,
    }
    if reverse:
        flight |= {"from_level": 1, "to_level": 0, "start": flight["end"], "end": flight["start"]}
    levels = [
        {"floor": 0.0, "rooms": [room("hall", -4, -4, 4, 4)]},
        {"floor": rise, "rooms": [room("landing", -4, -4, 4, 4)]},
    ]
    return House.model_validate({"name": "stairs", "levels": levels, "stairs": [flight]})


@pytest.mark.parametrize("rise", [2.8, 3.4])
@pytest.mark.parametrize("angle", [0.0, math.pi / 2, 0.6])
def test_an_agent_walks_up_and_down_stairs(angle, rise):
    built = build_scene(two_storeys(angle, rise=rise))
    surface = NavigableSurface.build(built.mesh, AgentBody(), built.floors)
    ahead = np.array([math.cos(angle), math.sin(angle), 0.0])
    below, above = -3.0 * ahead, 3.0 * ahead + [0, 0, rise]
    flight = math.hypot(4.0, rise) + 2.0
    assert surface.geodesic_distance(below, above) == pytest.approx(flight, rel=0.1)
    assert surface.geodesic_distance(above, below) == pytest.approx(flight, rel=0.1)


def step_heights(rays, places):
    """z of the flight of `two_storeys`, which runs along x, seen through its stairwell or below."""
    heights = []
    for x in places:
        from_above = rays.hit((x, 0.2, 4.0), (0, 0, -1))
        eye = 4.0 if from_above.category == "stairs" or x > 1.9 else 2.55
        heights.append(eye - rays.distance((x, 0.2, eye), (0, 0, -1)))
    return np.array(heights)


def test_steps_are_equal_low_and_end_flush_with_the_upper_floor():
    heights = step_heights(Rays(build_scene(two_storeys())), np.arange(-2.2, 2.2, 0.01))
    risers = np.diff(heights)
    assert (risers > -1e-5).all()
    risers = risers[risers > 1e-3]
    np.testing.assert_allclose(risers, 2.8 / len(risers), atol=1e-5)
    assert risers.max() <= MAX_RISER_M
    assert heights[0] == pytest.approx(0.0, abs=1e-5)
    assert heights[-1] == pytest.approx(2.8, abs=1e-5)


def test_a_flight_may_be_named_from_either_end():
    up, down = build_scene(two_storeys()), build_scene(two_storeys(reverse=True))
    np.testing.assert_allclose(up.mesh.vertices, down.mesh.vertices, atol=1e-9)


def test_people_have_headroom_on_the_whole_flight():
    rays = Rays(build_scene(two_storeys()))
    places = np.arange(-1.99, 2.0, 0.02)
    for x, step in zip(places, step_heights(rays, places), strict=True):
        # Headroom counts from the line through the steps' edges, up to one step below them.
        assert rays.distance((x, 0.2, step + 0.01), (0, 0, 1)) >= 2.1 - MAX_RISER_M - 0.01


def test_a_rail_guards_the_stairwell_but_not_its_head():
    rays = Rays(build_scene(two_storeys()))
    z = 2.8 + 0.6
    assert not rays.blocked((3, 0, z), (1, 0, z))
    assert rays.blocked((0.5, 2, z), (0.5, 0, z))
    assert rays.blocked((0.5, -2, z), (0.5, 0, z))
    assert rays.blocked((-3.5, 0, z), (1, 0, z))
    assert not rays.blocked((0.5, 2, 2.8 + 1.0), (0.5, 0, 2.8 + 1.0))


def test_nobody_walks_under_a_flight_or_sees_into_a_slab():
    built = build_scene(two_storeys())
    rays = Rays(built)
    for x in np.linspace(-1.7, 1.95, 20):
        assert rays.hit((x, 2, 0.1), (0, -1, 0), 1.5 + 1e-3).category == "stairs"
    assert count_leaks(built, two_storeys()) == 0


def test_stairs_of_three_storeys_open_only_their_own_floors():
    levels = [
        {"floor": 3.0 * k, "rooms": [room(f"r{k}", -6, -6, 6, 6, height=2.8)]} for k in range(3)
    ]
    stairs = [
        {"from_level": 0, "to_level": 1, "start": [-4, -3], "end": [0, -3]},
        {"from_level": 1, "to_level": 2, "start": [-4, 3], "end": [0, 3]},
    ]
    tall = House.model_validate({"name": "tower", "levels": levels, "stairs": stairs})
    built = build_scene(tall)
    rays = Rays(built)
    assert rays.hit((-0.2, 3, 1.0), (0, 0, 1)).name == "r0/ceiling"
    assert rays.hit((-0.2, -3, 3.5), (0, 0, 1)).name == "r1/ceiling"
    assert rays.hit((-0.2, -3, 3.5), (0, 0, -1)).category == "stairs"
    surface = NavigableSurface.build(built.mesh, AgentBody(), built.floors)
    assert math.isfinite(surface.geodesic_distance((-5, -3, 0), (5, 5, 6)))
    assert count_leaks(built, tall) == 0


# --- closed houses -----------------------------------------------------------------------------


def count_leaks(built, plan, rays_per_room=2000):
    """Rays from inside the rooms of a closed house that leave it."""
    rng = np.random.default_rng(0)
    caster = RayCaster(built.mesh)
    leaks = 0
    for level in plan.levels:
        for item in level.rooms:
            inner = Polygon(item.polygon).buffer(-0.1)
            low, high = np.reshape(inner.bounds, (2, 2))
            places = rng.uniform(low, high, size=(rays_per_room, 2))
            places = places[contains_xy(inner, places[:, 0], places[:, 1])]
            z = level.floor + rng.uniform(0.1, item.height - 0.1, size=len(places))
            directions = rng.normal(size=(len(places), 3))
            hits = caster.cast(np.column_stack([places, z]), directions)
            leaks += int((hits.face < 0).sum())
    return leaks


@pytest.mark.parametrize("gap", [0.0, 0.05, 0.3, 0.9])
@pytest.mark.parametrize("kind", ["door", "open"])
def test_no_ray_leaves_a_closed_house(gap, kind):
    rooms, openings = two_rooms(gap, width=1.1, height=2.1)
    rooms[1]["height"] = 3.1
    openings[0]["kind"] = kind
    openings.append(door(["west"], [0, 1.5]))
    plan = house(rooms, openings)
    assert count_leaks(build_scene(plan), plan) == 0


@pytest.mark.parametrize("spec", ["generated:1", "generated:3"])
def test_generated_houses_are_closed_and_connected(spec):
    check_house(load_house_spec(spec))


@pytest.mark.parametrize("name", ["00006-HkseAnWCgqk", "00222-g8Xrdbe9fir"])
def test_imported_homes_are_closed_and_connected(name):
    check_house(load_house_spec(str(shared_data(f"layouts/domestigraph/{name}.yaml"))))


def check_house(plan):
    built = build_scene(plan)
    assert count_leaks(built, plan, 500) == 0
    surface = NavigableSurface.build(built.mesh, AgentBody(), built.floors)
    graph = surface.graph
    x, y = (
        origin + (cells + 0.5) * graph.cell_size
        for origin, cells in zip(graph.origin, (graph.x, graph.y), strict=True)
    )
    islands = Counter()
    for level in plan.levels:
        for item in level.rooms:
            inside = contains_xy(Polygon(item.polygon), x, y) & (abs(graph.z - level.floor) < 0.1)
            islands[int(np.bincount(graph.island[inside]).argmax())] += 1
    assert len(islands) == 1
    everywhere = union_all([Polygon(r.polygon) for level in plan.levels for r in level.rooms])
    assert contains_xy(everywhere.buffer(0.5), x, y)[graph.island == next(iter(islands))].all()


# --- objects -----------------------------------------------------------------------------------


def test_objects_are_instances_in_their_place():
    objects = [
        thing("o1", "couch", (1, 2, 0), (2.0, 0.9, 0.8), yaw=math.pi / 2),
        thing("o2", "TV", (3, 1, 0.9), (1.0, 0.1, 0.6)),
    ]
    built = scene([room("a", 0, 0, 5, 4)], objects=objects)
    by_name = {i.name: i for i in built.mesh.instances}
    assert by_name["o1"].category == "sofa"
    assert by_name["o2"].category == "tv_monitor"
    sofa = corners(built, name="o1").reshape(-1, 3)
    np.testing.assert_allclose(sofa.min(axis=0), (1 - 0.45, 2 - 1.0, 0), atol=1e-6)
    np.testing.assert_allclose(sofa.max(axis=0), (1 + 0.45, 2 + 1.0, 0.8), atol=1e-6)
    # The back is at local +y, which a quarter turn counter-clockwise takes to -x.
    assert sofa[sofa[:, 0] < 0.8, 2].max() > sofa[sofa[:, 0] > 1.2, 2].max() + 0.1
    assert corners(built, name="o2")[..., 2].min() == pytest.approx(0.9)


def test_chairs_of_one_size_are_a_set():
    same = {"category": "chair", "size": (0.46, 0.5, 0.9)}
    built = scene([room("a", 0, 0, 5, 4)], objects=[thing("c1", **same), thing("c2", **same)])
    np.testing.assert_allclose(corners(built, name="c1"), corners(built, name="c2"))


def test_instances_are_numbered_in_order_and_named_uniquely():
    levels = [
        {"floor": 3.0 * k, "rooms": [room("a", 0, 0, 5, 4)], "objects": [thing("lamp", "lamp")]}
        for k in range(2)
    ]
    built = build_scene(House.model_validate({"name": "twins", "levels": levels}))
    instances = built.mesh.instances
    assert [i.id for i in instances] == list(range(len(instances)))
    assert len({i.name for i in instances}) == len(instances)
    assert sum(i.category == "lamp" for i in instances) == 2
    assert set(np.unique(built.mesh.face_instance)) == set(range(len(instances)))


def test_equal_houses_give_equal_meshes():
    first, again = (build_scene(load_house_spec("generated:2")).mesh for _ in range(2))
    np.testing.assert_array_equal(first.vertices, again.vertices)
    np.testing.assert_array_equal(first.face_material, again.face_material)
    assert first.instances == again.instances


def test_a_thousand_objects_share_their_materials():
    objects = [
        thing(f"o{k}", "chair", (k % 40, k // 40, 0), (0.4 + k / 9999, 0.5, 0.9))
        for k in range(1000)
    ]
    built = scene([room("hall", -1, -1, 41, 27)], objects=objects)
    assert sum(i.category == "chair" for i in built.mesh.instances) == 1000
    assert len(built.mesh.materials) < 80


def test_the_scene_tells_floors_rooms_and_episodes():
    plan = house(
        [room("a", 0, 0, 5, 4, type="kitchen")],
        episodes=[{"target": "couch", "start": [1, 1, 0], "yaw": 0.5}],
    )
    built = build_scene(plan)
    assert built.name == "test"
    assert built.floors == (0.0,)
    assert [(e.target, e.start, e.yaw) for e in built.episodes] == [("sofa", (1, 1, 0), 0.5)]
    ((kind, level, polygon),) = built.room_types
    assert (kind, level, polygon.shape) == ("kitchen", 0, (4, 2))


# --- mesh files --------------------------------------------------------------------------------


def write_arrow(path):
    """A y-up mesh whose tip points up and which is deepest to its front, +z, and coloured."""
    parts = [
        trimesh.creation.box(bounds=[(0, 0, 0), (4, 1, 1)]),
        trimesh.creation.box(bounds=[(1, 1, 0), (2, 3, 0.5)]),
        trimesh.creation.box(bounds=[(0, 0, 1), (1, 0.5, 2)]),
    ]
    mesh = trimesh.util.concatenate(parts)
    color = trimesh.visual.material.PBRMaterial(baseColorFactor=(200, 30, 40, 255))
    mesh.visual = trimesh.visual.TextureVisuals(
        uv=np.zeros((len(mesh.vertices), 2)), material=color
    )
    mesh.export(path)


def test_a_mesh_file_is_turned_scaled_and_placed(tmp_path):
    write_arrow(tmp_path / "arrow.glb")
    item = thing("o1", "sculpture", (2, 2, 0.5), (0.8, 0.4, 1.5), mesh="arrow.glb")
    built = build_scene(house([room("a", 0, 0, 5, 4)], objects=[item]), tmp_path)
    points = corners(built, name="o1").reshape(-1, 3)
    np.testing.assert_allclose(points.min(axis=0), (1.6, 1.8, 0.5), atol=1e-6)
    np.testing.assert_allclose(points.max(axis=0), (2.4, 2.2, 2.0), atol=1e-6)
    tip = points[points[:, 2] > 1.5]
    assert tip[:, 0].max() == pytest.approx(2.0)
    nose = points[points[:, 1] < 1.9]
    assert nose[:, 0].max() == pytest.approx(1.8)
    (instance,) = (i.id for i in built.mesh.instances if i.name == "o1")
    (material,) = np.unique(built.mesh.face_material[built.mesh.face_instance == instance])
    np.testing.assert_allclose(
        built.mesh.materials[material].texture.mean(axis=(0, 1)), (200, 30, 40), atol=2
    )


def test_flat_upright_meshes_are_not_laid_down(tmp_path):
    """The largest plane of a picture is no floor."""
    trimesh.creation.box(extents=(2.0, 1.0, 0.05)).export(tmp_path / "picture.glb")
    item = thing("o1", "picture", (2, 2, 1.0), (2.0, 0.05, 1.0), mesh="picture.glb")
    built = build_scene(house([room("a", 0, 0, 5, 4)], objects=[item]), tmp_path)
    upright = corners(built, name="o1")
    assert area(upright) == pytest.approx(2 * (2 * 1 + 2 * 0.05 + 1 * 0.05))


def test_one_file_serves_many_objects(tmp_path):
    write_arrow(tmp_path / "arrow.glb")
    items = [thing(f"o{k}", position=(1 + k, 1, 0), mesh="arrow.glb") for k in range(3)]
    built = build_scene(house([room("a", 0, 0, 5, 4)], objects=items), tmp_path)
    bare = scene([room("a", 0, 0, 5, 4)])
    assert len(built.mesh.materials) == len(bare.mesh.materials) + 1


@pytest.mark.parametrize("name", ["missing.glb", "broken.glb", "empty.ply", "notes.txt"])
def test_a_bad_mesh_file_is_one_line_with_its_name_and_object(tmp_path, name):
    (tmp_path / "broken.glb").write_bytes(b"glTF?")
    (tmp_path / "empty.ply").write_text("")
    (tmp_path / "notes.txt").write_text("a chair")
    plan = house([room("a", 0, 0, 5, 4)], objects=[thing("the chair", mesh=name)])
    with pytest.raises(SceneError) as failure:
        build_scene(plan, tmp_path)
    message = str(failure.value)
    assert name in message
    assert "the chair" in message
    assert "\n" not in message


def test_a_mesh_needs_a_folder():
    plan = house([room("a", 0, 0, 5, 4)], objects=[thing("o1", mesh="arrow.glb")])
    with pytest.raises(SceneError, match=r"'o1'.*'arrow.glb'"):
        build_scene(plan)


def test_an_invalid_house_is_refused():
    with pytest.raises(SceneError, match="no room 'b'"):
        scene([room("a", 0, 0, 4, 3)], [door(["a", "b"], [4, 1.5])])
