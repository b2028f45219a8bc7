"""Eq. (1), eq. (2) and the sums of VoxelDownsample, for a whole frame and its labels in one pass.

Neighbouring pixels mostly fall into the same voxel, so every column of the image is summed run by
run, row after row of all columns at once, and the runs of one voxel are gathered before the map is
looked up; no array of points is ever made. A run ends where the labels change too, so that its sums
serve M_scene and every M_obj at once. What is done to every pixel is in loops without branches or
sums that wait for each other, which the compiler turns into vectors.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from toponav.mapping.voxel_codes import NOWHERE, Lattice, Lines, decoded, encode
from toponav.mapping.voxels import VoxelSums, pack_key

MAX_LABELS = 16
"""Labels that one pass tells apart, a bit each."""

RECENT = 1 << 12
"""Voxels that the gathering of runs keeps in sight, by 12 bits of a hash: most of a frame's."""


class DepthWindow(NamedTuple):
    """Which pixels count.

    Attributes:
        min_depth: Depths at or under it are no returns, metres.
        max_depth: Depths at or over it are no returns, metres.
        stride: Every how many rows and columns a pixel is used.
    """

    min_depth: float
    max_depth: float
    stride: int


class Frame(NamedTuple):
    """An observation as the kernels see it, every `stride`-th row and column of it."""

    depth: NDArray[np.float32]
    rgb: NDArray[np.uint8]
    ray_x: NDArray[np.float64]
    ray_y: NDArray[np.float64]
    rotation: NDArray[np.float64]
    translation: NDArray[np.float64]


class FrameSums(NamedTuple):
    """Sums over a frame's pixels, by voxel and set of labels; a voxel may come up more than once.

    Attributes:
        voxels: The sums; they lie in the scratch, and are overwritten with the next frame.
        labels: (N,) uint32 the labels of these pixels, a bit each.
    """

    voxels: VoxelSums
    labels: NDArray[np.uint32]


class _Row(NamedTuple):
    """What is known of the W pixels of a row.

    Attributes:
        codes: (W,) the pixel's voxel, as one number, or `NOWHERE`.
        labels: (W,) its labels, a bit each.
    """

    codes: NDArray[np.float64]
    labels: NDArray[np.uint16]


class _Runs(NamedTuple):
    """In every one of the W columns the run that has not ended yet.

    A run is pixels below each other, in one voxel and with the same labels.

    Attributes:
        first_rows: (W,) where it starts.
        totals: (W,) to which of the gathered sums it belongs.
        depth_sums: (W,) of the depths,
        y_sums: (W,) of the camera's y,
        color_sums: (3 W,) of the colours, red, green and blue in turns.
    """

    first_rows: NDArray[np.int32]
    totals: NDArray[np.int32]
    depth_sums: NDArray[np.float64]
    y_sums: NDArray[np.float64]
    color_sums: NDArray[np.uint32]


class _Gathered(NamedTuple):
    """Sums in the making; the last entry takes those of pixels that do not count.

    Attributes:
        codes: (N,) voxels, as in `_Row`.
        labels: (N,) labels of the pixels.
        sums: (N, 3) sums of the camera's x, y and z; at last of the offsets in the voxel.
        color_sums: (N, 3).
        counts: (N,) pixels.
        keys: (N,) at last the packed keys of the voxels.
    """

    codes: NDArray[np.float64]
    labels: NDArray[np.uint32]
    sums: NDArray[np.float64]
    color_sums: NDArray[np.uint32]
    counts: NDArray[np.int32]
    keys: NDArray[np.int64]


class Masks(NamedTuple):
    """What is labelled in a frame.

    Attributes:
        pixels: (N, H, W) bool instances.
        bits: (N,) the label of each, under `MAX_LABELS`; a negative one does not count.
    """

    pixels: NDArray[np.bool_]
    bits: NDArray[np.int64]


class Scratch:
    """Room for the sums of a frame, taken once for many: fresh memory costs more than the sums."""

    def __init__(self) -> None:
        """Take none yet."""
        self._gathered = _room_for(0)

    def for_sums(self, size: int) -> _Gathered:
        """Room for that many sums; what the last call handed out is overwritten."""
        if len(self._gathered.codes) < size:
            self._gathered = _room_for(size)
        return self._gathered


def _room_for(size: int) -> _Gathered:
    return _Gathered(
        np.empty(size, np.float64),
        np.empty(size, np.uint32),
        np.empty((size, 3), np.float64),
        np.empty((size, 3), np.uint32),
        np.empty(size, np.int32),
        np.empty(size, np.int64),
    )


def sum_frame(
    frame: Frame, window: DepthWindow, masks: Masks, resolution: float, scratch: Scratch
) -> FrameSums:
    """Sum the pixels of a frame by voxel and labels.

    Args:
        frame: The images and the pose, within `SPAN` / 2 voxels of everything that it shows.
        window: Which pixels count.
        masks: What is labelled, at every `stride`-th pixel like the frame.
        resolution: Edge of a voxel, metres.
        scratch: Holds the sums until it is used again.
    """
    gathered = scratch.for_sums(frame.depth.size + 1)
    camera = np.floor(frame.translation / resolution)
    found = _gather_frame(frame, window, masks, (camera, resolution), gathered)
    _to_world(frame, (camera, resolution), gathered, found)
    sums = VoxelSums(
        gathered.keys[:found],
        gathered.sums[:found],
        gathered.color_sums[:found],
        gathered.counts[:found],
    )
    return FrameSums(sums, gathered.labels[:found])


@njit(cache=True)
def _gather_frame(
    frame: Frame,
    window: DepthWindow,
    masks: Masks,
    lattice: Lattice,
    gathered: _Gathered,
) -> int:
    """Sum all rows; returns the number of sums."""
    height, width = frame.depth.shape
    rows = (_empty_row(width), _empty_row(width))
    runs = _Runs(
        np.zeros(width, np.int32),
        np.full(width, gathered.codes.size - 1, np.int32),
        np.zeros(width),
        np.zeros(width),
        np.zeros(3 * width, np.uint32),
    )
    breaks, ended = np.zeros(width, np.bool_), np.empty(width + 1, np.uint32)
    recent = np.zeros(RECENT, np.int32)
    gathered.codes[0], found = NOWHERE, 0
    depths = (window.min_depth, window.max_depth)
    colors = frame.rgb.reshape(height, 3 * width)
    for v in range(height):
        row, above = rows[v % 2], rows[1 - v % 2]
        depth = frame.depth[v]
        encode(depth, frame.ray_x, _lines_of(frame, v), (lattice, depths), row.codes)
        row.labels[:] = 0
        for instance in range(masks.bits.size):
            if masks.bits[instance] >= 0:
                _label(masks.pixels[instance, v], np.uint16(1 << masks.bits[instance]), row.labels)
        count = _find_breaks(row, above, breaks, ended)
        _end_runs(ended[:count], runs, (frame.ray_x, v), gathered)
        found = _begin_runs(ended[:count], row, runs, (recent, gathered), found)
        _accumulate(depth, frame.ray_y[v], colors[v], runs)
    _end_runs(np.arange(width).astype(np.uint32), runs, (frame.ray_x, height), gathered)
    return found


@njit(cache=True)
def _empty_row(width: int) -> _Row:
    return _Row(np.full(width, NOWHERE), np.zeros(width, np.uint16))


@njit(cache=True)
def _lines_of(frame: Frame, v: int) -> Lines:
    """Eq. (1) in eq. (2) along a row: x_w = d (R [ray_x, ray_y, 1]^T) + t."""
    R, t, y = frame.rotation, frame.translation, frame.ray_y[v]
    return (
        (R[0, 0], R[0, 1] * y + R[0, 2], t[0]),
        (R[1, 0], R[1, 1] * y + R[1, 2], t[1]),
        (R[2, 0], R[2, 1] * y + R[2, 2], t[2]),
    )


@njit(cache=True)
def _label(mask: NDArray[np.bool_], label: np.uint16, labels: NDArray[np.uint16]) -> None:
    """Set a label's bit along a row wherever its mask is."""
    for u in range(labels.size):
        labels[u] |= label * np.uint16(mask[u])


@njit(cache=True)
def _find_breaks(
    row: _Row, above: _Row, breaks: NDArray[np.bool_], ended: NDArray[np.uint32]
) -> int:
    """Write the columns whose runs end above this row; returns their number.

    First vectors, then without branches.
    """
    codes, labels = row
    codes_above, labels_above = above
    for u in range(codes.size):
        breaks[u] = (codes[u] != codes_above[u]) | (labels[u] != labels_above[u])
    count = 0
    for u in range(codes.size):
        ended[count] = u
        count += int(breaks[u])
    return count


@njit(cache=True)
def _end_runs(
    columns: NDArray[np.uint32],
    runs: _Runs,
    place: tuple[NDArray[np.float64], int],
    gathered: _Gathered,
) -> None:
    """Add the runs that end above row v to the sums of their voxels, and begin them anew."""
    first_rows, totals, depth_sums, y_sums, run_colors = runs
    _, _, sums, color_sums, counts, _ = gathered
    ray_x, v = place
    for column in columns:
        total, depth, first = totals[column], depth_sums[column], 3 * column
        sums[total, 0] += depth * ray_x[column]
        sums[total, 1] += y_sums[column]
        sums[total, 2] += depth
        counts[total] += v - first_rows[column]
        first_rows[column], depth_sums[column], y_sums[column] = v, 0.0, 0.0
        for channel in range(3):
            color_sums[total, channel] += run_colors[first + channel]
            run_colors[first + channel] = 0


@njit(cache=True)
def _begin_runs(
    columns: NDArray[np.uint32],
    row: _Row,
    runs: _Runs,
    known: tuple[NDArray[np.int32], _Gathered],
    found: int,
) -> int:
    """Find or make the sums of the runs that begin in a row; returns the number of sums."""
    recent, (codes, labels, sums, color_sums, counts, _) = known
    row_codes, row_labels = row
    totals, nowhere = runs.totals, codes.size - 1
    for column in columns:
        code, label = row_codes[column], np.uint32(row_labels[column])
        if code == NOWHERE:
            totals[column] = nowhere
            continue
        mixed = np.uint64(np.int64(code)) * np.uint64(0x9E3779B97F4A7C15)
        place = int(mixed >> np.uint64(52))
        total = recent[place]
        if codes[total] != code or labels[total] != label:
            total = found
            recent[place] = total
            codes[total], labels[total], counts[total] = code, label, 0
            for axis in range(3):
                sums[total, axis], color_sums[total, axis] = 0.0, 0
            found += 1
        totals[column] = total
    return found


@njit(cache=True)
def _accumulate(
    depth: NDArray[np.float32], ray_y: float, colors: NDArray[np.uint8], runs: _Runs
) -> None:
    """Add a row's pixels to the runs of their columns."""
    depth_sums, y_sums, color_sums = runs.depth_sums, runs.y_sums, runs.color_sums
    for u in range(depth.size):
        d = float(depth[u])
        depth_sums[u] += d
        y_sums[u] += d * ray_y
    for k in range(colors.size):
        color_sums[k] += np.uint32(colors[k])


@njit(cache=True)
def _to_world(frame: Frame, lattice: Lattice, gathered: _Gathered, found: int) -> None:
    """Write the voxels' keys, and instead of the sums those of the offsets from lower corners."""
    codes, _, sums, _, counts, keys = gathered
    camera, resolution = lattice
    camera_i, camera_j, camera_k = int(camera[0]), int(camera[1]), int(camera[2])
    R, t = frame.rotation, frame.translation
    for row in range(found):
        i, j, k = decoded(codes[row])
        index = (i + camera_i, j + camera_j, k + camera_k)
        keys[row] = pack_key(index[0], index[1], index[2])
        x, y, z = sums[row, 0], sums[row, 1], sums[row, 2]
        for axis in range(3):
            along = R[axis, 0] * x + R[axis, 1] * y + R[axis, 2] * z
            shift = t[axis] - index[axis] * resolution
            sums[row, axis] = along + counts[row] * shift
