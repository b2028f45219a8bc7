"""Convex polygons over the navigable cells, and the file that holds them for Habitat."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
import pytest

from small_house import small_scene
from toponav.envs.habitat.navmesh_file import navmesh_bytes
from toponav.envs.simulator.agent_body import AgentBody
from toponav.envs.simulator.convex_mesh import ConvexMesh, convex_mesh
from toponav.envs.simulator.navigation import NavigableSurface
from toponav.envs.simulator.span_graph import subset
from toponav.errors import SceneError
from toponav.evaluation.objectnav_export import DatasetPlan, export_dataset
from toponav.scenes.loading import load_scene


@pytest.fixture(scope="module", params=["one floor", "stairs"])
def surface(request: pytest.FixtureRequest) -> NavigableSurface:
    scene = small_scene() if request.param == "one floor" else load_scene("generated:7?levels=2")
    return NavigableSurface.build(scene.mesh, floors=scene.floors)


@pytest.fixture(scope="module")
def mesh(surface: NavigableSurface) -> ConvexMesh:
    return convex_mesh(surface.graph)


def corners(mesh: ConvexMesh, polygon: tuple[int, ...]) -> np.ndarray:
    return mesh.vertices[list(polygon)]


def cross(points: np.ndarray) -> np.ndarray:
    ahead = np.roll(points, -1, axis=0) - points
    after = np.roll(ahead, -1, axis=0)
    return ahead[:, 0] * after[:, 1] - ahead[:, 1] * after[:, 0]


def test_polygons_cover_the_cells_and_no_more(surface: NavigableSurface, mesh: ConvexMesh) -> None:
    areas = []
    for polygon in mesh.polygons:
        x, y = corners(mesh, polygon)[:, :2].T
        areas.append(0.5 * (x @ np.roll(y, -1) - y @ np.roll(x, -1)))
    assert min(areas) > 0.0
    cells = len(surface.graph.z) * surface.graph.cell_size**2
    assert sum(areas) == pytest.approx(cells, rel=1e-9)


def test_polygons_are_convex_and_small(mesh: ConvexMesh) -> None:
    for polygon in mesh.polygons:
        assert 3 <= len(polygon) <= 6
        assert cross(corners(mesh, polygon)[:, :2]).min() >= -1e-9


def test_neighbours_share_whole_edges(mesh: ConvexMesh) -> None:
    for number, (polygon, across) in enumerate(zip(mesh.polygons, mesh.neighbours, strict=True)):
        for k, other in enumerate(across):
            if other < 0:
                continue
            a, b = polygon[k], polygon[(k + 1) % len(polygon)]
            back = mesh.neighbours[other].index(number)
            there = mesh.polygons[other]
            c, d = there[back], there[(back + 1) % len(there)]
            np.testing.assert_allclose(mesh.vertices[[a, b], :2], mesh.vertices[[d, c], :2])


def test_polygons_hang_together_as_the_cells_do(
    surface: NavigableSurface, mesh: ConvexMesh
) -> None:
    label = np.arange(len(mesh.polygons))
    for _ in range(len(label)):
        lowest = [
            min(label[k] for k in (n, *(o for o in across if o >= 0)))
            for n, across in enumerate(mesh.neighbours)
        ]
        if np.array_equal(lowest, label):
            break
        label = np.array(lowest)
    assert len(np.unique(label)) == surface.graph.island.max() + 1


def test_the_file_says_what_detour_reads(mesh: ConvexMesh) -> None:
    body = AgentBody()
    data = navmesh_bytes(mesh, body)
    magic, version, tiles = struct.unpack_from("<3i", data)
    assert (magic.to_bytes(4, "big"), version, tiles) == (b"MSET", 2, 1)
    settings = struct.unpack_from("<13f", data, 40)
    np.testing.assert_allclose(settings[:6], (0.05, 0.2, 0.88, 0.18, 0.2, 45.0), rtol=1e-6)
    _, size = struct.unpack_from("<Ii", data, 96)
    assert size == len(data) - 104
    header = struct.unpack_from("<15i", data, 104)
    assert header[0].to_bytes(4, "big") == b"DNAV"
    polygons, vertices, links, details, triangles = (header[k] for k in (6, 7, 8, 9, 11))
    assert (polygons, vertices) == (len(mesh.polygons), len(mesh.vertices))
    assert size == 100 + 12 * vertices + 32 * polygons + 12 * links + 12 * details + 4 * triangles
    points = np.frombuffer(data, "<f4", 3 * vertices, 204).reshape(-1, 3)
    np.testing.assert_allclose(points[:, 1], mesh.vertices[:, 2], atol=1e-5)
    np.testing.assert_allclose(points[:, 2], -mesh.vertices[:, 1], atol=1e-5)


def test_a_surface_too_large_for_detour_is_refused() -> None:
    empty = ConvexMesh(np.zeros((0, 3)), (), ())
    with pytest.raises(SceneError, match="1 to 65535"):
        navmesh_bytes(empty, AgentBody())


def test_an_exported_navmesh_is_that_of_the_exported_file(tmp_path: Path) -> None:
    """In this house single precision takes ten cells from the surface."""
    house = load_scene("generated:0")
    files = export_dataset([house], DatasetPlan(tmp_path / "data", episodes=1))
    stage = load_scene(str(next(path for path in files if path.suffix == ".glb")))
    surface = NavigableSurface.build(stage.mesh, floors=stage.floors)
    assert surface.area != NavigableSurface.build(house.mesh, floors=house.floors).area
    floor = subset(surface.graph, surface.graph.island == surface.main_island)
    written = stage.stage.with_suffix(".navmesh").read_bytes()
    assert written == navmesh_bytes(convex_mesh(floor), AgentBody())
