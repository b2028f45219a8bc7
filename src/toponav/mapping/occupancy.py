"""The grid G of one floor, kept up to date cell by cell (Section III-C)."""

from __future__ import annotations

from typing import TypeVar

import numpy as np
from numba import njit
from numpy.typing import NDArray

from toponav.errors import ObservationError
from toponav.mapping.view import DROP, FREE, OCCUPIED, UNKNOWN, OccupancyGrid

Scalar = TypeVar("Scalar", bound=np.generic)

GROWTH_CELLS = 64
"""Margin by which the storage outgrows its contents, so that it is seldom copied."""

MAX_CELLS = 1 << 24
"""Largest storage: 400 m x 400 m of 0.1 m cells, 250 MB; beyond it lies a broken pose."""

DROP_FRAMES = 2
"""Frames that must see through a column before it is a drop: one may err at an edge."""

SOLID = 255
"""Instead of such a count, where the agent stood: that is no drop, whatever is seen."""

Box = tuple[int, int, int, int]
"""(i_first, j_first, i_end, j_end) in storage cells, ends exclusive."""

EMPTY_BOX: Box = (0, 0, 0, 0)


class FloorGrid:
    """Counts the voxels of M_nav and M_obs on one floor, and says which box of G has changed.

    The plane is cut into columns, as wide as a voxel, and cells of several columns a side. Both
    are addressed by world index: column (i, j) covers x in [i, i + 1) r_pcd, cell (i, j) covers x
    in [i, i + 1) r_g. The storage covers a growing window of cells.
    """

    def __init__(self, resolution: float, columns_per_cell: int, min_obstacle_voxels: int) -> None:
        """Create an empty grid.

        Args:
            resolution: r_g, metres.
            columns_per_cell: r_g / r_pcd.
            min_obstacle_voxels: Voxels of M_obs that make a cell an obstacle; the paper's is 1.
        """
        self.resolution = resolution
        self._columns_per_cell = columns_per_cell
        self._min_obstacle_voxels = min_obstacle_voxels
        self._first = (0, 0)
        self._navigable = np.zeros((0, 0), np.int16)
        self._bridged = np.zeros((0, 0), np.bool_)
        self._seen_through = np.zeros((0, 0), np.uint8)
        self._obstacles = np.zeros((0, 0), np.int16)
        self._cells = np.full((0, 0), UNKNOWN, np.int8)
        self._known = EMPTY_BOX
        self._changed = EMPTY_BOX

    @property
    def cells(self) -> NDArray[np.int8]:
        """The whole storage of G, live; UNKNOWN beyond what was observed."""
        return self._cells

    @property
    def first(self) -> tuple[int, int]:
        """World index of the storage's cell (0, 0)."""
        return self._first

    @property
    def known(self) -> Box:
        """Tightest box, in storage cells, that ever held a voxel."""
        return self._known

    @property
    def nbytes(self) -> int:
        """Memory held, bytes."""
        columns = (self._navigable, self._bridged, self._seen_through)
        arrays = (*columns, self._obstacles, self._cells)
        return sum(array.nbytes for array in arrays)

    def change(self, columns: NDArray[np.int64], navigable: int, obstacles: int) -> None:
        """Add voxels over columns, or take them away.

        Args:
            columns: (N, 2) world indices; a column may occur several times.
            navigable: +1, 0 or -1 navigable voxels over each.
            obstacles: +1, 0 or -1 obstacle voxels over each.
        """
        if len(columns):
            box, local = self._enclose(columns)
            counts = (self._navigable, self._obstacles)
            _change_counts(*counts, local, (navigable, obstacles), self._columns_per_cell)
            self._classify(box)

    def bridge(self, columns: NDArray[np.int64]) -> NDArray[np.bool_]:
        """Make columns navigable where there is no navigable voxel.

        Args:
            columns: (N, 2) world indices; a column may occur several times.

        Returns:
            (N,) which of them were bridged now; of equal ones the first.
        """
        if not len(columns):
            return np.zeros(0, np.bool_)
        box, local = self._enclose(columns)
        new: NDArray[np.bool_] = _bridge_gaps(self._navigable, self._bridged, local)
        self._classify(box)
        return new

    def see_through(self, columns: NDArray[np.int64]) -> None:
        """Note that one frame saw what lies under columns, so that no floor is there.

        Args:
            columns: (N, 2) world indices, each once.
        """
        if len(columns):
            box, local = self._enclose(columns)
            i, j = local.T
            count = self._seen_through[i, j]
            self._seen_through[i, j] = np.where(count < DROP_FRAMES, count + 1, count)
            self._classify(box)

    def seen_through(self) -> tuple[NDArray[np.int64], NDArray[np.uint8]]:
        """(N, 2) world indices of the columns that were seen through or held, and their counts."""
        local = np.argwhere(self._seen_through)
        return local + self._first_column, self._seen_through[local[:, 0], local[:, 1]]

    def restore_seen_through(self, columns: NDArray[np.int64], counts: NDArray[np.uint8]) -> None:
        """Take over what `seen_through` of another grid told."""
        if len(columns):
            box, local = self._enclose(columns)
            self._seen_through[local[:, 0], local[:, 1]] = counts
            self._classify(box)

    def hold(self, columns: NDArray[np.int64]) -> None:
        """Note that the agent stands on (N, 2) columns."""
        box, local = self._enclose(columns)
        self._seen_through[local[:, 0], local[:, 1]] = SOLID
        self._classify(box)

    def observed(self, columns: NDArray[np.int64]) -> NDArray[np.bool_]:
        """(N,) which (N, 2) columns hold an observed navigable voxel; they lie in the storage."""
        i, j = (columns - self._first_column).T
        observed: NDArray[np.bool_] = self._navigable[i, j] > 0
        return observed

    def floor_cells(self) -> NDArray[np.bool_]:
        """Over the observed extent: the cells with an observed navigable voxel."""
        i, j, i_end, j_end = self._known
        n = self._columns_per_cell
        columns = self._navigable[i * n : i_end * n, j * n : j_end * n] > 0
        return np.asarray(columns.reshape(i_end - i, n, j_end - j, n).any(axis=(1, 3)))

    def covered(self, first: NDArray[np.int64], shape: NDArray[np.int64]) -> NDArray[np.bool_]:
        """A copy of a window of columns: whether each is navigable, observed or bridged.

        Args:
            first: (2,) world index of the window's column (0, 0).
            shape: (2,) columns along x and y.
        """
        step = self._columns_per_cell
        self._cover(first // step, (first + shape - 1) // step)
        i, j = first - self._first_column
        window = (slice(i, i + shape[0]), slice(j, j + shape[1]))
        covered: NDArray[np.bool_] = (self._navigable[window] > 0) | self._bridged[window]
        return covered

    def take_changes(self) -> Box:
        """The box of cells changed since the last call, in storage cells."""
        changed, self._changed = self._changed, EMPTY_BOX
        return changed

    def snapshot(self) -> OccupancyGrid:
        """G over the observed extent: N_x by N_y cells from (x_min, y_min)."""
        i, j, i_end, j_end = self._known
        cells = self._cells[i:i_end, j:j_end].copy()
        cells.setflags(write=False)
        origin = ((self._first[0] + i) * self.resolution, (self._first[1] + j) * self.resolution)
        return OccupancyGrid(cells, origin, self.resolution)

    @property
    def _first_column(self) -> NDArray[np.int64]:
        return np.asarray(self._first, np.int64) * self._columns_per_cell

    def _enclose(self, columns: NDArray[np.int64]) -> tuple[Box, NDArray[np.int64]]:
        """Make room for columns; returns their box of storage cells and their storage indices."""
        box = _bounds(columns)
        low, high = box[0] // self._columns_per_cell, box[1] // self._columns_per_cell
        self._cover(low, high)
        i, j = (int(index) for index in low - self._first)
        i_last, j_last = (int(index) for index in high - self._first)
        return (i, j, i_last + 1, j_last + 1), columns - self._first_column

    def _classify(self, box: Box) -> None:
        counts = (self._navigable, self._bridged, self._seen_through, self._obstacles)
        _classify_box(self._cells, counts, box, self._columns_per_cell, self._min_obstacle_voxels)
        self._known = union(self._known, box)
        self._changed = union(self._changed, box)

    def _cover(self, low: NDArray[np.int64], high: NDArray[np.int64]) -> None:
        """Grow the storage until it holds world cells `low` to `high`, inclusive."""
        first = np.asarray(self._first, np.int64)
        end = first + self._cells.shape
        if self._cells.size and (low >= first).all() and (high < end).all():
            return
        if not self._cells.size:
            first, end = low, low
        new_first = np.where(low < first, low - GROWTH_CELLS, first)
        new_end = np.where(high >= end, high + 1 + GROWTH_CELLS, end)
        shape = tuple(int(n) for n in new_end - new_first)
        shift = (int(first[0] - new_first[0]), int(first[1] - new_first[1]))
        if shape[0] * shape[1] > MAX_CELLS:
            raise ObservationError(
                f"the map of one floor would span {shape[0] * self.resolution:.0f} x "
                f"{shape[1] * self.resolution:.0f} m: check the poses for a jump"
            )
        step = self._columns_per_cell
        column_shape = (shape[0] * step, shape[1] * step)
        column_shift = (shift[0] * step, shift[1] * step)
        self._navigable = embedded(self._navigable, column_shape, column_shift)
        self._bridged = embedded(self._bridged, column_shape, column_shift)
        self._seen_through = embedded(self._seen_through, column_shape, column_shift)
        self._obstacles = embedded(self._obstacles, shape, shift)
        self._cells = embedded(self._cells, shape, shift)
        self._first = (int(new_first[0]), int(new_first[1]))
        self._known = _shifted(self._known, shift)
        self._changed = _shifted(self._changed, shift)


def union(a: Box, b: Box) -> Box:
    """The smallest box that holds two; an empty one holds nothing."""
    if EMPTY_BOX in (a, b):
        return b if a == EMPTY_BOX else a
    return (min(a[0], b[0]), min(a[1], b[1]), max(a[2], b[2]), max(a[3], b[3]))


def embedded(
    array: NDArray[Scalar], shape: tuple[int, ...], shift: tuple[int, int]
) -> NDArray[Scalar]:
    """A zeroed array of `shape` that holds `array` from cell `shift` on."""
    larger = np.zeros(shape, array.dtype)
    larger[shift[0] : shift[0] + array.shape[0], shift[1] : shift[1] + array.shape[1]] = array
    return larger


def _shifted(box: Box, shift: tuple[int, int]) -> Box:
    if box == EMPTY_BOX:
        return box
    return (box[0] + shift[0], box[1] + shift[1], box[2] + shift[0], box[3] + shift[1])


@njit(cache=True)
def _bounds(columns: NDArray[np.int64]) -> NDArray[np.int64]:
    """(2, 2) least and greatest of (N, 2) indices, N >= 1."""
    bounds = np.empty((2, 2), np.int64)
    bounds[:] = columns[0]
    for row in range(1, columns.shape[0]):
        for axis in range(2):
            bounds[0, axis] = min(bounds[0, axis], columns[row, axis])
            bounds[1, axis] = max(bounds[1, axis], columns[row, axis])
    return bounds


@njit(cache=True)
def _change_counts(
    navigable: NDArray[np.int16],
    obstacles: NDArray[np.int16],
    columns: NDArray[np.int64],
    change: tuple[int, int],
    columns_per_cell: int,
) -> None:
    for row in range(columns.shape[0]):
        i, j = columns[row, 0], columns[row, 1]
        navigable[i, j] += change[0]
        obstacles[i // columns_per_cell, j // columns_per_cell] += change[1]


@njit(cache=True)
def _bridge_gaps(
    navigable: NDArray[np.int16], bridged: NDArray[np.bool_], columns: NDArray[np.int64]
) -> NDArray[np.bool_]:
    new = np.zeros(columns.shape[0], np.bool_)
    for row in range(columns.shape[0]):
        i, j = columns[row, 0], columns[row, 1]
        new[row] = navigable[i, j] == 0 and not bridged[i, j]
        bridged[i, j] |= new[row]
    return new


@njit(cache=True)
def _classify_box(
    cells: NDArray[np.int8],
    counts: tuple[NDArray[np.int16], NDArray[np.bool_], NDArray[np.uint8], NDArray[np.int16]],
    box: Box,
    columns_per_cell: int,
    min_obstacle_voxels: int,
) -> None:
    """G(i, j) of Section III-C; where both M_nav and M_obs project, the obstacle wins.

    Floor that was observed wins over what was seen through, and that over interpolated points.
    """
    navigable, bridged, seen_through, obstacles = counts
    for i in range(box[0], box[2]):
        for j in range(box[1], box[3]):
            if obstacles[i, j] >= min_obstacle_voxels:
                cells[i, j] = OCCUPIED
                continue
            observed, free, drop = False, False, False
            for a in range(i * columns_per_cell, (i + 1) * columns_per_cell):
                for b in range(j * columns_per_cell, (j + 1) * columns_per_cell):
                    seen = seen_through[a, b]
                    observed |= navigable[a, b] > 0
                    free |= bridged[a, b] and seen != DROP_FRAMES
                    drop |= seen == DROP_FRAMES
            if observed:
                cells[i, j] = FREE
            elif drop:
                cells[i, j] = DROP
            else:
                cells[i, j] = FREE if free else UNKNOWN
