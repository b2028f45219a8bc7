"""What an agent decided and why, for those who watch: recorders, pictures, tests."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from toponav.mapping.view import MapView
from toponav.memory.graph import TopologicalMemory
from toponav.memory.snapshot import MemorySnapshot
from toponav.policy.affordances import Affordances, Phase
from toponav.policy.candidate_view import CandidateView
from toponav.reasoning.base import PanoramaView
from toponav.reasoning.schema import Guidance


@dataclass(frozen=True, eq=False)
class WeighedFrontier:
    """A frontier as a search weighed it.

    Attributes:
        waypoint: (3,) its cell that is cheapest to walk to, world frame, metres.
        cells: How many cells it has.
        path_cost: Cost of walking to it: metres, weighted where it is narrow.
        unknown_m2: Unknown floor just beyond it.
        likelihood: Of the target about it, in [0, 1], by what has been seen there.
        speaks: Category that gave the likelihood; "" where nothing telling is near.
        guided: Whether it belongs to the place that the reasoner named.
        on_stairs: Whether it leads off the floor.
        promise: Chance of finding the target beyond it, up to a common factor.
        rank: 0-based place in the order of visits; None beyond those that were ordered.
    """

    waypoint: NDArray[np.float64]
    cells: int
    path_cost: float
    unknown_m2: float
    likelihood: float
    speaks: str
    guided: bool
    on_stairs: bool
    promise: float
    rank: int | None = None


@dataclass(frozen=True, eq=False)
class Decision:
    """One decision; methods without a memory, a reasoner or affordances leave those None.

    Attributes:
        index: 0-based count in the episode.
        step: Actions taken when it was made.
        phase: Exploration or target acquisition.
        waypoint: (3,) p_target, or None when nothing was left to go to.
        path: (K, 2) planned way to it, world frame, metres.
        map_view: The map as it was.
        memory: M_topo and H as the reasoner saw them.
        guidance: The reasoner's answer.
        affordances: Every term on M_nav.
        panorama: The views, in order.
        frontiers: What a planned search weighed, in the order of visits; empty where none was made.
        candidates: What may be the target; empty where no evidence is kept.
    """

    index: int
    step: int
    phase: Phase
    waypoint: NDArray[np.float64] | None
    path: NDArray[np.float64]
    map_view: MapView
    memory: MemorySnapshot | None = None
    guidance: Guidance | None = None
    affordances: Affordances | None = None
    panorama: tuple[PanoramaView, ...] = ()
    frontiers: tuple[WeighedFrontier, ...] = ()
    candidates: tuple[CandidateView, ...] = ()


class DecisionListener(Protocol):
    """Watches an agent's decisions; it never steers."""

    def on_decision(self, decision: Decision) -> None:
        """Called once a decision, right after it was made."""
        ...

    def on_close(self, map_view: MapView | None, memory: TopologicalMemory | None) -> None:
        """Called when the agent is closed, with its last map and memory where it keeps them."""
        ...


class Listeners:
    """Any number of listeners as one; without any, the null listener."""

    def __init__(self, listeners: Sequence[DecisionListener] = ()) -> None:
        """Forward to `listeners`, in order."""
        self._listeners = tuple(listeners)

    def on_decision(self, decision: Decision) -> None:
        """Forward one decision."""
        for listener in self._listeners:
            listener.on_decision(decision)

    def on_close(self, map_view: MapView | None, memory: TopologicalMemory | None) -> None:
        """Forward the end of the episode."""
        for listener in self._listeners:
            listener.on_close(map_view, memory)
