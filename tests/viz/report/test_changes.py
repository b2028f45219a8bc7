"""What is said to have changed from one decision to the next."""

from __future__ import annotations

from typing import Any

from toponav.evaluation.explanation_file import DecisionRecord
from toponav.viz.report.changes import changes


def record(cells: str, floor: int = 0, **more: Any) -> DecisionRecord:
    """A decision on a row of cells of half a metre: "?" unknown, "." free, "#" wall, "f"."""
    values = ["?.#f".index(cell) for cell in cells]
    layer = [number for value in values for number in (value, 1)]
    grid = {"origin": [0.0, 0.0], "resolution": 0.5, "shape": [1, len(cells)], "cells": layer,
            "objects": [0, len(cells)], "categories": more.pop("categories", [])}  # fmt: skip
    return DecisionRecord.model_validate({"index": 0, "floor": floor, "map": grid, **more})


def node(number: int, room: str = "unknown") -> dict[str, Any]:
    return {"id": number, "position": [0.0, 0.0], "floor": 0, "objects": [], "room_type": room,
            "frontier_count": 0, "visits": 1}  # fmt: skip


def candidate(x: float, log_odds: float) -> dict[str, Any]:
    return {"low": [x, 0.0, 0.0], "high": [x + 0.2, 0.2, 0.2], "log_odds": log_odds,
            "verdict": 0.0, "returns": 0, "chosen": False, "sides": []}  # fmt: skip


def test_the_first_decision_tells_all_that_is_known() -> None:
    first = record("??.f##", nodes=[node(1)], categories=["tv_stand"])
    assert changes(None, first) == [
        "1.0 m² more seen, 1.0 m² in all",
        "1 frontier cells",
        "new place 1",
        "mapped for the first time: tv stand",
    ]


def test_only_what_changed_is_told() -> None:
    before = record("??.f##", nodes=[node(1)], categories=["sofa"])
    assert changes(before, before) == []
    after = record(
        "?...ff", nodes=[node(1, "bedroom"), node(2, "hall")], categories=["bed", "sofa"]
    )
    assert changes(before, after) == [
        "0.2 m² more seen, 1.2 m² in all",
        "frontier cells: 1 → 2",
        "place 1 named bedroom",
        "new place 2: hall",
        "mapped for the first time: bed",
    ]


def test_a_place_that_is_gone_was_merged() -> None:
    before, after = record(".", nodes=[node(1), node(2)]), record(".", nodes=[node(1)])
    assert changes(before, after) == ["place 2 merged into another"]


def test_candidates_are_followed_by_where_they_are() -> None:
    before = record(".", candidates=[candidate(1.0, 0.4), candidate(5.0, 1.0)])
    after = record(".", candidates=[candidate(5.1, 2.5), candidate(9.0, -0.3)])
    assert changes(before, after) == [
        "candidate 1: log-odds +1.0 → +2.5",
        "new candidate 2: log-odds -0.3",
    ]


def test_another_floor_is_a_new_map() -> None:
    assert changes(record("....", floor=0), record("?..f", floor=1)) == [
        "on floor 1 now",
        "0.8 m² more seen, 0.8 m² in all",
        "1 frontier cells",
    ]
