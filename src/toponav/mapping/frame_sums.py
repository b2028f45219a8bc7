"""Eq. (1), eq. (2) and the sums of VoxelDownsample, for a whole frame and its labels in one pass.

Neighbouring pixels mostly fall into the same voxel, so a row is summed run by run, and the runs of
one voxel are gathered over the rows before the map is looked up; no array of points is ever made.
A run ends where the labels change too, so that its sums serve M_scene and every M_obj at once. What
is done to every pixel is in loops without branches, which the compiler turns into vectors.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from toponav.mapping.voxels import VoxelSums, pack_key

MAX_LABELS = 32
"""Labels that one pass tells apart, a bit each."""

RECENT = 1 << 12
"""Voxels that the gathering of runs keeps in sight, by 12 bits of a hash: most of a frame's."""

SPAN = 1 << 17
"""Voxels that a frame may reach along an axis, half of them on either side of the camera: three
such numbers make one code that a double holds exactly."""

NOWHERE = -np.inf
"""Code of a pixel that does not count."""

DOUBT = 1e-8
"""Nearer than this to an integer, in voxels, a product may lie on the other side of it than the
quotient that it stands for: many times the rounding of numbers up to 2^20."""

_Lines = tuple[tuple[float, float, float], tuple[float, float, float], tuple[float, float, float]]
"""For each axis of the world slope, start and shift: x_w = d (slope ray_x + start) + shift."""

COLOR_BITS = 21
"""Bits of a channel in a packed sum over a row: 2^21 / 255 pixels are more than a row has."""

COLOR_MASK = np.uint64((1 << COLOR_BITS) - 1)


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
    """What is known of a row of W pixels.

    Attributes:
        codes: (W,) the pixel's voxel, as one number, or `NOWHERE`.
        depth_sums: (W + 1,) sums over the pixels before one: of the depths,
        lateral_sums: (W + 1,) of the camera's x,
        color_sums: (W + 1,) of the packed colours.
        breaks: (W,) whether a run starts here; true for the first pixel.
        starts: (W + 1,) first pixels of the runs: neighbours in one voxel, with the same labels.
    """

    codes: NDArray[np.float64]
    depth_sums: NDArray[np.float64]
    lateral_sums: NDArray[np.float64]
    color_sums: NDArray[np.uint64]
    breaks: NDArray[np.bool_]
    starts: NDArray[np.int32]


class _Gathered(NamedTuple):
    """Sums in the making.

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

    def for_pixels(self, pixels: int) -> _Gathered:
        """Room for that many sums; what the last call handed out is overwritten."""
        if len(self._gathered.codes) < pixels:
            self._gathered = _room_for(pixels)
        return self._gathered


def _room_for(pixels: int) -> _Gathered:
    return _Gathered(
        np.empty(pixels, np.float64),
        np.empty(pixels, np.uint32),
        np.empty((pixels, 3), np.float64),
        np.empty((pixels, 3), np.uint32),
        np.empty(pixels, np.int32),
        np.empty(pixels, np.int64),
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
    gathered = scratch.for_pixels(frame.depth.size)
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
    lattice: tuple[NDArray[np.float64], float],
    gathered: _Gathered,
) -> int:
    """Sum all rows; returns the number of sums."""
    height, width = frame.depth.shape
    row = _Row(
        np.empty(width),
        np.zeros(width + 1),
        np.zeros(width + 1),
        np.zeros(width + 1, np.uint64),
        np.ones(width, np.bool_),
        np.empty(width + 1, np.int32),
    )
    labels = np.zeros(width, np.uint32)
    recent = np.zeros(RECENT, np.int32)
    gathered.codes[0], found = NOWHERE, 0
    for v in range(height):
        depth = frame.depth[v]
        if not _encode(depth, frame.ray_x, _lines_of(frame, v), lattice, row.codes):
            _encode_exactly(depth, frame.ray_x, _lines_of(frame, v), lattice, row.codes)
        _leave_out(depth, window, row.codes)
        labels[:] = 0
        for instance in range(masks.bits.size):
            if masks.bits[instance] >= 0:
                _label(masks.pixels[instance, v], np.uint32(1 << masks.bits[instance]), labels)
        runs = _find_runs(row.codes, labels, row.breaks, row.starts)
        _accumulate(depth, frame.ray_x, frame.rgb[v], row)
        found = _gather_row((row, runs, frame.ray_y[v]), labels, recent, gathered, found)
    return found


@njit(cache=True)
def _lines_of(frame: Frame, v: int) -> _Lines:
    """Eq. (1) in eq. (2) along a row: x_w = d (R [ray_x, ray_y, 1]^T) + t."""
    R, t, y = frame.rotation, frame.translation, frame.ray_y[v]
    return (
        (R[0, 0], R[0, 1] * y + R[0, 2], t[0]),
        (R[1, 0], R[1, 1] * y + R[1, 2], t[1]),
        (R[2, 0], R[2, 1] * y + R[2, 2], t[2]),
    )


@njit(cache=True)
def _label(mask: NDArray[np.bool_], label: np.uint32, labels: NDArray[np.uint32]) -> None:
    """Set a label's bit along a row wherever its mask is."""
    for u in range(labels.size):
        labels[u] |= label * np.uint32(mask[u])


@njit(cache=True)
def _encode(
    depth: NDArray[np.float32],
    ray_x: NDArray[np.float64],
    lines: _Lines,
    lattice: tuple[NDArray[np.float64], float],
    codes: NDArray[np.float64],
) -> bool:
    """Write the voxels of a row as codes; returns whether they are those that division gives.

    To multiply by 1 / resolution costs a fraction of dividing, and may end up in the neighbouring
    voxel only where the quotient is an integer but for rounding.
    """
    (slope_x, start_x, t_x), (slope_y, start_y, t_y), (slope_z, start_z, t_z) = lines
    camera, resolution = lattice
    camera_x, camera_y, camera_z = camera[0], camera[1], camera[2]
    per_m = 1.0 / resolution
    doubtful = 0
    for u in range(depth.size):
        d, r = float(depth[u]), ray_x[u]
        x = (d * (slope_x * r + start_x) + t_x) * per_m
        y = (d * (slope_y * r + start_y) + t_y) * per_m
        z = (d * (slope_z * r + start_z) + t_z) * per_m
        i, j, k = np.floor(x), np.floor(y), np.floor(z)
        codes[u] = ((i - camera_x) * SPAN + (j - camera_y)) * SPAN + (k - camera_z)
        off_middle = max(abs(x - i - 0.5), abs(y - j - 0.5), abs(z - k - 0.5))
        doubtful += int(off_middle > 0.5 - DOUBT)
    return doubtful == 0


@njit(cache=True, error_model="numpy")
def _encode_exactly(
    depth: NDArray[np.float32],
    ray_x: NDArray[np.float64],
    lines: _Lines,
    lattice: tuple[NDArray[np.float64], float],
    codes: NDArray[np.float64],
) -> None:
    """As `_encode`, by division."""
    camera, resolution = lattice
    codes[:] = 0.0
    for axis in range(3):
        slope, start, shift = lines[axis]
        first = camera[axis]
        for u in range(depth.size):
            x = float(depth[u]) * (slope * ray_x[u] + start) + shift
            codes[u] = codes[u] * SPAN + (np.floor(x / resolution) - first)


@njit(cache=True)
def _leave_out(depth: NDArray[np.float32], window: DepthWindow, codes: NDArray[np.float64]) -> None:
    """Mark the pixels outside the window."""
    for u in range(depth.size):
        inside = (depth[u] > window.min_depth) & (depth[u] < window.max_depth)
        codes[u] = codes[u] if inside else NOWHERE


@njit(cache=True)
def _find_runs(
    codes: NDArray[np.float64],
    labels: NDArray[np.uint32],
    breaks: NDArray[np.bool_],
    starts: NDArray[np.int32],
) -> int:
    """Write where the runs start; returns their number. First vectors, then without branches."""
    for u in range(1, codes.size):
        breaks[u] = (codes[u] != codes[u - 1]) | (labels[u] != labels[u - 1])
    runs = 0
    for u in range(codes.size):
        starts[runs] = u
        runs += int(breaks[u])
    starts[runs] = codes.size
    return runs


@njit(cache=True)
def _accumulate(
    depth: NDArray[np.float32], ray_x: NDArray[np.float64], rgb: NDArray[np.uint8], row: _Row
) -> None:
    """Fill in the running sums; one loop, so that the additions overlap."""
    depth_sums, lateral_sums, color_sums = row.depth_sums, row.lateral_sums, row.color_sums
    depth_sum, lateral_sum, color_sum = 0.0, 0.0, np.uint64(0)
    for u in range(depth.size):
        d = float(depth[u])
        depth_sum += d
        lateral_sum += d * ray_x[u]
        color_sum += (
            np.uint64(rgb[u, 0])
            | (np.uint64(rgb[u, 1]) << np.uint64(COLOR_BITS))
            | (np.uint64(rgb[u, 2]) << np.uint64(2 * COLOR_BITS))
        )
        depth_sums[u + 1] = depth_sum
        lateral_sums[u + 1] = lateral_sum
        color_sums[u + 1] = color_sum


@njit(cache=True)
def _gather_row(
    part: tuple[_Row, int, float],
    labels: NDArray[np.uint32],
    recent: NDArray[np.int32],
    gathered: _Gathered,
    found: int,
) -> int:
    """Add a row's runs to the sums of their voxels; returns the number of sums."""
    row, runs, ray_y = part
    codes, all_labels, sums, color_sums, counts, _ = gathered
    for run in range(runs):
        start, end = row.starts[run], row.starts[run + 1]
        code, label = row.codes[start], labels[start]
        if code == NOWHERE:
            continue
        mixed = np.uint64(np.int64(code)) * np.uint64(0x9E3779B97F4A7C15)
        place = int(mixed >> np.uint64(52))
        total = recent[place]
        if codes[total] != code or all_labels[total] != label:
            total = found
            recent[place] = total
            codes[total], all_labels[total], counts[total] = code, label, 0
            for axis in range(3):
                sums[total, axis], color_sums[total, axis] = 0.0, 0
            found += 1
        depth = row.depth_sums[end] - row.depth_sums[start]
        sums[total, 0] += row.lateral_sums[end] - row.lateral_sums[start]
        sums[total, 1] += depth * ray_y
        sums[total, 2] += depth
        color = row.color_sums[end] - row.color_sums[start]
        color_sums[total, 0] += np.uint32(color & COLOR_MASK)
        color_sums[total, 1] += np.uint32((color >> np.uint64(COLOR_BITS)) & COLOR_MASK)
        color_sums[total, 2] += np.uint32(color >> np.uint64(2 * COLOR_BITS))
        counts[total] += end - start
    return found


@njit(cache=True)
def _to_world(
    frame: Frame, lattice: tuple[NDArray[np.float64], float], gathered: _Gathered, found: int
) -> None:
    """Write the voxels' keys, and instead of the sums those of the offsets from lower corners."""
    codes, _, sums, _, counts, keys = gathered
    camera, resolution = lattice
    camera_i, camera_j, camera_k = int(camera[0]), int(camera[1]), int(camera[2])
    R, t = frame.rotation, frame.translation
    for row in range(found):
        code = int(codes[row])
        k = (code + SPAN // 2) % SPAN - SPAN // 2
        code = (code - k) // SPAN
        j = (code + SPAN // 2) % SPAN - SPAN // 2
        index = ((code - j) // SPAN + camera_i, j + camera_j, k + camera_k)
        keys[row] = pack_key(index[0], index[1], index[2])
        x, y, z = sums[row, 0], sums[row, 1], sums[row, 2]
        for axis in range(3):
            along = R[axis, 0] * x + R[axis, 1] * y + R[axis, 2] * z
            shift = t[axis] - index[axis] * resolution
            sums[row, axis] = along + counts[row] * shift
