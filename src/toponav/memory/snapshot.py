"""Frozen views of the topological memory: what a reasoner and an observer see (Section III-D)."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

UNKNOWN_ROOM = "unknown"
"""R_k before a reasoner has named the room, or when rooms are ablated."""


class NodeAttribute(StrEnum):
    """What Table III ablates from the nodes."""

    ROOM = "room"
    OBJECTS = "objects"
    FRONTIERS = "frontiers"


ALL_ATTRIBUTES = frozenset(NodeAttribute)


@dataclass(frozen=True)
class NodeView:
    """N_k = <id_k, n_k, O_k, R_k, f_k>.

    Attributes:
        id: id_k, unique and never reused.
        position: n_k = (x, y), metres, world frame.
        floor: Index of the floor the node lies on.
        objects: O_k, sorted category names within r_topo; empty when objects are ablated.
        room_type: R_k, or UNKNOWN_ROOM.
        frontier_count: f_k, frontier points within r_topo; 0 when frontiers are ablated.
        visits: How often the agent has arrived here.
    """

    id: int
    position: tuple[float, float]
    floor: int
    objects: tuple[str, ...]
    room_type: str
    frontier_count: int
    visits: int


@dataclass(frozen=True)
class EdgeView:
    """A connection that the agent has travelled or could travel.

    Attributes:
        source: The smaller node id.
        target: The larger node id.
        travelled_m: Length of the path the agent took between them.
        geodesic_m: Shortest known-free path between them.
    """

    source: int
    target: int
    travelled_m: float
    geodesic_m: float


@dataclass(frozen=True)
class MemorySnapshot:
    """The whole memory at one decision.

    Attributes:
        nodes: By ascending id.
        edges: By (source, target).
        current: Node at which the agent stands.
        history: H, ids in order of arrival, repeats included.
        text: The form that a language model reads.
        shown: What of the nodes is not ablated.
    """

    nodes: tuple[NodeView, ...]
    edges: tuple[EdgeView, ...]
    current: int
    history: tuple[int, ...]
    text: str
    shown: frozenset[NodeAttribute] = ALL_ATTRIBUTES
