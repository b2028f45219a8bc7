"""Building the topological memory while the agent moves (Section III-D)."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from toponav.config_model import ConfigModel
from toponav.geometry.neighbourhoods import Neighbourhoods
from toponav.mapping.view import MapView
from toponav.memory.graph import TopologicalMemory
from toponav.memory.snapshot import UNKNOWN_ROOM, MemorySnapshot, NodeAttribute, NodeView
from toponav.memory.text import TextBudget, describe
from toponav.memory.traversability import is_clear

Position = tuple[float, float]
"""(x, y) in metres, world frame."""

Geodesic = Callable[[Position, Position], float]
"""Length in metres of the shortest known-free path on the current floor; infinite if none."""


class MemoryConfig(ConfigModel):
    """When nodes are made and merged, and what they remember.

    The paper names r_topo and d_merge and gives no values.
    """

    r_topo: float = Field(default=3.0, gt=0.0)
    """Radius in metres within which a node knows objects and frontiers: an ordinary room seen from
    its middle, and well inside the camera's 5 m range."""

    d_merge: float = Field(default=1.0, ge=0.0)
    """Nodes nearer than this in metres, in sight of each other, are merged: four forward steps,
    less than the size of any room that deserves its own node."""

    min_object_points: int = Field(default=1, ge=1)
    """Map points of a category within r_topo that make it part of O_k; the paper's is 1."""

    below_floor_m: float = Field(default=0.3, ge=0.0)
    """Object points this far below a floor still belong to it: sensor noise, a sunken bath."""

    storey_height_m: float = Field(default=2.5, gt=0.0)
    """Object points up to this far above a floor belong to it."""

    include_rooms: bool = True
    """Whether reasoners are told room types (off: "w/o Room Type" in Table III)."""

    include_objects: bool = True
    """Whether reasoners are told objects (off: "w/o Objects Type" in Table III)."""

    include_frontiers: bool = True
    """Whether reasoners are told frontier counts (off: "w/o Frontiers" in Table III)."""

    text: TextBudget = TextBudget()
    """Limits of the text form."""

    @property
    def shown(self) -> frozenset[NodeAttribute]:
        """The attributes that are not ablated."""
        switches = {
            NodeAttribute.ROOM: self.include_rooms,
            NodeAttribute.OBJECTS: self.include_objects,
            NodeAttribute.FRONTIERS: self.include_frontiers,
        }
        return frozenset(attribute for attribute, shown in switches.items() if shown)


class MemoryBuilder:
    """Maintains M_topo over an episode: `arrive` at each waypoint, `refresh` before a decision."""

    def __init__(self, config: MemoryConfig, memory: TopologicalMemory | None = None) -> None:
        """Start an episode with an empty memory, or with one of the same building and frame."""
        self._config = config
        self._memory = TopologicalMemory() if memory is None else memory
        self._last: int | None = None

    @property
    def memory(self) -> TopologicalMemory:
        """M_topo, unabridged."""
        return self._memory

    def arrive(
        self,
        position_xy: Position,
        map_view: MapView,
        travelled_m: float,
        geodesic: Geodesic | None = None,
    ) -> int:
        """Record the arrival at a waypoint, or at the start.

        Makes N_new, connects it to the node of the last arrival of this episode, and merges it
        with the nearest mergeable node of its floor until none is left.

        Args:
            position_xy: Where the agent stands.
            map_view: The map on the agent's floor.
            travelled_m: Path length since the last arrival; ignored at the first.
            geodesic: Path lengths on this floor. Without it a line that is clear of obstacles
                counts as its length, and any other path as travelled.

        Returns:
            Id of the node at which the agent now stands.
        """
        position = (float(position_xy[0]), float(position_xy[1]))
        node = self._memory.add_node(position, map_view.floor)
        self._memory.record_arrival(node.id)
        if self._last is not None:
            last = self._memory.node(self._last)
            shortest = self._shortest(last, node, travelled_m, map_view, geodesic)
            self._memory.connect(last.id, node.id, travelled_m, shortest)
        while (other := self._mergeable(node, map_view)) is not None:
            node = self._memory.merge(node.id, other.id)
        self._update_lengths(node, map_view, geodesic)
        self._observe_surroundings([node], map_view)
        self._last = node.id
        return node.id

    def places(self, floor: int) -> NDArray[np.float64]:
        """(N, 2) where the nodes of a floor lie, metres."""
        found = [node.position for node in self._memory.nodes if node.floor == floor]
        return np.array(found, np.float64).reshape(-1, 2)

    def refresh(self, map_view: MapView) -> None:
        """Recompute O_k and f_k of all nodes on the map's current floor."""
        nodes = [node for node in self._memory.nodes if node.floor == map_view.floor]
        self._observe_surroundings(nodes, map_view)

    def set_room(self, node_id: int, room_type: str) -> None:
        """Name the room of a node; a room once known stays, as the paper keeps the earliest R."""
        if self._memory.node(node_id).room_type == UNKNOWN_ROOM:
            self._memory.describe_node(node_id, room_type=room_type)

    def frontier_points_of(self, node_id: int, map_view: MapView) -> NDArray[np.float64]:
        """S_node (Section III-E): (N, 3) frontier points within r_topo of a node of this floor."""
        node = self._memory.node(node_id)
        if node.floor != map_view.floor:
            return np.empty((0, 3))
        offset = map_view.frontiers[:, :2] - np.asarray(node.position)
        near = np.hypot(offset[:, 0], offset[:, 1]) < self._config.r_topo
        return np.asarray(map_view.frontiers[near])

    def snapshot(self, current: int) -> MemorySnapshot:
        """The memory as a reasoner sees it from node `current`, without what is ablated."""
        shown = self._config.shown
        nodes = tuple(_hide(node, shown) for node in self._memory.nodes)
        edges, history = self._memory.edges, self._memory.history
        current = self._memory.node(current).id
        text = describe(nodes, edges, current, history, self._config.text, shown)
        return MemorySnapshot(nodes, edges, current, history, text, shown)

    def _mergeable(self, node: NodeView, map_view: MapView) -> NodeView | None:
        """The nearest node with ||n_i - n_j|| < d_merge and no obstacle on L(n_i, n_j)."""
        near = sorted(
            (_distance(node, other), other.id)
            for other in self._memory.nodes
            if other.floor == node.floor and other.id != node.id
        )
        for distance, other_id in near:
            if distance >= self._config.d_merge:
                return None
            other = self._memory.node(other_id)
            if is_clear(map_view.grid, node.position, other.position):
                return other
        return None

    def _update_lengths(self, node: NodeView, map_view: MapView, geodesic: Geodesic | None) -> None:
        """Measure the edges of a node anew, since merging moves it."""
        for edge in self._memory.edges:
            if node.id in (edge.source, edge.target):
                other = edge.target if edge.source == node.id else edge.source
                shortest = self._shortest(
                    self._memory.node(other), node, edge.travelled_m, map_view, geodesic
                )
                self._memory.set_geodesic(edge.source, edge.target, shortest)

    def _shortest(
        self,
        a: NodeView,
        b: NodeView,
        travelled_m: float,
        map_view: MapView,
        geodesic: Geodesic | None,
    ) -> float:
        """Length of the shortest path known between two nodes, metres.

        The travelled path is one, but it led to where the nodes were made: never less than the
        straight line between where they are now.
        """
        straight = _distance(a, b)
        known = max(travelled_m, straight)
        if not a.floor == b.floor == map_view.floor:
            return known
        if geodesic is not None:
            return max(straight, min(known, geodesic(a.position, b.position)))
        return straight if is_clear(map_view.grid, a.position, b.position) else known

    def _observe_surroundings(self, nodes: Sequence[NodeView], map_view: MapView) -> None:
        """Set O_k and f_k from M_obj and M_fro."""
        if not nodes:
            return
        positions = np.array([node.position for node in nodes])
        low = map_view.floor_z - self._config.below_floor_m
        high = map_view.floor_z + self._config.storey_height_m
        found = map_view.objects_near(positions, self._config.r_topo, (low, high))
        frontiers = Neighbourhoods(positions, self._config.r_topo).near(map_view.frontiers).counts
        for node, near, frontier_count in zip(nodes, found, frontiers, strict=True):
            enough = (c for c, o in near.items() if o.points >= self._config.min_object_points)
            self._memory.describe_node(
                node.id, objects=tuple(sorted(enough)), frontier_count=int(frontier_count)
            )


def _distance(a: NodeView, b: NodeView) -> float:
    return float(np.hypot(a.position[0] - b.position[0], a.position[1] - b.position[1]))


def _hide(node: NodeView, shown: frozenset[NodeAttribute]) -> NodeView:
    """The node without its ablated attributes."""
    return NodeView(
        id=node.id,
        position=node.position,
        floor=node.floor,
        objects=node.objects if NodeAttribute.OBJECTS in shown else (),
        room_type=node.room_type if NodeAttribute.ROOM in shown else UNKNOWN_ROOM,
        frontier_count=node.frontier_count if NodeAttribute.FRONTIERS in shown else 0,
        visits=node.visits,
    )
