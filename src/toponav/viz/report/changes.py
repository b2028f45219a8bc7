"""What is new at a decision, in a few plain lines."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence

from toponav.categories import readable
from toponav.evaluation.explanation_file import (
    CandidateRecord,
    DecisionRecord,
    MapRecord,
    NodeRecord,
)
from toponav.memory.snapshot import UNKNOWN_ROOM

SAME_THING_M = 0.5
"""A candidate whose middle is this near to that of an earlier one is the same."""

LEAST_AREA_M2 = 0.05
LEAST_ODDS = 0.05
UNKNOWN, FRONTIER = 0, 3


def changes(before: DecisionRecord | None, after: DecisionRecord) -> list[str]:
    """What changed on the map, in the memory and among the candidates.

    Args:
        before: The last decision; None for the first.
        after: This one.
    """
    same_floor = before is not None and before.floor == after.floor
    before_map = before.map if before is not None and same_floor else None
    return [
        *([] if before is None or same_floor else [f"on floor {after.floor} now"]),
        *_floor_seen(before_map, after.map),
        *_frontiers(before_map, after.map),
        *_places(() if before is None else before.nodes, after.nodes),
        *_objects(() if before_map is None else before_map.categories, after.map.categories),
        *_candidates(() if before is None else before.candidates, after.candidates),
    ]


def _floor_seen(before: MapRecord | None, after: MapRecord) -> Iterable[str]:
    now = _known_m2(after)
    gained = now - (0.0 if before is None else _known_m2(before))
    if gained >= LEAST_AREA_M2:
        yield f"{gained:.1f} m² more seen, {now:.1f} m² in all"


def _known_m2(record: MapRecord) -> float:
    return _count(record, lambda value: value != UNKNOWN) * record.resolution**2


def _frontiers(before: MapRecord | None, after: MapRecord) -> Iterable[str]:
    now = _count(after, lambda value: value == FRONTIER)
    if before is None:
        yield f"{now} frontier cells"
        return
    then = _count(before, lambda value: value == FRONTIER)
    if now != then:
        yield f"frontier cells: {then} → {now}"


def _count(record: MapRecord, wanted: Callable[[int], bool]) -> int:
    runs = record.cells
    return sum(
        length for value, length in zip(runs[0::2], runs[1::2], strict=True) if wanted(value)
    )


def _places(before: Sequence[NodeRecord], after: Sequence[NodeRecord]) -> Iterable[str]:
    old, new = ({node.id: node for node in nodes} for nodes in (before, after))
    for gone in sorted(old.keys() - new.keys()):
        yield f"place {gone} merged into another"
    for node_id, node in sorted(new.items()):
        room = readable(node.room_type)
        if node_id not in old:
            named = "" if node.room_type == UNKNOWN_ROOM else f": {room}"
            yield f"new place {node_id}{named}"
        elif old[node_id].room_type != node.room_type:
            yield f"place {node_id} named {room}"


def _objects(before: Sequence[str], after: Sequence[str]) -> Iterable[str]:
    found = [readable(name) for name in after if name not in before]
    if found:
        yield f"mapped for the first time: {', '.join(found)}"


def _candidates(
    before: Sequence[CandidateRecord], after: Sequence[CandidateRecord]
) -> Iterable[str]:
    for number, candidate in enumerate(after, start=1):
        earlier = [one for one in before if _distance(one, candidate) <= SAME_THING_M]
        if not earlier:
            yield f"new candidate {number}: log-odds {candidate.log_odds:+.1f}"
            continue
        nearest = min(earlier, key=lambda one: _distance(one, candidate))
        if abs(nearest.log_odds - candidate.log_odds) >= LEAST_ODDS:
            yield (
                f"candidate {number}: log-odds {nearest.log_odds:+.1f} → {candidate.log_odds:+.1f}"
            )


def _distance(one: CandidateRecord, other: CandidateRecord) -> float:
    return math.dist(_middle(one), _middle(other))


def _middle(candidate: CandidateRecord) -> tuple[float, ...]:
    corners = zip(candidate.low, candidate.high, strict=True)
    return tuple((low + high) / 2.0 for low, high in corners)
