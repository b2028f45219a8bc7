"""Mesh files: parts and categories, up axes, floors, appearance, and files that are damaged."""

import json
import struct
from collections import Counter
from pathlib import Path

import numpy as np
import pytest
import trimesh
from PIL import Image
from trimesh.visual import TextureVisuals
from trimesh.visual.material import PBRMaterial

from shared_data import shared_data
from toponav.errors import SceneError
from toponav.scenes.export import scene_to_glb
from toponav.scenes.gltf import load_mesh_scene, structure_category
from toponav.scenes.label_table import load_label_table
from toponav.scenes.mesh_floors import detect_up_axis, find_floors

Y_UP = trimesh.transformations.rotation_matrix(-np.pi / 2, [1, 0, 0])
LABELS = Path(__file__).resolve().parents[2] / "examples" / "labels" / "aws_small_house.json"


def block(low, high):
    return trimesh.creation.box(bounds=[low, high])


def room(height=2.5):
    """A floor of 5 m x 4 m, a wall and a chair of (0.5, 0.4, 0.9) m, z up."""
    scene = trimesh.Scene()
    scene.add_geometry(block((0, 0, -0.1), (5, 4, 0)), node_name="Floor_01")
    scene.add_geometry(block((0, 0, 0), (0.1, 4, height)), node_name="HouseWallB_01.001")
    scene.add_geometry(block((2, 2, 0), (2.5, 2.4, 0.9)), node_name="ChairA_7")
    return scene


def write_glb(tmp_path, scene, up="y"):
    if up == "y":
        scene = scene.copy()
        scene.apply_transform(Y_UP)
    path = tmp_path / "room.glb"
    path.write_bytes(scene.export(file_type="glb"))
    return path


def categories(scene):
    return {instance.name: instance.category for instance in scene.mesh.instances}


def extents(scene, name):
    (index,) = (i.id for i in scene.mesh.instances if i.name == name)
    corners = scene.mesh.vertices[scene.mesh.faces[scene.mesh.face_instance == index]]
    return corners.reshape(-1, 3).min(axis=0), corners.reshape(-1, 3).max(axis=0)


@pytest.mark.parametrize("up", ["y", "z"])
def test_the_up_axis_is_found(tmp_path, up):
    scene = load_mesh_scene(write_glb(tmp_path, room(), up))
    low, high = extents(scene, "ChairA_7")
    np.testing.assert_allclose(low, (2, 2, 0), atol=1e-6)
    np.testing.assert_allclose(high, (2.5, 2.4, 0.9), atol=1e-6)
    assert scene.floors == (0.0,)
    assert scene.name == "room"


def test_the_up_axis_can_be_given(tmp_path):
    tower = trimesh.Scene()
    tower.add_geometry(block((0, 0, 0), (2, 2, 0.1)), node_name="floor")
    tower.add_geometry(block((0, 0, 0), (0.1, 2, 8)), node_name="wall")
    tower.add_geometry(block((0, 0, 0), (2, 0.1, 8)), node_name="other wall")
    path = write_glb(tmp_path, tower, "z")
    scene = load_mesh_scene(path, up="z")
    np.testing.assert_allclose(scene.mesh.vertices.max(axis=0), (2, 2, 8), atol=1e-6)


def test_names_of_structure_and_unknown_parts(tmp_path):
    assert categories(load_mesh_scene(write_glb(tmp_path, room()))) == {
        "Floor_01": "floor",
        "HouseWallB_01.001": "wall",
        "ChairA_7": "unknown",
    }


@pytest.mark.parametrize(
    ("name", "category"),
    [
        ("HouseWallB_01_001", "wall"),
        ("RoomWindow_01_007.84.0", "window"),
        ("ceiling", "ceiling"),
        ("Main_Staircase", "stairs"),
        ("FloorLamp", None),
        ("wallpaper_sample", None),
        ("DoorHandle_2", None),
        ("mesh_0042", None),
        ("", None),
    ],
)
def test_structure_is_told_by_the_last_word(name, category):
    assert structure_category(name) == category


def test_a_label_table_names_parts_and_the_first_match_wins(tmp_path):
    table = tmp_path / "labels.json"
    table.write_text(json.dumps({"chaira_?": "Dining Chair", "Chair*": "bed", "*": "clutter"}))
    assert categories(load_mesh_scene(write_glb(tmp_path, room()), table)) == {
        "Floor_01": "clutter",
        "HouseWallB_01.001": "clutter",
        "ChairA_7": "chair",
    }


def test_extras_name_a_node_and_all_below_it(tmp_path):
    scene = room()
    scene.graph.update(frame_to="Sofa group", metadata={"category": "Couch"})
    for index in range(2):
        scene.add_geometry(
            block((3 + index, 1, 0), (3.5 + index, 2, 0.8)),
            node_name=f"cushion {index}",
            parent_node_name="Sofa group",
        )
    table = tmp_path / "labels.json"
    table.write_text('{"cushion*": "cushion"}')
    loaded = load_mesh_scene(write_glb(tmp_path, scene, "z"), table)
    # One object of two meshes; what the file says of itself goes before the table.
    assert categories(loaded)["Sofa group"] == "sofa"
    assert len(loaded.mesh.instances) == 4
    low, high = extents(loaded, "Sofa group")
    np.testing.assert_allclose((low, high), ((3, 1, 0), (4.5, 2, 0.8)), atol=1e-6)


def test_primitives_of_one_mesh_are_one_part(tmp_path):
    """A mesh of two materials is two primitives in glTF; the reader invents names for them."""
    tree = trimesh.exchange.gltf.export_glb(room())
    length = struct.unpack("<I", tree[12:16])[0]
    header = json.loads(tree[20 : 20 + length])
    chair = next(n for n in header["nodes"] if n.get("name") == "ChairA_7")
    mesh = header["meshes"][chair["mesh"]]
    mesh["primitives"] = mesh["primitives"] * 2
    packed = json.dumps(header).encode()
    packed += b" " * (-len(packed) % 4)
    rest = tree[20 + length :]
    path = tmp_path / "two.glb"
    path.write_bytes(
        struct.pack("<4sII", b"glTF", 2, 20 + len(packed) + len(rest))
        + struct.pack("<I4s", len(packed), b"JSON")
        + packed
        + rest
    )
    scene = load_mesh_scene(path, up="z")
    assert sorted(categories(scene)) == ["ChairA_7", "Floor_01", "HouseWallB_01.001"]
    assert (np.array([i.id for i in scene.mesh.instances]) == np.arange(3)).all()
    counts = Counter(scene.mesh.face_instance.tolist())
    chair_id = next(i.id for i in scene.mesh.instances if i.name == "ChairA_7")
    assert counts[chair_id] == 24


def textured_floor(factor=None, colors=None):
    """A floor whose texture is red, green / blue, white; u along x, v along y."""
    pixels = np.array([[[255, 0, 0], [0, 255, 0]], [[0, 0, 255], [255, 255, 255]]], np.uint8)
    vertices = np.array([[0, 0, 0], [4, 0, 0], [4, 4, 0], [0, 4, 0]], float)
    uv = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], float)
    material = PBRMaterial(baseColorTexture=Image.fromarray(pixels), baseColorFactor=factor)
    visual = TextureVisuals(uv=uv, material=material)
    if colors is not None:
        visual.vertex_attributes["color"] = np.asarray(colors, np.uint8)
    mesh = trimesh.Trimesh(vertices, [[0, 1, 2], [0, 2, 3]], visual=visual, process=False)
    scene = trimesh.Scene()
    scene.add_geometry(mesh, node_name="floor")
    return scene


def test_textures_keep_their_orientation(tmp_path):
    scene = load_mesh_scene(write_glb(tmp_path, textured_floor()))
    (material,) = scene.mesh.materials
    assert material.texture.tolist() == [[[255, 0, 0], [0, 255, 0]], [[0, 0, 255], [255, 255, 255]]]
    corners = scene.mesh.vertices[scene.mesh.faces]
    # u grows with x, v with y: as the file was made.
    np.testing.assert_allclose(scene.mesh.face_uv, corners[..., :2] / 4.0, atol=1e-6)
    assert scene.mesh.corner_colors is None


def test_factors_and_vertex_colours_multiply_textures(tmp_path):
    floor = textured_floor([128, 255, 0, 255], [[10, 20, 30, 255]] * 4)
    scene = load_mesh_scene(write_glb(tmp_path, floor, "z"))
    (material,) = scene.mesh.materials
    assert material.texture[0, 0].tolist() == [128, 0, 0]
    assert material.texture[1, 1].tolist() == [128, 255, 0]
    assert (scene.mesh.corner_colors == (10, 20, 30)).all()


def test_vertex_colours_of_a_ply(tmp_path):
    mesh = block((0, 0, -0.1), (5, 4, 0))
    mesh.visual.vertex_colors = np.tile([200, 100, 50, 255], (len(mesh.vertices), 1))
    path = tmp_path / "scan.ply"
    mesh.export(path)
    scene = load_mesh_scene(path)
    assert (scene.mesh.corner_colors == (200, 100, 50)).all()
    assert [m.texture.tolist() for m in scene.mesh.materials] == [[[[255, 255, 255]]]]
    assert scene.floors == (0.0,)


def test_mirrored_parts_are_not_inside_out(tmp_path):
    scene = trimesh.Scene()
    scene.add_geometry(block((0, 0, -0.1), (5, 4, 0)), transform=np.diag([-1, 1, 1, 1.0]))
    loaded = load_mesh_scene(write_glb(tmp_path, scene))
    assert trimesh.Trimesh(loaded.mesh.vertices, loaded.mesh.faces).volume == pytest.approx(2.0)


def triangles(*blocks):
    return np.concatenate([item.triangles for item in blocks])


def test_floors_of_two_storeys():
    slabs = [block((0, 0, z - 0.2), (10, 8, z)) for z in (0.0, 2.8, 5.6)]
    table = block((2, 2, 0.7), (4, 3, 0.75))
    gallery = block((0, 0, 1.0), (4, 8, 1.2))  # too near to the floor to be a storey
    # The uppermost slab is the roof.
    assert find_floors(triangles(*slabs, table, gallery)) == (0.0, 2.8)
    # Single sheets may be wound either way.
    sheets = triangles(*slabs)
    sheets = sheets[np.isin(sheets[..., 2], (0.0, 2.8, 5.6)).all(axis=1)]
    assert len(sheets) == 6
    assert find_floors(sheets) == find_floors(sheets[:, ::-1]) == (0.0, 2.8)


def test_a_roof_without_rooms_below_is_a_floor():
    assert find_floors(triangles(block((0, 0, 0), (3, 3, 0.1)))) == (0.1,)


def test_up_axis_prefers_the_convention_of_the_format():
    cube = triangles(block((0, 0, 0), (3, 3, 3)))
    assert (detect_up_axis(cube, "y"), detect_up_axis(cube, "z")) == ("y", "z")
    flat = triangles(block((0, 0, 0), (8, 8, 3)))
    assert (detect_up_axis(flat, "y"), detect_up_axis(flat, "z")) == ("z", "z")


def assert_one_line(path, message, **options):
    with pytest.raises(SceneError) as caught:
        load_mesh_scene(path, **options)
    assert str(path) in str(caught.value)
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


def test_damaged_files(tmp_path):
    whole = write_glb(tmp_path, room()).read_bytes()
    for name, content in {
        "empty.glb": b"",
        "text.glb": b"not a mesh at all",
        "half.glb": whole[: len(whole) // 2],
        "header.glb": whole[:12],
        "noise.glb": whole[:400] + b"\xff" * 400 + whole[800:],
        "empty.ply": b"",
        "text.ply": b"hello",
        "empty.gltf": b"{}",
    }.items():
        (tmp_path / name).write_bytes(content)
        assert_one_line(tmp_path / name, "")


def test_a_gltf_without_its_buffer(tmp_path):
    files = room().export(file_type="gltf")
    (tmp_path / "room.gltf").write_bytes(files["model.gltf"])
    assert_one_line(tmp_path / "room.gltf", "damaged or incomplete")
    for name, content in files.items():
        (tmp_path / name).write_bytes(content)
    assert load_mesh_scene(tmp_path / "model.gltf").floors == (0.0,)


def test_meshes_that_are_no_scene(tmp_path):
    assert_one_line(tmp_path / "absent.glb", "no such file")
    (tmp_path / "house.txt").write_text("")
    assert_one_line(tmp_path / "house.txt", "not a mesh")
    chair = trimesh.Scene(block((0, 0, 0), (0.5, 0.5, 0.9)))
    assert_one_line(write_glb(tmp_path, chair), "no floor")
    (tmp_path / "points.ply").write_bytes(trimesh.PointCloud(np.eye(3)).export(file_type="ply"))
    assert_one_line(tmp_path / "points.ply", "no triangles")
    broken = block((0, 0, -0.1), (5, 4, 0))
    broken.vertices[0, 0] = np.nan
    assert_one_line(write_glb(tmp_path, trimesh.Scene(broken), "z"), "NaN or infinite")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("{", "not JSON: "),
        ("[]", "a label table is a JSON object"),
        ("{}", "a label table is a JSON object"),
        ('{"Bed*": 3}', "'Bed*': the category must be a name, not 3"),
        ('{"Bed*": " "}', "'Bed*'"),
    ],
)
def test_broken_label_tables(tmp_path, text, message):
    path = tmp_path / "labels.json"
    path.write_text(text)
    with pytest.raises(SceneError) as caught:
        load_label_table(path)
    assert str(caught.value).startswith(f"{path}: ")
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


def test_the_small_house():
    path = shared_data("scenes/aws_small_house/aws_small_house.glb")
    scene = load_mesh_scene(path, LABELS)
    # The file is z up, against its format's rule.
    np.testing.assert_allclose(scene.mesh.vertices.min(axis=0), (-9.5, -5.7, 0), atol=0.01)
    np.testing.assert_allclose(scene.mesh.vertices.max(axis=0), (9.5, 5.7, 3.0), atol=0.01)
    assert scene.floors == pytest.approx((0.0,), abs=0.01)
    count = Counter(instance.category for instance in scene.mesh.instances)
    expected = {"bed": 1, "sofa": 1, "chair": 8, "tv_monitor": 2, "table": 2, "fridge": 1}
    assert {name: count[name] for name in expected} == expected
    assert count["unknown"] == 0


def test_a_scene_survives_its_export(tmp_path):
    scene = load_mesh_scene(shared_data("scenes/aws_small_house/aws_small_house.glb"), LABELS)
    path = tmp_path / "exported.glb"
    path.write_bytes(scene_to_glb(scene))
    again = load_mesh_scene(path)
    assert categories(again) == categories(scene)
    assert again.floors == scene.floors
    low, high = extents(scene, "Bed_01_001.4.0")
    np.testing.assert_allclose(extents(again, "Bed_01_001.4.0"), (low, high), atol=1e-5)
    assert len(again.mesh.faces) == len(scene.mesh.faces)
