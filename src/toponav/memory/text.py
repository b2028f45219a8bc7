"""The topological memory as text: what a language model, or a person, reads (Section III-D)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from pydantic import Field

from toponav.categories import readable
from toponav.config_model import ConfigModel
from toponav.memory.graph import path_lengths
from toponav.memory.snapshot import (
    ALL_ATTRIBUTES,
    UNKNOWN_ROOM,
    EdgeView,
    MemorySnapshot,
    NodeAttribute,
    NodeView,
)

MAX_NAME_LENGTH = 32
"""Longer names of objects and rooms, which come from outside, are cut."""


class TextBudget(ConfigModel):
    """How long the memory's text may get; 200 places must not drown a model's context."""

    max_nodes: int = Field(default=40, ge=1)
    """Places described; the rest is counted."""

    max_characters: int = Field(default=6000, ge=1500)
    """Length of the whole text: about 1500 tokens."""

    max_objects: int = Field(default=16, ge=1, le=16)
    """Objects named per place."""

    max_neighbours: int = Field(default=6, ge=1, le=12)
    """Connections named per place, shortest first."""

    max_history: int = Field(default=20, ge=1, le=40)
    """Last arrivals listed."""


@dataclass(frozen=True)
class MemoryText:
    """A memory in words.

    Attributes:
        text: One line a place.
        told: Ids of the places that it tells of, ascending.
        omitted: How many it leaves out.
    """

    text: str
    told: tuple[int, ...]
    omitted: int


def retell(snapshot: MemorySnapshot, budget: TextBudget) -> MemoryText:
    """A snapshot in words, by another budget than that of its own text; see `describe`."""
    parts = (snapshot.nodes, snapshot.edges, snapshot.current, snapshot.history)
    return _tell(*parts, budget, snapshot.shown)


def describe(
    nodes: Sequence[NodeView],
    edges: Sequence[EdgeView],
    current: int,
    history: Sequence[int],
    budget: TextBudget,
    shown: frozenset[NodeAttribute] = ALL_ATTRIBUTES,
) -> str:
    """The memory in words, one line a place, never longer than the budget.

    When places must be omitted, these stay, in this order: the current place, its neighbours,
    places with frontiers (most first), then the most recently visited.

    Args:
        nodes: Places by ascending id.
        edges: Their connections.
        current: Id of the place where the agent stands.
        history: H, oldest first.
        budget: Limits.
        shown: Attributes to mention; the others are ablated (Table III).
    """
    return _tell(nodes, edges, current, history, budget, shown).text


def _tell(
    nodes: Sequence[NodeView],
    edges: Sequence[EdgeView],
    current: int,
    history: Sequence[int],
    budget: TextBudget,
    shown: frozenset[NodeAttribute],
) -> MemoryText:
    floors = len({node.floor for node in nodes})
    places = _Places(
        links=_links_by_node(edges),
        away_m=path_lengths(edges, current),
        current=current,
        budget=budget,
        shown=shown,
        several_floors=floors > 1,
    )
    order = _by_importance(nodes, places.links.get(current, []), current, history)
    order = order[: budget.max_nodes]
    lines = {node.id: places.line(node) for node in nodes if node.id in order}
    head = f"Topological memory: {_count(len(nodes), 'place')}"
    head += f" on {floors} floors" if floors > 1 else ""
    head += f"; the robot is at place {current}."
    route = _route(history, budget)
    for kept in range(len(order), 0, -1):
        parts = [head, *(lines[node_id] for node_id in sorted(order[:kept]))]
        if kept < len(nodes):
            parts.append(f"{_count(len(nodes) - kept, 'further place')} omitted.")
        text = "\n".join([*parts, route])
        if len(text) <= budget.max_characters:
            break
    return MemoryText(text, tuple(sorted(order[:kept])), len(nodes) - kept)


def clean_name(name: str) -> str:
    """A name fit for one line of text: printable, single-spaced, of bounded length."""
    printable = "".join(c if c.isprintable() else " " for c in readable(name))
    text = " ".join(printable.split())
    return text if len(text) <= MAX_NAME_LENGTH else text[: MAX_NAME_LENGTH - 3].rstrip() + "..."


@dataclass(frozen=True)
class _Places:
    """What the line of every place needs to know.

    Attributes:
        links: Neighbours of each node as (length in metres, id), shortest first.
        away_m: Length of the path from the current node, where there is one.
        current: Id of the current node.
        budget: Limits.
        shown: Attributes to mention.
        several_floors: Whether floors need telling apart.
    """

    links: dict[int, list[tuple[float, int]]]
    away_m: dict[int, float]
    current: int
    budget: TextBudget
    shown: frozenset[NodeAttribute]
    several_floors: bool

    def line(self, node: NodeView) -> str:
        facts = [f"at ({_decimal(node.position[0])}, {_decimal(node.position[1])})"]
        if self.several_floors:
            facts.append(f"floor {node.floor}")
        if NodeAttribute.ROOM in self.shown:
            known = node.room_type != UNKNOWN_ROOM
            facts.append(clean_name(node.room_type) if known else "room unknown")
        if NodeAttribute.OBJECTS in self.shown:
            facts.append(f"objects: {_objects(node.objects, self.budget.max_objects)}")
        if NodeAttribute.FRONTIERS in self.shown:
            facts.append(f"frontiers: {node.frontier_count}")
        facts.append(f"visits: {node.visits}")
        links = self.links.get(node.id, [])[: self.budget.max_neighbours]
        if links:
            facts.append("leads to " + ", ".join(f"{i} ({length:.1f} m)" for length, i in links))
        return f"- place {node.id} ({self._distance(node.id)}): " + "; ".join(facts)

    def _distance(self, node_id: int) -> str:
        if node_id == self.current:
            return "here"
        if node_id not in self.away_m:
            return "no known path"
        return f"{self.away_m[node_id]:.1f} m away"


def _links_by_node(edges: Sequence[EdgeView]) -> dict[int, list[tuple[float, int]]]:
    links: dict[int, list[tuple[float, int]]] = {}
    for edge in edges:
        links.setdefault(edge.source, []).append((edge.geodesic_m, edge.target))
        links.setdefault(edge.target, []).append((edge.geodesic_m, edge.source))
    return {node_id: sorted(found) for node_id, found in links.items()}


def _by_importance(
    nodes: Sequence[NodeView],
    current_links: Sequence[tuple[float, int]],
    current: int,
    history: Sequence[int],
) -> list[int]:
    beside = {node_id for _, node_id in current_links}
    last_arrival = {node_id: index for index, node_id in enumerate(history)}

    def rank(node: NodeView) -> tuple[bool, bool, int, int, int]:
        return (
            node.id != current,
            node.id not in beside,
            -node.frontier_count,
            -last_arrival.get(node.id, -1),
            node.id,
        )

    return [node.id for node in sorted(nodes, key=rank)]


def _count(number: int, noun: str) -> str:
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"


def _decimal(value: float) -> str:
    """One decimal, without the sign of a negative zero."""
    return f"{round(value, 1) + 0.0:.1f}"


def _objects(objects: Sequence[str], limit: int) -> str:
    if not objects:
        return "none seen"
    names = ", ".join(clean_name(name) for name in objects[:limit])
    more = len(objects) - limit
    return f"{names} and {more} more" if more > 0 else names


def _route(history: Sequence[int], budget: TextBudget) -> str:
    if not history:
        return "Route so far: none."
    recent = [str(node_id) for node_id in history[-budget.max_history :]]
    earlier = ["..."] if len(history) > budget.max_history else []
    return f"Route so far: {' > '.join([*earlier, *recent])}."
