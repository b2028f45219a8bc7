"""The Reasoner seam: the same query for a VLM and for the offline prior (Section III-E)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.typing import NDArray

from toponav.memory.snapshot import MemorySnapshot
from toponav.reasoning.schema import Guidance
from toponav.registry import Registry

if TYPE_CHECKING:
    from toponav.perception.sightings import SightLog
    from toponav.reasoning.config import ReasoningConfig
    from toponav.reasoning.vlm.access import ModelAccess


@dataclass(frozen=True)
class SeenObject:
    """One detection of a view: its label, score and median range in metres."""

    label: str
    score: float
    range_m: float


@dataclass(frozen=True, eq=False)
class PanoramaView:
    """One view of V_t^panorama.

    Attributes:
        image: (H, W, 3) uint8.
        bearing: World yaw of the camera's forward axis, radians.
        seen: What the detector found, by descending score.
        navigable_area_m2: Area of floor seen in this view.
        frontier_count: Frontier points inside this view's horizontal wedge and depth range.
    """

    image: NDArray[np.uint8]
    bearing: float
    seen: tuple[SeenObject, ...]
    navigable_area_m2: float
    frontier_count: int


@dataclass(frozen=True, eq=False)
class Query:
    """Everything a reasoner may use: T_target, M_topo, H and V_t^panorama.

    Attributes:
        target: Category name or free text.
        memory: M_topo with history H, as text and as a graph.
        panorama: Views in the order taken; `Guidance.direction` indexes them. Never empty.
    """

    target: str
    memory: MemorySnapshot
    panorama: tuple[PanoramaView, ...]


class Reasoner(Protocol):
    """Decides where to look next, and says what goes with what.

    The answer's `node_id` is one of the snapshot's and `direction` indexes the panorama; the same
    query gives the same answer. Calling only when due, caching and falling back are wrappers.
    The affinities are what other methods ask a language model for; TopoNav itself only decides.
    """

    def decide(self, query: Query) -> Guidance:
        """Guidance for one decision.

        Raises:
            ReasonerError: No valid answer could be had.
        """
        ...

    def room_affinity(self, target: str, rooms: Sequence[str]) -> NDArray[np.float64]:
        """How likely a room of each type holds the target: (R,) in [0, 1].

        Args:
            target: Category name or free text.
            rooms: R types of room, free text.

        Raises:
            ReasonerError: No valid answer could be had.
        """
        ...

    def object_affinity(self, target: str, objects: Sequence[str]) -> NDArray[np.float64]:
        """How likely the target is where each object is: (N,) in [0, 1], 1 for the target itself.

        Args:
            target: Category name or free text.
            objects: N category names.

        Raises:
            ReasonerError: No valid answer could be had.
        """
        ...


@dataclass(frozen=True, eq=False)
class ReasonerContext:
    """What a reasoner is built from; it takes what it needs.

    Attributes:
        config: Every parameter of the reasoners.
        sights: What the agent's images truly show, for reasoners that stand for a real model; None
            where there is no ground truth.
        seed: Of the episode.
        access: Ledger, cache and recording for reasoners that ask a model; None keeps nothing.
    """

    config: ReasoningConfig
    sights: SightLog | None = None
    seed: int = 0
    access: ModelAccess | None = None


ReasonerFactory = Callable[[ReasonerContext], Reasoner]
reasoners: Registry[ReasonerFactory] = Registry("reasoner")
