"""Furniture catalogues of Sweet Home 3D: read, brought upright, put into houses."""

import io
import zipfile
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from toponav.cli.main import main
from toponav.errors import SceneError
from toponav.scenes.building.object_mesh import load_object_mesh
from toponav.scenes.catalog_furnishing import FurnitureLibrary, distortion
from toponav.scenes.generate import generate_house
from toponav.scenes.house_io import load_house
from toponav.scenes.meshing import build_scene
from toponav.scenes.sweet_home import piece_glb, read_catalogs

RED, BLUE = (200, 20, 20), (20, 20, 200)

PROPERTIES = """\
# a comment with caf\xe9
id=Test
name=Test catalogue
id#1=Test#chair
name#1=Chair
model#1=/pieces/chair/chair.obj
width#1=46.0
depth#1=50.0
height#1=92.0
# The model lies on its back: its height is along -z, its front towards +y.
modelRotation#1=1 0 0 0 0 -1 0 1 0
id#2=Test#lego
name#2=Wooden duck
model#2=/pieces/chair/chair.obj
width#2=46.0
depth#2=50.0
height#2=92.0
id#3=Test#sofa
name#3=Sofa
model#3=/pieces/sofa/missing.obj
width#3=200
depth#3=90
height#3=84
id#4=Test#bed
name#4=Bed
width#4=160
depth#4=200
height#4=100
"""


def chair_obj() -> str:
    """A tetrahedron that is red towards +y, where it reaches far, and blue above -z."""
    return "\n".join(
        [
            "mtllib chair.mtl",
            "v 0 0 0", "v 0.46 0 0", "v 0.23 0.5 0", "v 0.23 0 -0.92",
            "vt 0.5 0.5",
            "usemtl red", "f 1/1 2/1 3/1", "f 2/1 4/1 3/1",
            "usemtl blue", "f 1/1 4/1 2/1", "f 1/1 3/1 4/1",
        ]
    )  # fmt: skip


@pytest.fixture
def catalog(tmp_path: Path) -> Path:
    """A catalogue of one good chair and three entries with something wrong."""
    path = tmp_path / "tiny.sh3f"
    picture = io.BytesIO()
    Image.new("RGB", (2048, 4), RED).save(picture, "png")
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("PluginFurnitureCatalog.properties", PROPERTIES.encode("latin-1"))
        archive.writestr("PluginFurnitureCatalog_fr.properties", "name#1=Chaise")
        archive.writestr("pieces/chair/chair.obj", chair_obj())
        archive.writestr(
            "pieces/chair/chair.mtl",
            "newmtl red\nKd 1 1 1\nmap_Kd red.png\nnewmtl blue\nKd {} {} {}\n".format(
                *(c / 255 for c in BLUE)
            ),
        )
        archive.writestr("pieces/chair/red.png", picture.getvalue())
    return path


def test_entries_of_known_categories_with_a_model_are_read(catalog: Path) -> None:
    chair, sofa = read_catalogs(catalog)
    assert (chair.category, sofa.category) == ("chair", "sofa")
    assert chair.size == pytest.approx((0.46, 0.50, 0.92))
    assert [piece.name for piece in read_catalogs(catalog.parent)] == ["Chair", "Sofa"]


def test_a_model_is_turned_upright_and_keeps_its_texture(catalog: Path, tmp_path: Path) -> None:
    data = piece_glb(read_catalogs(catalog)[0])
    assert data is not None
    (tmp_path / "chair.glb").write_bytes(data)
    mesh = load_object_mesh(tmp_path / "chair.glb", "chair")
    corners = mesh.vertices[mesh.faces].reshape(-1, 3)
    extents = np.ptp(corners, axis=0)
    assert extents == pytest.approx([0.46, 0.50, 0.92], abs=1e-6)
    tip = corners[corners[:, 2].argmax()]
    toe = corners[corners[:, 1].argmin()]
    assert tip[1] == pytest.approx(corners[:, 1].max())  # the tip is over the back
    assert toe[2] == pytest.approx(corners[:, 2].min())  # the front is on the floor
    colors = sorted(tuple(int(c) for c in m.texture[0, 0]) for m in mesh.materials)
    assert np.allclose(colors, sorted([RED, BLUE]), atol=2)
    assert max(max(m.texture.shape[:2]) for m in mesh.materials) <= 512


def test_houses_get_models_only_where_they_suit(catalog: Path, tmp_path: Path) -> None:
    pieces = [piece for piece in read_catalogs(catalog) if piece.category == "chair"]
    house = next(h for h in map(generate_house, range(9)) if chairs(h))
    furnished = FurnitureLibrary(pieces, tmp_path).furnish(house)
    for before, after in zip(objects(house), objects(furnished), strict=True):
        assert (before.position, before.size, before.yaw) == (after.position, after.size, after.yaw)
        suits = before.category == "chair" and distortion(pieces[0].size, before.size) <= 1.6
        assert (after.mesh is not None) == suits
    assert any(item.mesh for item in objects(furnished))
    mesh = build_scene(furnished, tmp_path).mesh
    drawn = build_scene(house).mesh
    for item in (item for item in objects(furnished) if item.mesh):
        assert bounds(mesh, item.id) == pytest.approx(bounds(drawn, item.id), abs=1e-4)


def test_generate_takes_a_catalogue(catalog: Path, tmp_path: Path) -> None:
    rewrite_without(catalog, b"id#3=Test#sofa", b"name#3=Sofa")
    out = tmp_path / "houses"
    seeds = "generated:0-3"
    assert main(["scenes", "generate", seeds, "--furniture", str(catalog), "--out", str(out)]) == 0
    houses = [load_house(path) for path in sorted(out.glob("*.json"))]
    named = {item.mesh for house in houses for item in objects(house) if item.mesh}
    assert named
    assert {path.relative_to(out).as_posix() for path in out.glob("models/*")} == named


def test_what_is_wrong_with_a_catalogue_is_said(catalog: Path, tmp_path: Path) -> None:
    with pytest.raises(SceneError, match="no such file"):
        read_catalogs(tmp_path / "none.sh3f")
    (tmp_path / "text.sh3f").write_text("no zip")
    with pytest.raises(SceneError, match="not a furniture catalogue"):
        read_catalogs(tmp_path / "text.sh3f")
    (tmp_path / "empty").mkdir()
    with pytest.raises(SceneError, match=r"no \.sh3f catalogue"):
        read_catalogs(tmp_path / "empty")
    sofa = read_catalogs(catalog)[1]
    with pytest.raises(SceneError, match=r"missing\.obj: damaged or incomplete"):
        piece_glb(sofa)


def objects(house):
    return [item for level in house.levels for item in level.objects]


def chairs(house):
    return [item for item in objects(house) if item.category == "chair"]


def bounds(mesh, name):
    """Least and greatest corner of an instance."""
    [k] = [i for i, _ in enumerate(mesh.instances) if mesh.instances[i].name == name]
    corners = mesh.vertices[mesh.faces[mesh.face_instance == k]].reshape(-1, 3)
    return np.concatenate([corners.min(axis=0), corners.max(axis=0)])


def rewrite_without(catalog: Path, *lines: bytes) -> None:
    """Take lines out of the properties."""
    with zipfile.ZipFile(catalog) as archive:
        files = {name: archive.read(name) for name in archive.namelist()}
    with zipfile.ZipFile(catalog, "w") as archive:
        for name, data in files.items():
            kept = [line for line in data.split(b"\n") if line not in lines]
            archive.writestr(name, b"\n".join(kept) if name.endswith("properties") else data)
