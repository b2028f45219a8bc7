"""From overlapping boxes to rooms that share walls: the first half of importing a room graph.

A room graph gives each room's bounding box. Boxes of neighbours leave gaps of a wall's thickness,
and the box of an L-shaped room covers its neighbours. Edges that nearly agree are made to agree;
where boxes overlap, the smaller room is the one that is really there.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from toponav.errors import SceneError
from toponav.scenes.plan_grid import CELL_M, FREE, MAX_PLAN_CELLS, PlanGrid, simple_room

SNAP_M = 0.35
"""Edges within this distance are two faces of one wall."""

MIN_ROOM_WIDTH_M = 1.2
"""Narrower boxes are scanned in part (a toilet of 0.6 m) and widened about their middle."""

NARROWEST_CELLS = 7
"""Strips below 0.7 m are artefacts of the boxes; after two half walls an agent still passes."""

MARGIN_CELLS = 20
"""Free cells around the plan, in which corridors may run."""


@dataclass(frozen=True)
class RoomBox:
    """The footprint of a room in plan coordinates, metres.

    Attributes:
        key: Not negative; what the plan's cells hold.
        label: The room's type.
        low: x and y of the lower corner.
        high: x and y of the upper corner.
        yields: Whether other rooms win where they overlap, whatever their size.
    """

    key: int
    label: str
    low: tuple[float, float]
    high: tuple[float, float]
    yields: bool = False

    @property
    def area(self) -> float:
        """Square metres."""
        return (self.high[0] - self.low[0]) * (self.high[1] - self.low[1])


def plan_rooms(
    boxes: Sequence[RoomBox], building: Sequence[RoomBox] | None = None
) -> tuple[PlanGrid, dict[int, int]]:
    """Resolve overlaps so that each room is one simple polygon.

    Args:
        boxes: The rooms of one level, at least one.
        building: The rooms of all levels, when their plans are to share one lattice.

    Returns:
        The plan, and for each room that others cover so far that nothing is left of it, the key of
        the room that covers it most.

    Raises:
        SceneError: The boxes span more than any building.
    """
    snapped = _snapped([_widened(item) for item in boxes])
    grid = _empty_grid([_widened(item) for item in building or boxes])
    for item in sorted(snapped, key=lambda item: (not item.yields, -item.area, item.key)):
        (i0, j0), (i1, j1) = _cell(grid, item.low), _cell(grid, item.high)
        grid.owner[i0:i1, j0:j1] = item.key
    for item in sorted(snapped, key=lambda item: (item.area, item.key)):
        mask = grid.mask(item.key)
        room = simple_room(mask, (grid.owner != FREE) & ~mask, NARROWEST_CELLS)
        grid.owner[mask] = FREE
        grid.owner[room] = item.key
    return grid, _absorbers(grid, snapped)


def _absorbers(grid: PlanGrid, boxes: Sequence[RoomBox]) -> dict[int, int]:
    """Who owns most of the box of each room that has no cell left."""
    absorbers = {}
    for item in boxes:
        if not grid.mask(item.key).any():
            (i0, j0), (i1, j1) = _cell(grid, item.low), _cell(grid, item.high)
            owners = grid.owner[i0:i1, j0:j1]
            owners = owners[owners != FREE]
            if owners.size:
                absorbers[item.key] = int(np.bincount(owners).argmax())
    return absorbers


def _widened(item: RoomBox) -> RoomBox:
    low, high = np.array(item.low), np.array(item.high)
    middle, half = (low + high) / 2.0, np.maximum((high - low) / 2.0, MIN_ROOM_WIDTH_M / 2.0)
    return replace(item, low=tuple(middle - half), high=tuple(middle + half))


def _snapped(boxes: Sequence[RoomBox]) -> list[RoomBox]:
    """Replace edges that lie within `SNAP_M` of each other by their mean, axis by axis."""
    low = np.array([item.low for item in boxes])
    high = np.array([item.high for item in boxes])
    for axis in (0, 1):
        edges = np.concatenate((low[:, axis], high[:, axis]))
        snapped = _merge_close(edges)
        low[:, axis], high[:, axis] = snapped[: len(boxes)], snapped[len(boxes) :]
    return [
        replace(item, low=(float(a[0]), float(a[1])), high=(float(b[0]), float(b[1])))
        for item, a, b in zip(boxes, low, high, strict=True)
    ]


def _merge_close(values: np.ndarray) -> np.ndarray:
    """Means of runs of sorted values no longer than `SNAP_M`, in the order of `values`."""
    order = np.argsort(values, kind="stable")
    result = np.empty_like(values)
    start = 0
    for end in range(1, len(order) + 1):
        if end == len(order) or values[order[end]] - values[order[start]] > SNAP_M:
            result[order[start:end]] = values[order[start:end]].mean()
            start = end
    return result


def _empty_grid(boxes: Sequence[RoomBox]) -> PlanGrid:
    low = np.min([item.low for item in boxes], axis=0)
    high = np.max([item.high for item in boxes], axis=0)
    origin = np.floor(low / CELL_M - MARGIN_CELLS) * CELL_M
    extent = np.ceil((high - origin) / CELL_M) + MARGIN_CELLS
    if extent[0] * extent[1] > MAX_PLAN_CELLS:
        size = high - low
        raise SceneError(
            f"rooms span {size[0]:.0f} m x {size[1]:.0f} m on one level; coordinates are in metres"
        )
    owner = np.full((int(extent[0]), int(extent[1])), FREE, np.int32)
    return PlanGrid(owner, (float(origin[0]), float(origin[1])))


def _cell(grid: PlanGrid, point: tuple[float, float]) -> tuple[int, int]:
    i, j = np.round((np.array(point) - grid.origin) / CELL_M).astype(int)
    return int(i), int(j)
