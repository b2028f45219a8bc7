"""The topological memory M_topo as pure data: nodes, edges and history (Section III-D).

The paper's text connects nodes (it merges "connected spaces" and plans over the graph), but its
tuple N_k and its set M_topo hold no edges; here they are explicit.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import replace

import networkx as nx

from toponav.errors import InputError
from toponav.memory.snapshot import UNKNOWN_ROOM, EdgeView, NodeView

FIRST_ID = 1
"""The paper counts nodes from N_1, the start."""


class TopologicalMemory:
    """An undirected graph of places and the order H in which the agent arrived at them.

    Invariants: ids are never reused; edges join two different known nodes and have finite lengths;
    H holds known ids only; a node's visits equal its occurrences in H.
    """

    def __init__(self) -> None:
        """Create an empty memory."""
        self._graph: nx.Graph[int] = nx.Graph()
        self._history: list[int] = []
        self._next_id = FIRST_ID

    @classmethod
    def from_parts(
        cls,
        nodes: Iterable[NodeView],
        edges: Iterable[EdgeView],
        history: Iterable[int],
        next_id: int,
    ) -> TopologicalMemory:
        """Rebuild a memory from what its properties returned.

        Raises:
            InputError: The parts break an invariant.
        """
        memory = cls()
        memory._next_id = next_id
        for node in nodes:
            if not FIRST_ID <= node.id < next_id or node.id in memory:
                raise InputError(f"node id {node.id} is repeated or not in {FIRST_ID}..next_id - 1")
            memory._graph.add_node(node.id, view=node)
        for edge in edges:
            if edge.source >= edge.target or memory._graph.has_edge(edge.source, edge.target):
                raise InputError(
                    f"edge {edge.source}-{edge.target} is repeated or its source is not the "
                    "smaller id"
                )
            memory.connect(edge.source, edge.target, edge.travelled_m, edge.geodesic_m)
        for node_id in history:
            memory.node(node_id)
            memory._history.append(node_id)
        for node in memory.nodes:
            arrivals = memory._history.count(node.id)
            if node.visits != arrivals:
                raise InputError(
                    f"node {node.id} has {node.visits} visits but {arrivals} places in the history"
                )
        return memory

    def __len__(self) -> int:
        return len(self._graph)

    def __contains__(self, node_id: int) -> bool:
        return node_id in self._graph

    @property
    def nodes(self) -> tuple[NodeView, ...]:
        """All nodes by ascending id."""
        return tuple(self._graph.nodes[node_id]["view"] for node_id in sorted(self._graph))

    @property
    def edges(self) -> tuple[EdgeView, ...]:
        """All edges by (source, target)."""
        return tuple(
            EdgeView(source, target, lengths["travelled_m"], lengths["geodesic_m"])
            for source, target, lengths in sorted(
                (min(a, b), max(a, b), lengths) for a, b, lengths in self._graph.edges(data=True)
            )
        )

    @property
    def history(self) -> tuple[int, ...]:
        """H: ids in order of arrival, repeats included."""
        return tuple(self._history)

    @property
    def next_id(self) -> int:
        """The id that the next node gets."""
        return self._next_id

    def node(self, node_id: int) -> NodeView:
        """The node of that id.

        Raises:
            InputError: There is none.
        """
        if node_id not in self._graph:
            raise InputError(f"the memory has no node {node_id}")
        view: NodeView = self._graph.nodes[node_id]["view"]
        return view

    def neighbours(self, node_id: int) -> tuple[int, ...]:
        """Ids connected to a node, ascending."""
        return tuple(sorted(self._graph.neighbors(self.node(node_id).id)))

    def add_node(self, position: tuple[float, float], floor: int) -> NodeView:
        """Create a node at (x, y) metres that nothing is yet known about."""
        node = NodeView(self._next_id, position, floor, (), UNKNOWN_ROOM, 0, 0)
        self._graph.add_node(node.id, view=node)
        self._next_id += 1
        return node

    def describe_node(
        self,
        node_id: int,
        *,
        position: tuple[float, float] | None = None,
        objects: tuple[str, ...] | None = None,
        room_type: str | None = None,
        frontier_count: int | None = None,
    ) -> NodeView:
        """Replace the attributes given; the others stay."""
        old = self.node(node_id)
        node = replace(
            old,
            position=old.position if position is None else position,
            objects=old.objects if objects is None else objects,
            room_type=old.room_type if room_type is None else room_type,
            frontier_count=old.frontier_count if frontier_count is None else frontier_count,
        )
        self._graph.nodes[node_id]["view"] = node
        return node

    def record_arrival(self, node_id: int) -> None:
        """Append an arrival to H."""
        node = self.node(node_id)
        self._graph.nodes[node_id]["view"] = replace(node, visits=node.visits + 1)
        self._history.append(node_id)

    def connect(self, a: int, b: int, travelled_m: float, geodesic_m: float) -> None:
        """Join two nodes; a repeated connection keeps the shorter of each length.

        Raises:
            InputError: An unknown node, a self loop, or a length that is negative or not finite.
        """
        if self.node(a).id == self.node(b).id:
            raise InputError(f"node {a} cannot be connected to itself")
        for length in (travelled_m, geodesic_m):
            _check_length(a, b, length)
        old = self._graph.get_edge_data(a, b, default={})
        self._graph.add_edge(
            a,
            b,
            travelled_m=min(travelled_m, old.get("travelled_m", math.inf)),
            geodesic_m=min(geodesic_m, old.get("geodesic_m", math.inf)),
        )

    def set_geodesic(self, a: int, b: int, geodesic_m: float) -> None:
        """Replace the geodesic length of an existing edge, after one of its nodes moved."""
        _check_length(a, b, geodesic_m)
        self._graph.edges[a, b]["geodesic_m"] = geodesic_m

    def merge(self, a: int, b: int) -> NodeView:
        """Merge two nodes into n' = (n_a + n_b) / 2, keeping the earliest id and room type.

        Edges of the later node pass to the earlier one, H is renamed, visits add up, objects are
        united and the larger frontier count kept until the caller recomputes O' and f' from the
        map. An earlier node whose room is still unknown takes the later one's.
        """
        first, later = sorted((self.node(a), self.node(b)), key=lambda node: node.id)
        if first.id == later.id:
            raise InputError(f"node {a} cannot be merged with itself")
        position = (
            (first.position[0] + later.position[0]) / 2.0,
            (first.position[1] + later.position[1]) / 2.0,
        )
        room = later.room_type if first.room_type == UNKNOWN_ROOM else first.room_type
        merged = replace(
            first,
            position=position,
            objects=tuple(sorted({*first.objects, *later.objects})),
            room_type=room,
            frontier_count=max(first.frontier_count, later.frontier_count),
            visits=first.visits + later.visits,
        )
        for neighbour in self.neighbours(later.id):
            if neighbour != first.id:
                self.connect(first.id, neighbour, **self._graph.edges[later.id, neighbour])
        self._graph.remove_node(later.id)
        self._graph.nodes[first.id]["view"] = merged
        self._history = [first.id if i == later.id else i for i in self._history]
        return merged


def _check_length(a: int, b: int, length: float) -> None:
    if not (math.isfinite(length) and length >= 0.0):
        raise InputError(f"edge {a}-{b} has a length of {length}: it must be finite and >= 0")


def path_lengths(edges: Iterable[EdgeView], source: int) -> dict[int, float]:
    """Shortest geodesic length in metres from `source` to every node that edges connect to it."""
    graph: nx.Graph[int] = nx.Graph()
    graph.add_node(source)
    graph.add_weighted_edges_from((e.source, e.target, e.geodesic_m) for e in edges)
    lengths: dict[int, float] = nx.single_source_dijkstra_path_length(graph, source)
    return lengths
