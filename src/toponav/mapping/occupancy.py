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

    def change(
        self,
        columns: NDArray[np.int64],
        navigable: NDArray[np.int8],
        obstacles: NDArray[np.int8],
    ) -> None:
        """Add voxels over columns, or take them away.

        Args:
            columns: (N, 2) world indices; a column may occur several times.
            navigable: (N,) +1, 0 or -1 navigable voxels over each.
            obstacles: (N,) +1, 0 or -1 obstacle voxels over each.
        """
        if len(columns):
            box, local = self._enclose(columns)
            counts = (self._navigable, self._obstacles)
            _change_counts(*counts, local, (navigable, obstacles), self._columns_per_cell)
            self._classify(box, local)

    def bridge(self, columns: NDArray[np.int64]) -> NDArray[np.bool_]:
        """Make columns navigable where there is no navigable voxel.

        Args:
            columns: (N, 2) world indices; a column may occur several times.

        Returns:
            (N,) which of them were bridged now; of equal ones the first.
        """
        if not len(columns):
            return np.zeros(0, np.bool_)
        _, local = self._enclose(columns)
        new: NDArray[np.bool_] = _bridge_gaps(self._navigable, self._bridged, local)
        if new.any():
            box, local = self._enclose(columns[new])
            self._classify(box, local)
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
            self._classify(box, local)

    def seen_through(self) -> tuple[NDArray[np.int64], NDArray[np.uint8]]:
        """(N, 2) world indices of the columns that were seen through or held, and their counts."""
        local = np.argwhere(self._seen_through)
        return local + self._first_column, self._seen_through[local[:, 0], local[:, 1]]

    def restore_seen_through(self, columns: NDArray[np.int64], counts: NDArray[np.uint8]) -> None:
        """Take over what `seen_through` of another grid told."""
        if len(columns):
            box, local = self._enclose(columns)
            self._seen_through[local[:, 0], local[:, 1]] = counts
            self._classify(box, local)

    def hold(self, columns: NDArray[np.int64]) -> None:
        """Note that the agent stands on (N, 2) columns."""
        box, local = self._enclose(columns)
        self._seen_through[local[:, 0], local[:, 1]] = SOLID
        self._classify(box, local)

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
        low, high = (first // step).tolist(), ((first + shape - 1) // step).tolist()
        self._cover((low[0], low[1]), (high[0], high[1]))
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
        n = self._columns_per_cell
        low_i, low_j, high_i, high_j = (index // n for index in _bounds(columns))
        self._cover((low_i, low_j), (high_i, high_j))
        i, j = self._first
        box = (low_i - i, low_j - j, high_i + 1 - i, high_j + 1 - j)
        return box, _moved(columns, -i * n, -j * n)

    def _classify(self, box: Box, columns: NDArray[np.int64]) -> None:
        """Classify the cells of changed columns anew, all of which lie in a box of cells."""
        counts = (self._navigable, self._bridged, self._seen_through, self._obstacles)
        rules = (self._columns_per_cell, self._min_obstacle_voxels)
        _classify_cells(self._cells, counts, columns, rules)
        self._known = union(self._known, box)
        self._changed = union(self._changed, box)

    def _cover(self, low: tuple[int, int], high: tuple[int, int]) -> None:
        """Grow the storage until it holds world cells `low` to `high`, inclusive."""
        (i, j), (rows, columns) = self._first, self._cells.shape
        if i <= low[0] and j <= low[1] and high[0] < i + rows and high[1] < j + columns:
            return
        first = np.asarray(self._first if self._cells.size else low, np.int64)
        end = first + self._cells.shape
        new_first = np.where(np.less(low, first), np.subtract(low, GROWTH_CELLS), first)
        new_end = np.where(np.greater_equal(high, end), np.add(high, 1 + GROWTH_CELLS), end)
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
def _bounds(columns: NDArray[np.int64]) -> Box:
    """The least (i, j) and the greatest of (N, 2) indices, N >= 1."""
    low_i, low_j = high_i, high_j = columns[0, 0], columns[0, 1]
    for row in range(1, columns.shape[0]):
        i, j = columns[row, 0], columns[row, 1]
        low_i, high_i = min(low_i, i), max(high_i, i)
        low_j, high_j = min(low_j, j), max(high_j, j)
    return low_i, low_j, high_i, high_j


@njit(cache=True)
def _moved(columns: NDArray[np.int64], by_i: int, by_j: int) -> NDArray[np.int64]:
    """(N, 2) indices, each moved by as much."""
    moved = np.empty_like(columns)
    for row in range(columns.shape[0]):
        moved[row, 0], moved[row, 1] = columns[row, 0] + by_i, columns[row, 1] + by_j
    return moved


@njit(cache=True, error_model="numpy")
def _change_counts(
    navigable: NDArray[np.int16],
    obstacles: NDArray[np.int16],
    columns: NDArray[np.int64],
    change: tuple[NDArray[np.int8], NDArray[np.int8]],
    columns_per_cell: int,
) -> None:
    for row in range(columns.shape[0]):
        i, j = columns[row, 0], columns[row, 1]
        navigable[i, j] += change[0][row]
        obstacles[i // columns_per_cell, j // columns_per_cell] += change[1][row]


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


@njit(cache=True, error_model="numpy")
def _classify_cells(
    cells: NDArray[np.int8],
    counts: tuple[NDArray[np.int16], NDArray[np.bool_], NDArray[np.uint8], NDArray[np.int16]],
    columns: NDArray[np.int64],
    rules: tuple[int, int],
) -> None:
    """G(i, j) of Section III-C; where both M_nav and M_obs project, the obstacle wins.

    Floor that was observed wins over what was seen through, and that over interpolated points.
    """
    navigable, bridged, seen_through, obstacles = counts
    columns_per_cell, min_obstacle_voxels = rules
    last_i, last_j = -1, -1
    for row in range(columns.shape[0]):
        i, j = columns[row, 0] // columns_per_cell, columns[row, 1] // columns_per_cell
        if i == last_i and j == last_j:
            continue
        last_i, last_j = i, j
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
