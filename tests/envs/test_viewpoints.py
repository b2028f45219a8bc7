"""Viewpoints against the worked distance to boxes, and against what walls and floors hide."""

from __future__ import annotations

import numpy as np
import pytest
from box_scenes import boxes, room

from toponav.envs.simulator.navigation import NavigableSurface
from toponav.envs.simulator.raycaster import RayCaster
from toponav.envs.simulator.viewpoints import GRID_M, viewpoints
from toponav.scenes.mesh import SceneMesh

CHAIR = ("chair", ((2.8, 1.8, 0.0), (3.3, 2.3, 0.9)))
SAMPLE_ERROR_M = 0.03
"""Distances are measured to samples of a surface, this far apart on a chair at most."""


def find(mesh: SceneMesh, category: str, floors: tuple[float, ...] = (0.0,)) -> np.ndarray:
    surface = NavigableSurface.build(mesh, floors=floors)
    ids = [instance.id for instance in mesh.instances if instance.category == category]
    found = viewpoints(surface, RayCaster(mesh), mesh, ids)
    assert all(surface.is_navigable(point) for point in found)
    return found


def box_distance(points: np.ndarray, part: tuple) -> np.ndarray:
    (x0, y0, _), (x1, y1, _) = part[1]
    outside = np.maximum(np.maximum([x0, y0] - points[:, :2], points[:, :2] - [x1, y1]), 0.0)
    return np.linalg.norm(outside, axis=1)


def test_everywhere_within_a_metre_of_a_free_standing_chair() -> None:
    mesh = room(extra=[CHAIR])
    found = find(mesh, "chair")
    surface = NavigableSurface.build(mesh, floors=(0.0,))
    x, y = np.meshgrid(GRID_M * np.arange(72), GRID_M * np.arange(48), indexing="ij")
    grid = np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)])
    free = grid[[surface.is_navigable(point) for point in grid]]
    distance = box_distance(free, CHAIR)
    got = {tuple(point) for point in np.round(found / GRID_M).astype(int)[:, :2]}
    must = np.round(free[distance < 1.0 - SAMPLE_ERROR_M] / GRID_M).astype(int)[:, :2]
    may = np.round(free[distance < 1.0] / GRID_M).astype(int)[:, :2]
    assert {tuple(point) for point in must} <= got <= {tuple(point) for point in may}
    assert len(got) == len(found) > 300


def test_a_wall_hides_what_stands_behind_it() -> None:
    wall = ("wall", ((2.5, 0.0, 0.0), (2.6, 3.4, 2.5)))
    found = find(room(extra=[CHAIR, wall]), "chair")
    assert len(found)
    assert (found[:, 0] > 2.6).all()


def test_over_a_low_wall_the_top_is_seen() -> None:
    wall = ("wall", ((2.5, 0.0, 0.0), (2.6, 3.0, 0.6)))
    found = find(room(extra=[CHAIR, wall]), "chair")
    assert (found[:, 0] < 2.5).any()


def test_a_sliver_that_sticks_out_is_seen_but_what_is_enclosed_is_not() -> None:
    screen = ("cabinet", ((2.4, 1.7, 0.0), (2.7, 2.25, 2.0)))
    behind = find(room(extra=[CHAIR, screen]), "chair")
    west = behind[(behind[:, 0] < 2.2) & (behind[:, 1] > 2.2)]
    assert len(west)
    chest = ("cabinet", ((2.6, 1.6, 0.0), (3.5, 2.5, 1.2)))
    assert find(room(extra=[CHAIR, chest]), "chair").shape == (0, 3)


def test_a_picture_high_on_a_wall_counts_on_its_own_side() -> None:
    wall = ("wall", ((2.9, 0.0, 0.0), (3.0, 3.0, 2.5)))
    picture = ("picture", ((3.0, 1.0, 1.5), (3.02, 1.8, 2.1)))
    found = find(room(extra=[wall, picture]), "picture")
    assert len(found)
    assert (found[:, 0] > 3.0).all()


def test_each_instance_counts_once_a_place() -> None:
    near = ("chair", ((3.5, 1.8, 0.0), (4.0, 2.3, 0.9)))
    both = find(room(extra=[CHAIR, near]), "chair")
    assert len(np.unique(np.round(both / GRID_M), axis=0)) == len(both)
    assert np.minimum(box_distance(both, CHAIR), box_distance(both, near)).max() < 1.0
    assert (box_distance(both, CHAIR) > 1.0).any()
    assert (box_distance(both, near) > 1.0).any()


@pytest.mark.parametrize("storey", [0, 1])
def test_an_object_has_viewpoints_on_its_own_storey_only(storey: int) -> None:
    # Stairs join two storeys; from the lower one sees past the edge of the upper floor.
    steps = [("stairs", ((0.3 * k, 0.0, 0.0), (3.9, 1.2, 0.2 * (k + 1)))) for k in range(13)]
    chair_z = 2.6 * storey
    mesh = boxes([
        ("floor", ((-1.5, 0.0, -0.1), (8.0, 4.0, 0.0))),
        ("floor", ((3.9, 0.0, 2.5), (8.0, 2.0, 2.6))),
        ("chair", ((5.0, 1.4, chair_z), (5.4, 1.8, chair_z + 0.9))),
        *steps,
    ])  # fmt: skip
    surface = NavigableSurface.build(mesh)
    assert np.isfinite(surface.geodesic_distance((-1.0, 0.6, 0.0), (4.5, 0.6, 2.6)))
    found = find(mesh, "chair", floors=(0.0, 2.6))
    assert len(found) > 50
    np.testing.assert_allclose(found[:, 2], chair_z, atol=0.01)
