"""The offline reasoner: a VLM's role played by common knowledge, without a model (Section III-E).

It reads the same `Query` and answers the same `Guidance`, so that everything runs without network,
key or GPU, and so that a failed model has a deterministic stand-in.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from toponav.categories import canonical
from toponav.config_model import ConfigModel
from toponav.memory.graph import path_lengths
from toponav.memory.snapshot import UNKNOWN_ROOM, MemorySnapshot, NodeView
from toponav.memory.text import clean_name
from toponav.reasoning.affinity import (
    ROOM_TYPES,
    canonical_room,
    companions_among,
    room_belief,
    room_prior,
    target_likelihood,
    target_presence,
)
from toponav.reasoning.base import (
    PanoramaView,
    Query,
    Reasoner,
    ReasonerContext,
    SeenObject,
    reasoners,
)
from toponav.reasoning.schema import Guidance

PLACES_KEPT = 4096
"""Likelihoods of the target that are remembered, by what is around: most nodes stay as they are."""


class PriorConfig(ConfigModel):
    """Weights of the offline reasoner: round figures chosen by reasoning, not fitted to houses."""

    semantic_exponent: float = Field(default=0.5, ge=0.0)
    """Power of the target's likelihood in a score: below 1, since the knowledge is rough."""

    object_evidence: float = Field(default=0.5, ge=0.0, le=1.0)
    """Weight of each object of O_k as evidence for the room of a node: r_topo reaches through
    walls."""

    frontier_half: float = Field(default=10.0, gt=0.0)
    """Frontier points at which a place counts as half open: 1 m of frontier on a 0.1 m grid."""

    area_half_m2: float = Field(default=5.0, gt=0.0)
    """Visible floor at which a view counts as half open."""

    area_share: float = Field(default=0.2, ge=0.0, le=1.0)
    """Share of visible floor, against frontiers, in how open a view is."""

    distance_half_m: float = Field(default=10.0, gt=0.0)
    """Path length in metres that halves the worth of a place: mild, as in one floor of a home."""

    revisit_weight: float = Field(default=0.5, ge=0.0)
    """How strongly recent arrivals at a place lower its worth."""

    revisit_decay: float = Field(default=0.8, ge=0.0, le=1.0)
    """Factor by which an arrival's weight shrinks with each later arrival elsewhere."""

    alignment: float = Field(default=0.5, ge=0.0, le=1.0)
    """Share of a view's score that is lost when it faces away from the chosen place."""

    room_confidence: float = Field(default=0.5, ge=0.0, le=1.0)
    """Posterior from which a room is named; less gives "unknown", since a first name stays."""

    evidence_range_m: float = Field(default=3.0, gt=0.0)
    """Range at which an object's evidence for the room around the agent is halved: beyond, it may
    stand behind a door."""

    found_score: float = Field(default=0.4, ge=0.0, le=1.0)
    """Detector score from which the target counts as found."""


@dataclass(frozen=True)
class PlaceScore:
    """Why a place is worth going to; `total` is the product of the others, likelihood tempered.

    Attributes:
        node_id: id_k.
        likelihood: P(target near the place | R_k, O_k).
        openness: How much is left to see there, in [0, 1], from f_k.
        nearness: Discount for the way there, in (0, 1].
        novelty: Discount for recent visits, in (0, 1].
        total: The score.
    """

    node_id: int
    likelihood: float
    openness: float
    nearness: float
    novelty: float
    total: float


class PriorReasoner:
    """Chooses by room-object affinity, frontiers, distance and history; never fails."""

    def __init__(self, config: PriorConfig | None = None) -> None:
        """Use these weights, or the defaults."""
        self._config = PriorConfig() if config is None else config

    def decide(self, query: Query) -> Guidance:
        """Guidance from common knowledge; ties go to the lowest id and the first view."""
        room = classify_room(query.panorama, self._config)
        scores = score_places(query, room, self._config)
        best = max(scores, key=lambda score: (score.total, -score.node_id))
        direction = choose_direction(query, best.node_id, self._config)
        found = best_target_score(query.panorama[direction], query.target)
        return Guidance(
            node_id=best.node_id,
            direction=direction,
            target_found=found >= self._config.found_score,
            room_type=room,
            reason=_explain(query, best, direction, room),
        )

    def room_affinity(self, target: str, rooms: Sequence[str]) -> NDArray[np.float64]:
        """P(the target is in a room of each type); an unknown type counts as any room."""
        by_room = dict(zip(ROOM_TYPES, target_presence(target), strict=True))
        anywhere = float(room_prior() @ target_presence(target))
        types = [canonical_room(room) for room in rooms]
        return np.array([anywhere if room is None else by_room[room] for room in types])

    def object_affinity(self, target: str, objects: Sequence[str]) -> NDArray[np.float64]:
        """P(the target is at a place where each object has been seen), 1 for the target itself."""
        category = canonical(target)
        names = [canonical(name) for name in objects]
        return np.array(
            [
                1.0 if name == category
                else target_likelihood(target, room_belief({name: 1.0}), (name,))
                for name in names
            ]
        )  # fmt: skip


def classify_room(panorama: Sequence[PanoramaView], config: PriorConfig) -> str:
    """R: the room type that the objects around the agent make likely, or UNKNOWN_ROOM.

    Each category counts once, by its best sighting: score x nearness.
    """

    def weight(seen: SeenObject) -> float:
        return seen.score / (1.0 + (seen.range_m / config.evidence_range_m) ** 2)

    belief = room_belief(_evidence((seen for view in panorama for seen in view.seen), weight))
    best = int(belief.argmax())
    return ROOM_TYPES[best] if belief[best] >= config.room_confidence else UNKNOWN_ROOM


def score_places(query: Query, room: str, config: PriorConfig) -> tuple[PlaceScore, ...]:
    """The worth of going to each node, by ascending id.

    worth = likelihood^a x openness x nearness x novelty: the chance of finding the target there,
    scaled by what is left to see and what it costs. A place without frontiers is worth nothing
    while another has some; where none has any (all seen, or frontiers ablated) the rest decides.

    Args:
        query: What a VLM would get.
        room: Room type of the current node by the panorama, used while its R_k is unknown.
        config: Weights.
    """
    memory = query.memory
    distances = _distances(memory)
    any_frontier = any(node.frontier_count > 0 for node in memory.nodes)
    scores = []
    for node in memory.nodes:
        likelihood = _likelihood(query, node, room, config)
        openness = _saturated(node.frontier_count, config.frontier_half) if any_frontier else 1.0
        nearness = config.distance_half_m / (config.distance_half_m + distances[node.id])
        novelty = _novelty(node.id, memory.history, config)
        total = math.pow(likelihood, config.semantic_exponent) * openness * nearness * novelty
        scores.append(PlaceScore(node.id, likelihood, openness, nearness, novelty, total))
    return tuple(scores)


def choose_direction(query: Query, node_id: int, config: PriorConfig) -> int:
    """d_vlm: the view that shows the target best, else the most promising opening.

    A view's worth is the target's likelihood given what is seen in it, times how open it is, less
    what its turning away from the chosen node costs.
    """
    sightings = [best_target_score(view, query.target) for view in query.panorama]
    if max(sightings) > 0.0:
        return _middle_of_longest_run([score == max(sightings) for score in sightings])
    bearing = _bearing_to(query.memory, node_id)

    def worth(view: PanoramaView) -> float:
        evidence = _evidence(view.seen, lambda seen: seen.score)
        likelihood = target_likelihood(query.target, room_belief(evidence), evidence)
        opening = (1.0 - config.area_share) * _saturated(view.frontier_count, config.frontier_half)
        opening += config.area_share * _saturated(view.navigable_area_m2, config.area_half_m2)
        away = 0.0 if bearing is None else (1.0 - math.cos(view.bearing - bearing)) / 2.0
        tempered = math.pow(likelihood, config.semantic_exponent)
        return tempered * opening * (1.0 - config.alignment * away)

    worths = [worth(view) for view in query.panorama]
    return worths.index(max(worths))


def _middle_of_longest_run(chosen: Sequence[bool]) -> int:
    """The middle of the longest run of neighbouring views; the panorama closes on itself.

    A thing seen in several overlapping views lies ahead in the middle one. The first run wins ties.
    """
    count = len(chosen)
    if all(chosen):
        return 0
    best_start, best_length = 0, 0
    for start in range(count):
        length = 0
        while chosen[(start + length) % count]:
            length += 1
        if length > best_length and not chosen[start - 1]:
            best_start, best_length = start, length
    return (best_start + (best_length - 1) // 2) % count


def best_target_score(view: PanoramaView, target: str) -> float:
    """Highest score with which a view shows the target itself; 0 if it does not."""
    category = canonical(target)
    return max((seen.score for seen in view.seen if canonical(seen.label) == category), default=0.0)


def _evidence(
    sightings: Iterable[SeenObject], weight: Callable[[SeenObject], float]
) -> dict[str, float]:
    """The categories sighted, each with the weight of its best sighting."""
    evidence: dict[str, float] = {}
    for seen in sightings:
        label = canonical(seen.label)
        evidence[label] = max(evidence.get(label, 0.0), weight(seen))
    return evidence


def _likelihood(query: Query, node: NodeView, room: str, config: PriorConfig) -> float:
    here = node.id == query.memory.current and node.room_type == UNKNOWN_ROOM
    known = room if here else node.room_type
    return _likelihood_among(query.target, node.objects, known, config.object_evidence)


@lru_cache(maxsize=PLACES_KEPT)
def _likelihood_among(target: str, objects: tuple[str, ...], room: str, weight: float) -> float:
    """P(the target is at a place) of such a room with those objects, each of that weight."""
    evidence = {canonical(name): weight for name in objects}
    return target_likelihood(target, room_belief(evidence, room), evidence)


def _saturated(amount: float, half: float) -> float:
    return amount / (amount + half)


def _novelty(node_id: int, history: Sequence[int], config: PriorConfig) -> float:
    """1 for a place not visited lately; the arrival that led to this decision does not count."""
    earlier = history[:-1]
    burden = sum(
        config.revisit_decay**age
        for age, visited in enumerate(reversed(earlier))
        if visited == node_id
    )
    return 1.0 / (1.0 + config.revisit_weight * burden)


def _distances(memory: MemorySnapshot) -> dict[int, float]:
    """Path lengths from the current node; straight lines to nodes that no edges connect to it."""
    here = _node(memory, memory.current).position
    straight = {node.id: math.dist(here, node.position) for node in memory.nodes}
    return straight | path_lengths(memory.edges, memory.current)


def _bearing_to(memory: MemorySnapshot, node_id: int) -> float | None:
    """World yaw from the current node to another; None to itself."""
    if node_id == memory.current:
        return None
    here, there = _node(memory, memory.current).position, _node(memory, node_id).position
    return math.atan2(there[1] - here[1], there[0] - here[0])


def _node(memory: MemorySnapshot, node_id: int) -> NodeView:
    return next(node for node in memory.nodes if node.id == node_id)


def _explain(query: Query, best: PlaceScore, direction: int, room: str) -> str:
    """One sentence on what spoke for the choice."""
    target = clean_name(canonical(query.target))
    node = _node(query.memory, best.node_id)
    here = node.id == query.memory.current and node.room_type == UNKNOWN_ROOM
    known = room if here else node.room_type
    place = f"place {node.id}" if known == UNKNOWN_ROOM else f"{clean_name(known)} place {node.id}"
    sentence = f"{place} is {best.likelihood:.0%} likely to hold the {target}"
    companions = companions_among(query.target, node.objects)
    if companions:
        sentence += f", near {', '.join(clean_name(name) for name in companions)}"
    if node.frontier_count:
        sentence += f", with {node.frontier_count} frontier points left to see"
    if best_target_score(query.panorama[direction], query.target) > 0.0:
        sentence += f"; view {direction} shows the {target}"
    return sentence


@reasoners.register("prior")
def _prior(context: ReasonerContext) -> Reasoner:
    return PriorReasoner(context.config.prior)
