"""Straight flights of stairs: steps, the well in the floor above, and its railing."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from shapely.geometry import Polygon

from toponav.scenes.house import Level, Stairs
from toponav.scenes.mesh_builder import MeshBuilder
from toponav.scenes.solids import extrude
from toponav.scenes.textures import paint, wood

MAX_RISE_M = 0.17
"""Steps are lower than this; the protocol's agent climbs 0.2 m."""
HEADROOM_M = 2.0
"""The floor above is open over all of the flight that has less room than this."""
RAIL_HEIGHT_M = 0.9
RAIL_THICKNESS_M = 0.06
SLAB_M = 0.3
"""How far the well's sides reach down from the upper floor, to hide the slab."""
STEPS = wood((156, 112, 74))
RAILING = paint((92, 84, 78))


def _flight(
    stairs: Stairs, levels: list[Level]
) -> tuple[NDArray[np.float64], NDArray[np.float64], float, float]:
    """Lower end, horizontal vector to the upper end, and both heights."""
    low, high = levels[stairs.from_level].floor, levels[stairs.to_level].floor
    start, end = np.array(stairs.start), np.array(stairs.end)
    if low > high:
        start, end, low, high = end, start, high, low
    return start, end - start, low, high


def _strip(stairs: Stairs, levels: list[Level], t0: float, t1: float, side: float) -> Polygon:
    """The flight's footprint between two fractions of its run, widened by `side` on each side."""
    start, run, _, _ = _flight(stairs, levels)
    across = np.array([-run[1], run[0]]) / np.hypot(*run) * (stairs.width / 2 + side)
    a, b = start + t0 * run, start + t1 * run
    return Polygon([a - across, b - across, b + across, a + across])


def _well_start(stairs: Stairs, levels: list[Level]) -> float:
    """Fraction of the run from which headroom under the upper floor is short."""
    _, _, low, high = _flight(stairs, levels)
    return max(0.0, 1.0 - (HEADROOM_M + SLAB_M) / (high - low))


def stairwell(stairs: Stairs, levels: list[Level]) -> Polygon:
    """The hole in the upper level's floor."""
    return _strip(stairs, levels, _well_start(stairs, levels), 1.0, 0.0)


def add_stairs(builder: MeshBuilder, stairs: Stairs, levels: list[Level], name: str) -> None:
    """Add the steps, solid down to the lower floor, and the railing round the well."""
    _, run, low, high = _flight(stairs, levels)
    count = math.ceil((high - low) / MAX_RISE_M)
    instance = builder.instance(name, "stairs")
    for k in range(count - 1):  # the last rise ends on the upper floor itself
        step = _strip(stairs, levels, k / (count - 1), (k + 1) / (count - 1), 0.0)
        top = low + (k + 1) * (high - low) / count
        builder.add_surface(*extrude(step, low, top), STEPS, instance)
    _add_railing(builder, stairs, levels, float(np.hypot(*run)), f"railing_{name}")


def _add_railing(
    builder: MeshBuilder, stairs: Stairs, levels: list[Level], run_m: float, name: str
) -> None:
    """Three sides of the well; the fourth is where the flight arrives."""
    _, _, _, high = _flight(stairs, levels)
    first = _well_start(stairs, levels)
    margin = RAIL_THICKNESS_M / run_m
    outer = _strip(stairs, levels, first - margin, 1.0, RAIL_THICKNESS_M)
    rails = outer.difference(_strip(stairs, levels, first, 1.0 + margin, 0.0))
    instance = builder.instance(name, "wall")
    solid = extrude(rails, high - SLAB_M, high + RAIL_HEIGHT_M)
    builder.add_surface(*solid, RAILING, instance)
