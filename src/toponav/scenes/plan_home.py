"""A whole home from room boxes and their connections: storeys, passages and stairs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import networkx as nx
import numpy as np

from toponav.scenes.plan_grid import FREE, CellMask, PlanGrid
from toponav.scenes.plan_passages import HALLWAY, PassageBuilder, room_types
from toponav.scenes.plan_rooms import RoomBox, plan_rooms
from toponav.scenes.plan_routes import SharedWall, longest_shared_wall
from toponav.scenes.plan_stairs import Flight, StairEnd, cells_around, place_flight
from toponav.scenes.plan_storeys import Storey, find_storeys

STAIRWELL_REACH_M = 1.0
"""A box that reaches this far into another storey is open to it: a stairwell."""

PRIVATE_TYPES = frozenset({"bedroom", "bathroom", "toilet", "closet"})
"""Stairs start in these as a last resort, unless the room graph says so."""

PRIVATE_PENALTY = 100
"""How many rooms farther away a private room counts as."""

_MAX_STAIR_ROOMS = 60
"""Pairs of rooms in which a place for a flight is sought."""


@dataclass(frozen=True)
class Passage:
    """An opening to be: two rooms, the wall that they share, "door" or "open"."""

    rooms: tuple[int, int]
    wall: SharedWall
    kind: str


@dataclass(frozen=True, eq=False)
class StoreyPlan:
    """One storey.

    Attributes:
        floor: Height in metres.
        grid: Which room owns which cell.
        labels: Type of each room by key, corridors included.
        passages: The openings.
        taken: (nx, ny) cells of flights and their landings.
    """

    floor: float
    grid: PlanGrid
    labels: dict[int, str]
    passages: list[Passage]
    taken: CellMask

    def stair_end(self, key: int) -> StairEnd:
        """A room of this storey as one end of a flight."""
        walls = [passage.wall for passage in self.passages if key in passage.rooms]
        return StairEnd(self.grid, key, walls, self.taken)

    def occupy(self, key: int, cells: CellMask, landing: CellMask) -> None:
        """Enter a flight that belongs to a room."""
        self.grid.owner[cells & (self.grid.owner == FREE)] = key
        self.taken[cells | landing] = True


@dataclass(frozen=True, eq=False)
class HomePlan:
    """All storeys, the lowest first, and the flights between them.

    Attributes:
        storeys: The storeys; keys of rooms are unique over all of them.
        flights: (index of the lower storey, flight up to the next one).
    """

    storeys: list[StoreyPlan]
    flights: list[tuple[int, Flight]] = field(default_factory=list)


class HomePlanner:
    """Plans storeys one by one, then joins them.

    Attributes:
        plan: What has been planned so far.
    """

    def __init__(
        self,
        boxes: Sequence[RoomBox],
        spans: Mapping[int, tuple[float, float]],
        connections: Sequence[tuple[int, int]],
    ) -> None:
        """Plan a home.

        Args:
            boxes: Footprints of the rooms, at least one.
            spans: Heights of the lower and the upper face of each room's box, metres, by key.
            connections: Pairs of rooms that connect.
        """
        self._boxes = boxes
        self._spans = spans
        self._absorbers: dict[int, int] = {}
        self._next_key = max(item.key for item in boxes) + 1
        storeys = find_storeys(boxes, spans, connections)
        self.plan = HomePlan([self._plan_storey(storey, connections) for storey in storeys])
        self._level = {
            key: index for index, storey in enumerate(self.plan.storeys) for key in storey.labels
        }
        self._graph = self._room_graph()
        self._add_stairs(connections)

    def largest_connected_part(self, unwanted_label: str) -> set[int]:
        """Keys of the connected rooms with the largest floor, not counting one kind of room."""
        areas = {
            key: 0 if label == unwanted_label else int(storey.grid.mask(key).sum())
            for storey in self.plan.storeys
            for key, label in storey.labels.items()
        }
        parts = sorted(nx.connected_components(self._graph), key=min)
        return set(max(parts, key=lambda part: sum(areas[key] for key in part)))

    def _plan_storey(self, storey: Storey, connections: Sequence[tuple[int, int]]) -> StoreyPlan:
        boxes = [item for item in self._boxes if item.key in storey.rooms]
        grid, absorbers = plan_rooms(boxes, self._boxes)
        self._absorbers.update(absorbers)
        labels = {item.key: item.label for item in boxes if grid.mask(item.key).any()}
        builder = PassageBuilder(grid, labels, self._next_key)
        pairs = dict.fromkeys(self._kept(pair) for pair in connections)
        builder.connect([(a, b) for a, b in pairs if a in labels and b in labels and a != b])
        self._next_key = max(self._next_key, *(key + 1 for key in builder.labels))
        passages = [Passage(*opening) for opening in builder.openings()]
        taken = np.zeros(grid.owner.shape, np.bool_)
        return StoreyPlan(storey.floor, grid, builder.labels, passages, taken)

    def _kept(self, pair: tuple[int, int]) -> tuple[int, int]:
        """The pair, with rooms that vanished replaced by those that cover them."""
        a, b = (self._absorbers.get(key, key) for key in pair)
        return min(a, b), max(a, b)

    def _room_graph(self) -> nx.Graph[int]:
        graph: nx.Graph[int] = nx.Graph()
        for storey in self.plan.storeys:
            graph.add_nodes_from(storey.labels)
            graph.add_edges_from(passage.rooms for passage in storey.passages)
        return graph

    def _add_stairs(self, connections: Sequence[tuple[int, int]]) -> None:
        """Join the storeys at each connection between them, unless another flight serves it."""
        for a, b in self._connections_upward(connections):
            if not nx.has_path(self._graph, a, b) and not self._build_flight_near(a, b):
                self._join_beside_flight(a, b)

    def _connections_upward(self, connections: Sequence[tuple[int, int]]) -> list[tuple[int, int]]:
        """Pairs (room, room on the next storey): those given by hallways first, then implied."""
        given = []
        for a, b in dict.fromkeys(self._kept(pair) for pair in connections):
            if a in self._level and b in self._level:
                low, high = sorted((a, b), key=lambda key: self._level[key])
                if self._level[high] - self._level[low] == 1:
                    given.append((low, high))
        given.sort(key=lambda pair: (-self._hallways(pair), pair))
        return given + self._stairwells()

    def _stairwells(self) -> list[tuple[int, int]]:
        """Rooms whose boxes reach into a neighbouring storey, with a room there, upward."""
        pairs = []
        for key, index in self._level.items():
            low, high = self._spans.get(key, (np.inf, -np.inf))
            for other in (index - 1, index + 1):
                if not 0 <= other < len(self.plan.storeys):
                    continue
                upper_floor = self.plan.storeys[max(index, other)].floor
                reach = high - upper_floor if other > index else upper_floor - low
                beside = self._most_overlapped(key, other)
                if reach >= STAIRWELL_REACH_M and beside is not None:
                    pairs.append((key, beside) if other > index else (beside, key))
        return pairs

    def _most_overlapped(self, key: int, storey_index: int) -> int | None:
        """The room of another storey that a room overlaps in plan, preferably a hallway."""
        storey = self.plan.storeys[storey_index]
        shape = self.plan.storeys[self._level[key]].grid.mask(key)
        ranks = [
            (HALLWAY in room_types(label), int((shape & storey.grid.mask(other)).sum()), -other)
            for other, label in storey.labels.items()
        ]
        ranks = [rank for rank in ranks if rank[1] > 0]
        return -max(ranks)[2] if ranks else None

    def _hallways(self, pair: tuple[int, int]) -> int:
        return sum(HALLWAY in room_types(self._label(key)) for key in pair)

    def _label(self, key: int) -> str:
        return self.plan.storeys[self._level[key]].labels[key]

    def _build_flight_near(self, a: int, b: int) -> bool:
        """Build a flight between two rooms, or between others as near to them as can be."""
        feet, heads = self._hops(a), self._hops(b)
        pairs = sorted((feet[foot] + heads[head], foot, head) for foot in feet for head in heads)
        return any(self._build_flight(foot, head) for _, foot, head in pairs[:_MAX_STAIR_ROOMS])

    def _hops(self, start: int) -> dict[int, int]:
        """Rooms of a storey that can be reached from one, with their distance in rooms."""
        storey = [key for key, level in self._level.items() if level == self._level[start]]
        hops: dict[int, int] = nx.single_source_shortest_path_length(
            self._graph.subgraph(storey), start
        )
        return {
            key: count + PRIVATE_PENALTY
            if count and PRIVATE_TYPES & set(room_types(self._label(key)))
            else count
            for key, count in hops.items()
        }

    def _build_flight(self, foot: int, head: int) -> bool:
        index = self._level[foot]
        lower, upper = self.plan.storeys[index : index + 2]
        flight = place_flight(
            lower.stair_end(foot), upper.stair_end(head), upper.floor - lower.floor
        )
        if flight is None:
            return False
        lower.occupy(foot, flight.cells, flight.foot)
        upper.occupy(head, flight.cells, flight.head)
        self.plan.flights.append((index, flight))
        self._graph.add_edge(foot, head)
        return True

    def _join_beside_flight(self, a: int, b: int) -> None:
        """Where a second flight has no place, lead room a to the foot, or b to the head, of one."""
        for far, near in ((b, a), (a, b)):
            storey = self.plan.storeys[self._level[near]]
            for other in storey.labels:
                if nx.has_path(self._graph, far, other):
                    wall = longest_shared_wall(storey.grid, near, other)
                    if (
                        wall is not None
                        and not (storey.taken & cells_around(wall, storey.taken.shape)).any()
                    ):
                        storey.passages.append(Passage((near, other), wall, "door"))
                        self._graph.add_edge(near, other)
                        return
