"""A whole home from room boxes and their connections: storeys, passages and stairs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import networkx as nx
import numpy as np

from toponav.scenes.plan_grid import FREE, CellMask, PlanGrid
from toponav.scenes.plan_passages import HALLWAY, PassageBuilder, room_types
from toponav.scenes.plan_rooms import RoomBox, plan_rooms
from toponav.scenes.plan_routes import SharedWall
from toponav.scenes.plan_stairs import Flight, StairEnd, place_flight
from toponav.scenes.plan_storeys import Storey, find_storeys


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
    passages: tuple[Passage, ...]
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
        self._absorbers: dict[int, int] = {}
        self._next_key = max(item.key for item in boxes) + 1
        storeys = find_storeys(boxes, spans, connections)
        self.plan = HomePlan([self._plan_storey(storey, connections) for storey in storeys])
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
        passages = tuple(Passage(*opening) for opening in builder.openings())
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
        """Build a flight for each connection between storeys, unless another one serves it."""
        level = {
            key: index for index, storey in enumerate(self.plan.storeys) for key in storey.labels
        }
        pairs = [self._kept(pair) for pair in connections]
        between = [
            (a, b) if level[a] < level[b] else (b, a)
            for a, b in dict.fromkeys(pairs)
            if a in level and b in level and abs(level[a] - level[b]) == 1
        ]
        for a, b in sorted(between, key=lambda pair: (-self._hallways(pair, level), pair)):
            for foot, head in self._stair_rooms(a, b, level):
                if nx.has_path(self._graph, a, b) or self._build_flight(foot, head, level[a]):
                    break

    def _hallways(self, pair: tuple[int, int], level: Mapping[int, int]) -> int:
        labels = [self.plan.storeys[level[key]].labels[key] for key in pair]
        return sum(HALLWAY in room_types(label) for label in labels)

    def _stair_rooms(self, a: int, b: int, level: Mapping[int, int]) -> Iterator[tuple[int, int]]:
        """The pair itself, then with either and both rooms replaced by a neighbour."""
        near_a, near_b = (
            [key, *sorted(n for n in self._graph[key] if level[n] == level[key])] for key in (a, b)
        )
        places = [(i + j, i, j) for i in range(len(near_a)) for j in range(len(near_b))]
        for _, i, j in sorted(places, key=lambda place: ((place[1] > 0) + (place[2] > 0), place)):
            yield near_a[i], near_b[j]

    def _build_flight(self, foot: int, head: int, lower_index: int) -> bool:
        lower, upper = self.plan.storeys[lower_index : lower_index + 2]
        flight = place_flight(
            lower.stair_end(foot), upper.stair_end(head), upper.floor - lower.floor
        )
        if flight is None:
            return False
        lower.occupy(foot, flight.cells, flight.foot)
        upper.occupy(head, flight.hole, flight.head)
        self.plan.flights.append((lower_index, flight))
        self._graph.add_edge(foot, head)
        return True
