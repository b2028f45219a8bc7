"""HM3D and MP3D scenes in the formats in which they are published, and this project's export."""

from __future__ import annotations

import json
import struct
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial import cKDTree

from published_scenes import write_hm3d, write_mp3d
from small_house import small_scene
from toponav.categories import canonical
from toponav.envs.simulator.navigation import NavigableSurface
from toponav.errors import MissingExtraError, SceneError
from toponav.scenes.basis_textures import uses_basis
from toponav.scenes.export import scene_to_glb
from toponav.scenes.glb_container import glb_bytes, glb_chunks
from toponav.scenes.gltf import load_mesh
from toponav.scenes.habitat.export import scene_dataset_config, write_habitat_scene
from toponav.scenes.habitat.hm3d_categories import hm3d_category
from toponav.scenes.habitat.mp3d import read_house_file
from toponav.scenes.habitat.semantic_colors import nearest_objects, palette, srgb_from_linear
from toponav.scenes.habitat.semantic_text import read_semantic_text
from toponav.scenes.habitat.semantic_transfer import spread_points, transfer_labels
from toponav.scenes.loading import SceneKind, list_scenes, load_scene, scene_kind
from toponav.scenes.mesh import Scene

GOLDEN = Path(__file__).resolve().parents[1] / "golden"


def categories_of_faces(scene: Scene) -> np.ndarray:
    names = np.array([instance.category for instance in scene.mesh.instances])
    return names[scene.mesh.face_instance]


def assert_same_scene(loaded: Scene, original: Scene) -> None:
    """The same triangles, each of the same category, and the same floor to stand on."""
    ours, theirs = (s.mesh.vertices[s.mesh.faces] for s in (loaded, original))
    assert len(ours) == len(theirs)
    distance, same = cKDTree(theirs.mean(axis=1)).query(ours.mean(axis=1))
    assert distance.max() < 2e-4
    assert (categories_of_faces(loaded) == categories_of_faces(original)[same]).mean() > 0.998
    areas = [NavigableSurface.build(s.mesh, floors=s.floors).area for s in (loaded, original)]
    assert areas[0] == pytest.approx(areas[1], rel=0.01)


@pytest.mark.parametrize("textured", [True, False], ids=["texture", "vertex colours"])
def test_an_hm3d_scene_loads_with_its_annotations(tmp_path: Path, textured: bool) -> None:
    stage = tmp_path / "00800-TEEsavR23oF" / "TEEsavR23oF.basis.glb"
    write_hm3d(stage, small_scene(), textured=textured)
    assert scene_kind(str(stage)) is SceneKind.HM3D
    scene = load_scene(str(stage))
    assert scene.name == "TEEsavR23oF"
    assert scene.stage == stage
    assert_same_scene(scene, small_scene())


def test_instances_have_the_ids_of_habitats_semantic_sensor(tmp_path: Path) -> None:
    stage = write_hm3d(tmp_path / "a.glb", small_scene())
    scene = load_scene(str(stage))
    for item in read_semantic_text(tmp_path / "a.semantic.txt"):
        assert scene.mesh.instances[item.id].category == hm3d_category(item.category)
    assert scene.mesh.instances[0].category == "unknown"


def test_an_mp3d_scene_loads_with_its_annotations(tmp_path: Path) -> None:
    stage = write_mp3d(tmp_path / "x8F5xyUWy9e" / "x8F5xyUWy9e.glb", small_scene())
    assert scene_kind(str(stage)) is SceneKind.MP3D
    assert_same_scene(load_scene(str(stage)), small_scene())


def test_an_export_is_read_as_the_house_that_was_written(tmp_path: Path) -> None:
    stage = write_habitat_scene(small_scene(), tmp_path / "small", "small")
    (tmp_path / "x.scene_dataset_config.json").write_text(scene_dataset_config([]))
    scene = load_scene(str(stage))
    assert_same_scene(scene, small_scene())
    exported = [instance.category for instance in scene.mesh.instances[1:]]
    assert exported == [instance.category for instance in small_scene().mesh.instances]


def test_an_exported_glb_names_its_parts_and_their_categories() -> None:
    content, _ = glb_chunks(scene_to_glb(small_scene()))
    named = {
        node["name"]: node["extras"]["category"]
        for node in content["nodes"]
        if "category" in node.get("extras", {})
    }
    assert named == {i.name: i.category for i in small_scene().mesh.instances}
    assert all(material["doubleSided"] for material in content["materials"])


def test_a_folder_of_published_scenes_lists_no_labelled_mesh(tmp_path: Path) -> None:
    write_hm3d(tmp_path / "a.glb", small_scene())
    write_mp3d(tmp_path / "b.glb", small_scene())
    assert [Path(spec).name for spec in list_scenes(str(tmp_path))] == ["a.glb", "b.glb"]


@pytest.mark.parametrize(
    ("write", "lost", "source"),
    [
        (write_hm3d, "s.semantic.glb", "hm3d_semantics"),
        (write_mp3d, "s_semantic.ply", "download_mp.py"),
    ],
)
def test_a_missing_annotation_is_named_with_its_place_and_source(
    tmp_path: Path, write, lost: str, source: str
) -> None:
    stage = write(tmp_path / "s.glb", small_scene())
    (tmp_path / lost).unlink()
    with pytest.raises(SceneError, match=f"{lost}: no such file.*{source}") as caught:
        load_scene(str(stage))
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("", "does not begin"),
        ("HM3D Semantic Annotations\n1,FF0000,chair,0\n", "line 2"),
        ('HM3D Semantic Annotations\n1,FF0000,"a",0\n1,00FF00,"b",0\n', "second object 1"),
        ('HM3D Semantic Annotations\n1,123456,"chair",0\n', "none of the colours"),
    ],
)
def test_damaged_annotations_are_told(tmp_path: Path, text: str, complaint: str) -> None:
    stage = write_hm3d(tmp_path / "s.glb", small_scene())
    (tmp_path / "s.semantic.txt").write_text(text)
    with pytest.raises(SceneError, match=complaint):
        load_scene(str(stage))


def test_annotators_names_become_the_benchmarks_categories(tmp_path: Path) -> None:
    assert [hm3d_category(n) for n in ("couch", "Dining Chair", "tv led", "toilet seat")] == [
        "sofa", "chair", "tv_monitor", "toilet",
    ]  # fmt: skip
    assert hm3d_category("grand piano") == canonical("grand piano")
    path = tmp_path / "x.house"
    path.write_text(
        "ASCII 1.1\nC 0 5 bean#bag 3 chair 0 0 0 0 0\nC 1 9 refrigerator 37 appliances 0 0 0 0 0\n"
        "O 0 0 0 1 2 3\nO 1 0 1 1 2 3\nO 2 0 -1 1 2 3\n"
    )
    assert read_house_file(path).categories == {0: "chair", 1: "fridge", 2: "unknown"}


def test_palette_colours_are_distinct_and_survive_the_way_to_srgb() -> None:
    linear, srgb = palette(5000)
    assert len(np.unique(srgb, axis=0)) == 5000
    np.testing.assert_array_equal(srgb_from_linear(linear), srgb)
    assert srgb.max(axis=1).min() > 0
    np.testing.assert_array_equal(nearest_objects(srgb, srgb), np.arange(5000))
    assert nearest_objects(np.array([[0, 0, 0]], np.uint8), srgb[:1])[0] == -1


def test_labels_reach_a_finer_mesh_of_the_same_rooms() -> None:
    """Split every triangle in four: most of what is far from an edge keeps its label."""
    mesh = small_scene().mesh
    corners = mesh.vertices[mesh.faces]
    points = spread_points(corners)
    labels = mesh.face_instance.astype(np.int64)[points.face]
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    ab, bc, ca = (a + b) / 2, (b + c) / 2, (c + a) / 2
    parts = [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
    fine = np.concatenate([np.stack(part, axis=1) for part in parts])
    area = np.linalg.norm(np.cross(fine[:, 1] - fine[:, 0], fine[:, 2] - fine[:, 0]), axis=1)
    found = transfer_labels(fine, corners, points, labels)
    right = found == np.tile(mesh.face_instance, 4)
    assert (right * area).sum() / area.sum() > 0.97


def test_scans_are_shown_in_their_own_light(tmp_path: Path) -> None:
    assert small_scene().mesh.lit
    assert not load_scene(str(write_hm3d(tmp_path / "a.glb", small_scene()))).mesh.lit


def basis_quad(codec: str) -> bytes:
    """A square whose texture is a Basis-compressed image of four colours."""
    ktx2 = (GOLDEN / f"quadrants_{codec}.ktx2").read_bytes()
    points = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], "<f4")
    uv = np.array([[0, 1], [1, 1], [1, 0], [0, 0]], "<f4")
    indices = np.array([0, 1, 2, 0, 2, 3], "<u4")
    blocks = [points.tobytes(), uv.tobytes(), indices.tobytes(), ktx2]
    starts = np.cumsum([0, *map(len, blocks)]).tolist()
    content = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "name": "quad"}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1},
                                    "indices": 2, "material": 0}]}],
        "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
        "textures": [{"extensions": {"KHR_texture_basisu": {"source": 0}}}],
        "images": [{"mimeType": "image/ktx2", "bufferView": 3}],
        "extensionsUsed": ["KHR_texture_basisu"], "extensionsRequired": ["KHR_texture_basisu"],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3",
             "min": [0, 0, 0], "max": [1, 1, 0]},
            {"bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC2"},
            {"bufferView": 2, "componentType": 5125, "count": 6, "type": "SCALAR"},
        ],
        "bufferViews": [{"buffer": 0, "byteOffset": s, "byteLength": len(b)}
                        for s, b in zip(starts, blocks, strict=False)],
        "buffers": [{"byteLength": starts[-1]}],
    }  # fmt: skip
    return glb_bytes(content, b"".join(blocks))


@pytest.mark.parametrize("codec", ["etc1s", "uastc"])
def test_basis_textures_are_decoded(tmp_path: Path, codec: str) -> None:
    pytest.importorskip("opengl_basisu", reason="no decoder: pip install 'toponav[habitat]'")
    path = tmp_path / "quad.basis.glb"
    path.write_bytes(basis_quad(codec))
    assert uses_basis(path)
    [material] = load_mesh(path, up="z").materials
    colors = material.texture[8::16, 8::16].reshape(-1, 3).astype(int)
    expected = [(200, 40, 40), (40, 200, 40), (40, 40, 200), (200, 200, 40)]
    assert np.abs(colors - expected).max() <= 12


def test_without_a_decoder_the_message_says_what_to_install(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(__import__("sys").modules, "opengl_basisu", None)
    path = tmp_path / "quad.basis.glb"
    path.write_bytes(basis_quad("etc1s"))
    with pytest.raises(MissingExtraError, match=r"toponav\[habitat\]"):
        load_mesh(path)


def test_a_damaged_container_is_told(tmp_path: Path) -> None:
    with pytest.raises(SceneError, match="binary glTF"):
        glb_chunks(b"glTF" + bytes(4))
    with pytest.raises(SceneError, match="binary glTF"):
        glb_chunks(struct.pack("<4sII", b"glTF", 2, 20) + struct.pack("<II", 2, 0x4E4F534A) + b"{}")
    assert json.dumps(glb_chunks(glb_bytes({"a": 1}, b"xyz"))[0]) == '{"a": 1}'


def test_a_label_table_takes_the_place_of_annotations(tmp_path: Path) -> None:
    stage = write_hm3d(tmp_path / "s.glb", small_scene())
    table = tmp_path / "labels.txt"
    table.write_text('{"*": "floor"}')
    plain = load_scene(str(stage), table)
    assert {instance.category for instance in plain.mesh.instances} == {"floor"}
    assert replace(plain, name="s").name == "s"
