"""Frontiers and the grid, kept up to date in pieces, against SciPy on the whole grid."""

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import ndimage

from toponav.mapping.frontiers import FrontierMap, mark_frontiers
from toponav.mapping.occupancy import FloorGrid
from toponav.mapping.view import FREE, OCCUPIED, UNKNOWN, OccupancyGrid

RESOLUTION = 0.1


def reference_frontiers(
    grid: OccupancyGrid, clearance: int, min_cells: int
) -> list[frozenset[tuple[int, int]]]:
    """Frontiers as sets of cells, in raster order of their first cells."""
    cells = np.pad(grid.cells, 1, constant_values=UNKNOWN)
    cross = ndimage.generate_binary_structure(2, 1)
    square = np.ones((3, 3), bool)
    frontier = (cells == FREE) & ndimage.binary_dilation(cells == UNKNOWN, cross)
    if clearance:
        frontier &= ~ndimage.binary_dilation(cells == OCCUPIED, square, iterations=clearance)
    labels, count = ndimage.label(frontier[1:-1, 1:-1], square)
    clusters = [np.argwhere(labels == k + 1).tolist() for k in range(count)]
    return [frozenset(map(tuple, cluster)) for cluster in clusters if len(cluster) >= min_cells]


def found_frontiers(grid: FloorGrid, frontiers: FrontierMap) -> list[frozenset[tuple[int, int]]]:
    centers, labels = frontiers.find()
    cells = grid.snapshot().index_of(centers)
    count = int(labels.max(initial=-1)) + 1
    return [frozenset(map(tuple, cells[labels == k].tolist())) for k in range(count)]


def change(grid: FloorGrid, columns: NDArray[np.int64], navigable: int, obstacles: int) -> None:
    """As many voxels over each of some columns."""
    each = (np.full(len(columns), count, np.int8) for count in (navigable, obstacles))
    grid.change(columns, *each)


def random_cells(rng: np.random.Generator, size: int, count: int) -> NDArray[np.int64]:
    """A blob of cells around a random place."""
    center = rng.integers(-size, size, 2)
    return center + np.rint(rng.normal(0.0, 6.0, (count, 2))).astype(np.int64)


@pytest.mark.parametrize("clearance", [0, 1, 2])
@pytest.mark.parametrize("seed", range(5))
def test_incremental_frontiers_are_those_of_the_whole_grid(seed: int, clearance: int) -> None:
    rng = np.random.default_rng(seed)
    grid = FloorGrid(RESOLUTION, 1, min_obstacle_voxels=1 + seed % 2)
    frontiers = FrontierMap(grid, clearance, min_cells=3)
    obstacles: list[NDArray[np.int64]] = []
    for step in range(12):
        change(grid, random_cells(rng, 40 * (1 + step // 4), 150), navigable=1, obstacles=0)
        obstacles.append(random_cells(rng, 40, 30))
        change(grid, obstacles[-1], navigable=0, obstacles=1)
        if step % 3 == 2:
            change(grid, obstacles.pop(0), navigable=0, obstacles=-1)
        if step % 2:
            expected = reference_frontiers(grid.snapshot(), clearance, 3)
            assert found_frontiers(grid, frontiers) == expected


@pytest.mark.parametrize("shape", [(1, 1), (1, 7), (9, 1), (8, 11)])
@pytest.mark.parametrize("clearance", [0, 1])
def test_beyond_the_edges_of_the_storage_all_is_unknown(
    shape: tuple[int, int], clearance: int
) -> None:
    rng = np.random.default_rng(shape[1])
    for share in (0.0, 0.1, 0.3):
        cells = np.full(shape, FREE, np.int8)
        cells[rng.random(shape) < share] = OCCUPIED
        mask = np.ones(shape, np.bool_)
        mark_frontiers(cells, mask, clearance, (-2, -2, shape[0] + 2, shape[1] + 2))
        grid = OccupancyGrid(cells, (0.0, 0.0), RESOLUTION)
        expected = reference_frontiers(grid, clearance, 1)
        assert {tuple(cell) for cell in np.argwhere(mask).tolist()} == set().union(*expected)


def test_a_free_square_in_the_unknown_is_bordered_by_one_frontier() -> None:
    grid = FloorGrid(RESOLUTION, 1, 1)
    i, j = np.mgrid[10:15, -3:2]
    change(grid, np.column_stack([i.ravel(), j.ravel()]), navigable=1, obstacles=0)
    centers, labels = FrontierMap(grid, 1, 1).find()
    assert len(centers) == 16
    assert set(labels.tolist()) == {0}
    np.testing.assert_allclose(centers.min(axis=0), [1.05, -0.25])
    np.testing.assert_allclose(centers.max(axis=0), [1.45, 0.15])


def test_small_frontiers_and_those_beside_obstacles_are_dropped() -> None:
    grid = FloorGrid(RESOLUTION, 1, 1)
    change(grid, np.array([[0, 0], [0, 1]]), navigable=1, obstacles=0)
    change(grid, np.array([[20, k] for k in range(6)]), navigable=1, obstacles=0)
    change(grid, np.array([[21, 0]]), navigable=0, obstacles=1)
    centers, _ = FrontierMap(grid, 1, 3).find()
    np.testing.assert_allclose(centers[:, 1], [0.25, 0.35, 0.45, 0.55])
    np.testing.assert_allclose(centers[:, 0], 2.05)


def test_cells_follow_the_counts_and_obstacles_win() -> None:
    grid = FloorGrid(RESOLUTION, 1, min_obstacle_voxels=2)
    cell = np.array([[3, -4]])

    def value() -> int:
        snapshot = grid.snapshot()
        return int(snapshot.cells[tuple(snapshot.index_of((0.35, -0.35)))])

    change(grid, cell, navigable=1, obstacles=0)
    assert value() == FREE
    change(grid, cell, navigable=0, obstacles=1)
    assert value() == FREE
    change(grid, cell, navigable=0, obstacles=1)
    assert value() == OCCUPIED
    change(grid, cell, navigable=0, obstacles=-1)
    assert value() == FREE
    change(grid, cell, navigable=-1, obstacles=0)
    assert value() == UNKNOWN


def test_the_snapshot_covers_what_was_observed_and_no_more() -> None:
    grid = FloorGrid(RESOLUTION, 1, 1)
    assert grid.snapshot().cells.shape == (0, 0)
    change(grid, np.array([[-200, 5], [300, 7]]), navigable=1, obstacles=0)
    change(grid, np.array([[10, -50]]), navigable=0, obstacles=1)
    snapshot = grid.snapshot()
    assert snapshot.cells.shape == (501, 58)
    assert snapshot.origin == pytest.approx((-20.0, -5.0))
    assert snapshot.cells[0, 55] == FREE
    assert snapshot.cells[500, 57] == FREE
    assert snapshot.cells[210, 0] == OCCUPIED
    assert np.count_nonzero(snapshot.cells) == 3


def test_a_snapshot_does_not_change_with_the_grid() -> None:
    grid = FloorGrid(RESOLUTION, 1, 1)
    change(grid, np.array([[0, 0]]), navigable=1, obstacles=0)
    snapshot = grid.snapshot()
    change(grid, np.array([[0, 0]]), navigable=0, obstacles=1)
    assert snapshot.cells[0, 0] == FREE


def test_a_cell_spans_several_columns_on_either_side_of_the_origin() -> None:
    grid = FloorGrid(RESOLUTION, 2, 1)
    change(grid, np.array([[-1, 0], [2, 3]]), navigable=1, obstacles=0)
    snapshot = grid.snapshot()
    assert snapshot.origin == pytest.approx((-0.1, 0.0))
    assert snapshot.cells.tolist() == [[FREE, UNKNOWN], [UNKNOWN, UNKNOWN], [UNKNOWN, FREE]]


def test_bridges_fill_only_columns_without_observed_floor_and_once() -> None:
    grid = FloorGrid(RESOLUTION, 2, 1)
    change(grid, np.array([[0, 0]]), navigable=1, obstacles=0)
    columns = np.array([[0, 0], [0, 1], [0, 1], [5, 5]])
    assert grid.bridge(columns).tolist() == [False, True, False, True]
    assert grid.bridge(columns).tolist() == [False, False, False, False]
    assert grid.observed(columns).tolist() == [True, False, False, False]
    covered = grid.covered(np.array([-1, -1]), np.array([3, 3]))
    assert covered.tolist() == [[False] * 3, [False, True, True], [False] * 3]
    snapshot = grid.snapshot()
    assert snapshot.cells[0, 0] == snapshot.cells[2, 2] == FREE
    change(grid, np.array([[5, 5]]), navigable=0, obstacles=1)
    assert grid.snapshot().cells[2, 2] == OCCUPIED
