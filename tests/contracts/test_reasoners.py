"""What every registered reasoner owes its caller."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from chat_server import chat_server
from toponav.categories import DEFAULT_VOCABULARY
from toponav.memory.graph import TopologicalMemory
from toponav.memory.snapshot import EdgeView, MemorySnapshot, NodeView
from toponav.memory.text import TextBudget, describe
from toponav.perception.sightings import SightLog
from toponav.reasoning import (
    Guidance,
    PanoramaView,
    Query,
    ReasonerContext,
    ReasoningConfig,
    SeenObject,
    VlmConfig,
    reasoners,
)
from true_frames import Truth, true_frame

IMAGE = np.zeros((4, 4, 3), np.uint8)
labels = st.one_of(st.sampled_from(DEFAULT_VOCABULARY), st.text(max_size=12))
rooms = st.one_of(st.sampled_from(["unknown", "bedroom", "Kitchen"]), st.text(max_size=12))
coordinate = st.floats(-30.0, 30.0)


@st.composite
def snapshots(draw: st.DrawFn) -> MemorySnapshot:
    ids = sorted(draw(st.sets(st.integers(1, 500), min_size=1, max_size=8)))
    history = draw(st.lists(st.sampled_from(ids), min_size=1, max_size=12))
    nodes = tuple(
        NodeView(
            id=node_id,
            position=(draw(coordinate), draw(coordinate)),
            floor=draw(st.integers(-1, 2)),
            objects=tuple(sorted(draw(st.sets(labels, max_size=5)))),
            room_type=draw(rooms),
            frontier_count=draw(st.integers(0, 300)),
            visits=history.count(node_id),
        )
        for node_id in ids
    )
    pairs = [(a, b) for a in ids for b in ids if a < b]
    joined = draw(st.sets(st.sampled_from(pairs), max_size=10)) if pairs else set()
    length = st.floats(0.0, 40.0)
    edges = tuple(EdgeView(a, b, draw(length), draw(length)) for a, b in sorted(joined))
    memory = TopologicalMemory.from_parts(nodes, edges, history, ids[-1] + 1)
    text = describe(memory.nodes, memory.edges, history[-1], history, TextBudget())
    return MemorySnapshot(memory.nodes, memory.edges, history[-1], memory.history, text)


sightings = st.builds(
    SeenObject,
    label=labels,
    score=st.floats(0.0, 1.0),
    range_m=st.one_of(st.floats(0.0, 5.0), st.just(math.inf)),
)
views = st.builds(
    PanoramaView,
    image=st.just(IMAGE),
    bearing=st.floats(-math.pi, math.pi),
    seen=st.lists(sightings, max_size=5).map(tuple),
    navigable_area_m2=st.floats(0.0, 30.0),
    frontier_count=st.integers(0, 300),
)
queries = st.builds(
    Query,
    target=labels,
    memory=snapshots(),
    panorama=st.lists(views, min_size=1, max_size=12).map(tuple),
)


def first_allowed(body: dict[str, Any]) -> str:
    """What a server answers that knows the schema and nothing else."""
    properties = body["response_format"]["json_schema"]["schema"]["properties"]
    plain = {"string": "hall", "boolean": False, "integer": 0, "array": []}
    return json.dumps(
        {key: field.get("enum", [plain[field["type"]]])[0] for key, field in properties.items()}
    )


@pytest.fixture(scope="module")
def configured() -> Iterator[ReasoningConfig]:
    """Every reasoner in working order; a model's server is a real one."""
    with chat_server(first_allowed) as server:
        yield ReasoningConfig(openai=VlmConfig(base_url=server.url))


@pytest.mark.parametrize("name", reasoners.names())
@given(query=queries)
@settings(max_examples=60)
def test_answers_are_valid_and_repeatable(
    configured: ReasoningConfig, name: str, query: Query
) -> None:
    sights = SightLog(Truth(true_frame([[0]], ["chair"])))
    context = ReasonerContext(configured, sights, seed=3)
    reasoner = reasoners.get(name)(context)
    sights.look(IMAGE)
    guidance = reasoner.decide(query)
    assert isinstance(guidance, Guidance)
    assert guidance.node_id in {node.id for node in query.memory.nodes}
    assert 0 <= guidance.direction < len(query.panorama)
    assert guidance.room_type.strip()
    assert len(guidance.reason.splitlines()) <= 1
    assert reasoner.decide(query) == guidance
    assert reasoners.get(name)(context).decide(query) == guidance


def test_the_offline_reasoner_is_registered() -> None:
    assert "prior" in reasoners.names()
