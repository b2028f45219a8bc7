"""From what a user types to a scene, and lists of scenes."""

import json

import pytest
import trimesh

from shared_data import shared_data
from toponav.errors import SceneError
from toponav.scenes.export import export_house
from toponav.scenes.gltf import load_mesh_scene
from toponav.scenes.house import House, HouseObject, Level, Opening, Room
from toponav.scenes.house_io import load_house, save_house
from toponav.scenes.loading import SceneKind, list_scenes, load_house_spec, load_scene, scene_kind

HOUSE = House(
    name="small",
    levels=[
        Level(
            rooms=[
                Room(id="a", type="bedroom", polygon=[(0, 0), (4, 0), (4, 4), (0, 4)]),
                Room(id="b", type="office", polygon=[(4, 0), (8, 0), (8, 4), (4, 4)]),
            ],
            openings=[Opening(kind="door", rooms=["a", "b"], center=(4.0, 2.0))],
            objects=[
                HouseObject(id="b1", category="Bed", position=(1, 2, 0), size=(1.4, 2, 0.6)),
                HouseObject(id="c1", category="office chair", position=(6, 3, 0), size=(0.5,) * 3),
            ],
        )
    ],
)


def targets(scene):
    return {i.name: i.category for i in scene.mesh.instances if i.name in ("b1", "c1")}


@pytest.fixture
def folder(tmp_path):
    """A folder with one scene of each kind, and files that are none."""
    save_house(HOUSE, tmp_path / "b_house.json")
    box = trimesh.creation.box(bounds=[(0, 0, 0), (5, 4, 0.1)])
    (tmp_path / "a_mesh.GLB").write_bytes(trimesh.Scene(box).export(file_type="glb"))
    (tmp_path / "labels.json").write_text('{"Bed*": "bed"}')
    (tmp_path / "notes.txt").write_text("")
    (tmp_path / ".hidden.json").write_text("{}")
    (tmp_path / "c_home.yaml").write_text(
        "rooms: {room_1: {label: office, centroid: {x: 0, y: 1, z: 0}, dims: {x: 3, y: 2, z: 3}}}"
    )
    return tmp_path


def test_a_house_file_becomes_a_scene(folder):
    scene = load_scene(str(folder / "b_house.json"))
    assert scene.name == "small"
    assert scene.floors == (0.0,)
    assert targets(scene) == {"b1": "bed", "c1": "chair"}
    assert [kind for kind, _, _ in scene.room_types] == ["bedroom", "office"]


def test_kinds_are_told_apart(folder):
    kinds = {path.name: scene_kind(str(path)) for path in folder.glob("[abc]_*")}
    assert kinds == {
        "a_mesh.GLB": SceneKind.MESH,
        "b_house.json": SceneKind.HOUSE,
        "c_home.yaml": SceneKind.DOMESTIGRAPH,
    }
    assert scene_kind("generated:3") is SceneKind.GENERATED
    procthor = shared_data("scenes/procthor/house_0.json")
    assert scene_kind(str(procthor)) is SceneKind.PROCTHOR


def test_folders_are_listed_by_name(folder):
    assert list_scenes(str(folder)) == [
        str(folder / name) for name in ("a_mesh.GLB", "b_house.json", "c_home.yaml")
    ]


def test_parts_of_a_house_are_no_scenes(folder):
    content = json.loads((folder / "b_house.json").read_text())
    content["levels"][0]["objects"][0]["mesh"] = "a_mesh.GLB"
    (folder / "b_house.json").write_text(json.dumps(content))
    assert str(folder / "a_mesh.GLB") not in list_scenes(str(folder))


def test_broken_json_in_a_folder_is_not_passed_over(folder):
    (folder / "broken.json").write_text("{")
    assert str(folder / "broken.json") in list_scenes(str(folder))
    with pytest.raises(SceneError, match="not JSON"):
        load_scene(str(folder / "broken.json"))


def test_a_single_scene_is_a_list_of_one(folder):
    path = str(folder / "b_house.json")
    assert list_scenes(path) == [path]


def test_ranges_of_generated_houses():
    assert list_scenes("generated:3-5") == ["generated:3", "generated:4", "generated:5"]
    assert list_scenes("generated:7?rooms=5") == ["generated:7?rooms=5"]
    house = load_house_spec("generated:7?rooms=5")
    assert house == load_house_spec("generated:7?rooms=5")
    assert load_scene("generated:7?rooms=5").name == house.name
    with pytest.raises(SceneError, match="stands for 3 houses"):
        load_scene("generated:3-5")


@pytest.mark.parametrize("spec", ["generated:", "generated:x", "generated:5-3", "generated:1?a=b"])
def test_bad_generator_specs(spec):
    with pytest.raises(SceneError) as caught:
        list_scenes(spec)
    assert "\n" not in str(caught.value)


def test_what_is_no_scene(folder):
    for spec, message in {
        str(folder / "absent.json"): "no such file",
        str(folder / "notes.txt"): "not a scene",
        str(folder): "a folder",
        str(folder / "labels.json"): "missing",
    }.items():
        with pytest.raises(SceneError, match=message) as caught:
            load_scene(spec)
        assert spec in str(caught.value)
        assert "\n" not in str(caught.value)
    (folder / "empty").mkdir()
    with pytest.raises(SceneError, match="no scene in this folder"):
        list_scenes(str(folder / "empty"))
    with pytest.raises(SceneError, match="no plan of its rooms"):
        load_house_spec(str(folder / "a_mesh.GLB"))
    with pytest.raises(SceneError, match="a label table names the parts of a mesh"):
        load_scene(str(folder / "b_house.json"), folder / "labels.json")


def test_houses_are_exported_and_read_back(tmp_path):
    export_house(HOUSE, tmp_path / "small.json")
    assert load_house(tmp_path / "small.json") == HOUSE
    export_house(HOUSE, tmp_path / "small.glb")
    built = load_scene(str(tmp_path / "small.json"))
    again = load_mesh_scene(tmp_path / "small.glb")
    names = {i.name: i.category for i in built.mesh.instances}
    used = {built.mesh.instances[i].name for i in set(built.mesh.face_instance.tolist())}
    assert {i.name: i.category for i in again.mesh.instances} == {n: names[n] for n in used}
    assert again.floors == built.floors
    assert len(again.mesh.faces) == len(built.mesh.faces)


def test_exports_that_make_no_sense(tmp_path):
    with pytest.raises(SceneError, match=r"\.json or \.glb"):
        export_house(HOUSE, tmp_path / "small.obj")
    box = trimesh.creation.box(bounds=[(0, 0, 0), (5, 4, 0.1)])
    (tmp_path / "box.glb").write_bytes(trimesh.Scene(box).export(file_type="glb"))
    with pytest.raises(SceneError, match="no plan of its rooms"):
        export_house(load_mesh_scene(tmp_path / "box.glb"), tmp_path / "box.json")
