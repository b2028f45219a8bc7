"""Furniture fills its box, faces the right way and is made of closed, well oriented solids."""

import math

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from toponav.categories import CONTEXT_CATEGORIES, HM3D_TARGETS, MP3D_TARGETS
from toponav.scenes.finishes import room_finish
from toponav.scenes.furniture import BUILDERS, build_furniture
from toponav.scenes.furniture.primitives import (
    blade,
    box,
    cylinder,
    ellipsoid,
    extruded,
    lathe,
    picture,
    rounded_box,
    tube,
)
from toponav.scenes.furniture_sizes import SIZE_RANGES, draw_size
from toponav.scenes.textures import book_spines, paint, planks, tiles

CATEGORIES = sorted({*BUILDERS, *HM3D_TARGETS, *MP3D_TARGETS, *CONTEXT_CATEGORIES})
GREY = paint((128, 128, 128))
MAX_TRIANGLES = 800
LENGTHS = st.floats(0.02, 4.0)


def corners(piece):
    return piece.vertices[piece.faces]


def signed_volume(triangles):
    """Divergence theorem: positive for closed surfaces whose normals point outwards."""
    a, b, c = triangles.swapaxes(0, 1)
    return float((a * np.cross(b, c)).sum() / 6.0)


def areas(triangles):
    a, b, c = triangles.swapaxes(0, 1)
    return np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2.0


def normals(triangles):
    normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    return normal / np.linalg.norm(normal, axis=1, keepdims=True)


def height_profile(piece, near_y):
    """Highest vertex of the back (+y) or front (-y) quarter of a piece."""
    y = piece.vertices[:, 1] * near_y
    return piece.vertices[y > 0.25 * np.ptp(piece.vertices[:, 1]), 2].max()


def test_every_category_of_the_benchmarks_has_a_shape_of_its_own():
    assert {*HM3D_TARGETS, *MP3D_TARGETS, *CONTEXT_CATEGORIES} <= set(BUILDERS)


@pytest.mark.parametrize("category", [*CATEGORIES, "zebra"])
def test_pieces_of_usual_size_are_valid_meshes(category):
    for variant in range(6):
        size = draw_size(category, np.random.default_rng(variant))
        piece = build_furniture(category, size, variant)
        assert np.isfinite(piece.vertices).all()
        low, high = piece.vertices.min(axis=0), piece.vertices.max(axis=0)
        np.testing.assert_allclose(low, [-size[0] / 2, -size[1] / 2, 0], atol=1e-9)
        np.testing.assert_allclose(high, [size[0] / 2, size[1] / 2, size[2]], atol=1e-9)
        assert piece.faces.dtype == np.int32
        assert piece.faces.min() == 0
        assert piece.faces.max() == len(piece.vertices) - 1
        assert piece.face_uv.shape == (len(piece.faces), 3, 2)
        assert np.isfinite(piece.face_uv).all()
        assert set(piece.face_material) == set(range(len(piece.materials)))
        assert len(piece.faces) <= MAX_TRIANGLES


@settings(max_examples=150)
@given(
    category=st.sampled_from(CATEGORIES),
    size=st.tuples(LENGTHS, LENGTHS, LENGTHS),
    variant=st.integers(-10, 2**32),
)
@example(category="shower", size=(1.0, 1.0, 1.02), variant=0)  # its head at its foot
@example(category="bathtub", size=(1.0, 1.0, 0.57), variant=0)
def test_any_size_is_filled_exactly(category, size, variant):
    piece = build_furniture(category, size, variant)
    assert np.isfinite(piece.vertices).all()
    np.testing.assert_allclose(np.ptp(piece.vertices, axis=0), size, atol=1e-3)
    np.testing.assert_allclose(piece.vertices[:, 2].min(), 0.0, atol=1e-9)


def test_equal_arguments_give_equal_pieces_and_variants_differ():
    size = (1.9, 0.9, 0.8)
    first, again = build_furniture("sofa", size, 4), build_furniture("couch", size, 4)
    np.testing.assert_array_equal(first.vertices, again.vertices)
    assert all(a is b for a, b in zip(first.materials, again.materials, strict=True))
    looks = {
        tuple(id(material) for material in build_furniture("sofa", size, k).materials)
        for k in range(12)
    }
    assert len(looks) >= 4


def test_an_unknown_category_is_a_box():
    piece = build_furniture("flux capacitor", (0.4, 0.3, 0.2))
    assert len(piece.faces) == 12
    assert signed_volume(corners(piece)) == pytest.approx(0.4 * 0.3 * 0.2)


@pytest.mark.parametrize(
    ("category", "size"),
    [
        ("bed", (1.6, 2.0, 1.0)),
        ("sofa", (2.0, 0.9, 0.85)),
        ("chair", (0.46, 0.5, 0.9)),
        ("chair", (0.8, 0.8, 0.85)),
        ("toilet", (0.4, 0.7, 0.8)),
        ("bench", (1.2, 0.5, 0.85)),
        ("piano", (1.5, 0.6, 1.2)),
        ("stairs", (1.0, 2.0, 1.2)),
    ],
)
def test_backs_are_at_plus_y(category, size):
    for variant in range(8):
        piece = build_furniture(category, size, variant)
        assert height_profile(piece, 1.0) > 0.97 * size[2]
        assert height_profile(piece, -1.0) < 0.93 * size[2]


@pytest.mark.parametrize(
    ("category", "size"),
    [("tv_monitor", (1.1, 0.18, 0.7)), ("tv_monitor", (1.2, 0.06, 0.7)),
     ("tv_monitor", (0.55, 0.2, 0.45)), ("picture", (0.8, 0.04, 0.6))],
)  # fmt: skip
def test_images_face_the_front_upright_and_fill_most_of_it(category, size):
    piece = build_furniture(category, size, 3)
    names = ("television image", "desktop image", "artwork")
    images = [k for k, material in enumerate(piece.materials) if material.name in names]
    assert len(images) == 1
    shown = piece.face_material == images[0]
    triangles = corners(piece)[shown]
    np.testing.assert_allclose(normals(triangles), [[0.0, -1.0, 0.0]] * len(triangles), atol=1e-9)
    assert np.ptp(triangles[..., 0]) > 0.7 * size[0]
    assert np.ptp(triangles[..., 2]) > 0.6 * size[2]
    uv = piece.face_uv[shown]
    assert np.corrcoef(uv[..., 0].ravel(), triangles[..., 0].ravel())[0, 1] > 0.999
    assert np.corrcoef(uv[..., 1].ravel(), triangles[..., 2].ravel())[0, 1] > 0.999


def test_there_is_room_under_a_table_and_between_its_legs():
    piece = build_furniture("table", (1.6, 0.9, 0.75))
    inside = np.abs(corners(piece).mean(axis=1)[:, :2]) < (0.6, 0.25)
    assert corners(piece)[inside.all(axis=1)][..., 2].min() > 0.6


def test_bookshelves_hold_books_on_every_shelf():
    piece = build_furniture("bookshelf", (0.9, 0.3, 2.0), 1)
    books = [k for k, m in enumerate(piece.materials) if m.name == "book spines"]
    heights = corners(piece)[np.isin(piece.face_material, books)][..., 2]
    shelves = np.unique(np.floor(heights.min(axis=1) / 0.33))
    assert len(shelves) >= 5


@given(size=st.tuples(LENGTHS, LENGTHS, LENGTHS), radius=st.floats(0.001, 1.0))
def test_boxes_are_closed_and_chamfers_take_off_little(size, radius):
    volume = math.prod(size)
    assert signed_volume(box((0, 0, 0), size, GREY).corners) == pytest.approx(volume)
    rounded = rounded_box((0.0, 0.0, 0.0), size, radius, GREY)
    assert len(rounded.corners) == 44
    a, b, c = (min(radius, 0.49 * s) for s in size)
    # An edge loses a triangular prism; where three meet, inclusion and exclusion leave 5/6 abc.
    prisms = sum(
        0.5 * p * q * 4 * (s - 2 * r)
        for s, r, p, q in ((size[0], a, b, c), (size[1], b, a, c), (size[2], c, a, b))
    )
    lost = prisms + 8 * (5.0 / 6.0) * a * b * c
    assert signed_volume(rounded.corners) == pytest.approx(volume - lost, rel=1e-6)


def test_round_solids_approach_their_ideal_volumes():
    round_cylinder = cylinder((0.3, -0.2, 0.1), 0.5, 2.0, GREY, segments=64)
    assert signed_volume(round_cylinder.corners) == pytest.approx(math.pi * 0.25 * 2.0, rel=0.01)
    ball = ellipsoid((1.0, 2.0, 3.0), (0.3, 0.5, 0.7), GREY, segments=64)
    assert signed_volume(ball.corners) == pytest.approx(4 / 3 * math.pi * 0.3 * 0.5 * 0.7, rel=0.01)
    cone = lathe([(0.0, 0.0), (1.0, 0.0), (0.0, 3.0)], GREY, segments=64)
    assert signed_volume(cone.corners) == pytest.approx(math.pi, rel=0.01)


def test_extrusion_of_an_outline():
    outline = [(0.0, 0.0), (2.0, 0.0), (1.0, 1.5)]
    assert signed_volume(extruded(outline, -1.0, 2.0, GREY).corners) == pytest.approx(1.5 * 3.0)


def test_tubes_join_their_ends():
    rod = tube((0.0, 0.0, 0.0), (1.0, 2.0, 2.0), 0.1, GREY, segments=12).corners.reshape(-1, 3)
    axis = np.array([1.0, 2.0, 2.0]) / 3.0
    along = rod @ axis
    assert set(np.round(along, 9)) == {0.0, 3.0}
    np.testing.assert_allclose(np.linalg.norm(rod - along[:, None] * axis, axis=1), 0.1)


def test_blades_taper_to_a_point_without_degenerate_triangles():
    leaf = blade([(0, 0, 0), (0, 0, 1), (0, 0, 2)], (0.2, 0.3, 0.0), (1.0, 0.0, 0.0), GREY)
    assert areas(leaf.corners).min() > 0.0
    assert areas(leaf.corners).sum() == pytest.approx(0.25 * 1.0 + 0.15 * 1.0)


def test_turning_and_moving_a_part():
    part = box((0, 0, 0), (1, 2, 3), GREY).turned("z", 90.0).moved((0.0, 0.0, 1.0))
    np.testing.assert_allclose(part.corners.min(axis=(0, 1)), (-2, 0, 1), atol=1e-12)
    np.testing.assert_allclose(part.corners.max(axis=(0, 1)), (0, 1, 4), atol=1e-12)
    tilted = picture((0, 0, 1), 1, 1, GREY).turned("x", -90.0, (0.0, 0.0, 1.0))
    np.testing.assert_allclose(normals(tilted.corners), [[0, 0, 1], [0, 0, 1]], atol=1e-12)


def test_textures_have_their_real_size():
    face = box((0, 0, 0), (3.0, 1.0, 2.0), tiles((200, 200, 200), 0.25))
    span = np.ptp(face.uv.reshape(-1, 2), axis=0)
    np.testing.assert_allclose(span, (3.0 / 0.5, 2.0 / 0.5))


def test_surfaces_are_cached_seeded_images():
    assert planks((150, 100, 60), 1) is planks((150, 100, 60), 1)
    first, second = book_spines(0).material.texture, book_spines(1).material.texture
    assert first.dtype == np.uint8
    assert (first != second).any()


@pytest.mark.parametrize("tone", [(30, 60, 90), (220, 180, 140)])
def test_surfaces_keep_their_tone_and_tile_without_a_seam(tone):
    texture = planks(tone, 2).material.texture.astype(float)
    np.testing.assert_allclose(texture.mean(axis=(0, 1)), tone, atol=16)
    grain = np.abs(np.diff(texture.mean(axis=2), axis=1)).mean()
    seam = np.abs(texture[:, 0] - texture[:, -1]).mean()
    assert seam < 4.0 * grain + 8.0


def test_rooms_look_like_what_they_are():
    assert {room_finish("bathroom", k).wall.material.name for k in range(6)} == {"tiles"}
    assert {room_finish("kitchen", k).floor.material.name for k in range(6)} == {"tiles"}
    assert {room_finish("bedroom", k).floor.material.name for k in range(12)} == {
        "carpet",
        "planks",
    }
    assert len({id(room_finish("living room", k).wall) for k in range(20)}) > 5
    assert room_finish("kitchen/living room", 3).floor is room_finish("kitchen", 3).floor
    assert room_finish("Observatory", 3).floor is room_finish("living_room", 3).floor


def test_sizes_are_known_for_all_shapes_but_stairs():
    assert set(BUILDERS) - set(SIZE_RANGES) <= {"stairs"}
