"""What the other storeys promise: the unseen by what stands there, the left by what was left."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import pytest

from drawn_map import drawn_map
from toponav.control.storeys import LEAST_PROMISE, Storeys, share_upstairs
from toponav.mapping.view import MapView
from toponav.reasoning.prior import PriorReasoner

UNSEEN = 1.5
VIEW = drawn_map("...")
NAMES = ("bed", "bathtub", "sofa", "oven", "table")


def on_floor(index: int, z: float) -> MapView:
    return replace(VIEW, floor=index, floor_z=z)


def promise(
    storeys: Storeys, view: MapView, *, up: bool, affinity: Mapping[str, float] | None = None
) -> float:
    return storeys.promise(up=up, view=view, unseen=UNSEEN, affinity=affinity or {})


def test_where_nothing_tells_up_and_down_are_alike() -> None:
    assert share_upstairs({}) == 0.5
    assert promise(Storeys(), VIEW, up=True) == promise(Storeys(), VIEW, up=False) == UNSEEN


@pytest.mark.parametrize(
    ("target", "upstairs"),
    [("bed", True), ("toilet", True), ("sofa", False), ("tv_monitor", False)],
)
def test_what_goes_with_beds_is_looked_for_upstairs(target: str, upstairs: bool) -> None:
    known = PriorReasoner().object_affinity(target, NAMES).tolist()
    affinity = {**dict(zip(NAMES, known, strict=True)), target: 1.0}
    up, down = (promise(Storeys(), VIEW, up=way, affinity=affinity) for way in (True, False))
    assert (up > down) is upstairs
    assert up + down == pytest.approx(2.0 * UNSEEN)


def test_a_storey_that_was_left_promises_what_was_left_there() -> None:
    storeys = Storeys()
    storeys.note(on_floor(0, 0.0), left=0.3)
    storeys.note(on_floor(1, 2.8), left=0.0)
    assert promise(storeys, on_floor(1, 2.8), up=False) == pytest.approx(0.3)
    assert promise(storeys, on_floor(0, 0.0), up=True) == LEAST_PROMISE
    assert promise(storeys, on_floor(1, 2.8), up=True) == UNSEEN
    storeys.note(on_floor(2, 5.6), left=9.0)
    assert promise(storeys, on_floor(1, 2.8), up=True) == UNSEEN
    assert promise(storeys, on_floor(2, 5.6), up=False) == LEAST_PROMISE
