"""VoroNav: decisions at nodes, towards what is unexplored, not visited and promising."""

from __future__ import annotations

import numpy as np
from searches import Blind, Log, named, search
from words import Words

from drawn_map import clusters_from, detections_of, drawn_map, observation_at, reach_from
from small_house import small_config
from toponav.baselines.voronav import VoroNavAgent, exploratory_nodes
from toponav.baselines.voronoi_graph import voronoi_graph
from toponav.mapping.view import FREE, MapView
from toponav.types import Action

TURNS = [Action.TURN_LEFT] * 12
BOTH = drawn_map(
    "###################",
    " ................. ",
    " ................. ",
    "###################",
    enlarged=5,
)
"""A corridor of 9 m with a way out at either end."""
LEFT = drawn_map(
    "###################",
    " .................#",
    " .................#",
    "###################",
    enlarged=5,
)
"""The same, but closed on the right."""


def agent(words: dict[str, float] | None = None) -> VoroNavAgent:
    made = VoroNavAgent(Blind(), Words(words or {}), small_config().navigator, Log())
    made.reset("sofa")
    return made


def choose(searching: VoroNavAgent, view: MapView, x: float) -> float:
    """x of the waypoint chosen from (x, 1.0)."""
    here = (x, 1.0)
    clusters, reach = clusters_from(view, here), reach_from(view, here)
    return float(searching._choose(clusters, reach, observation_at(*here), view)[0])


def test_nodes_beside_a_frontier_are_exploratory() -> None:
    graph = voronoi_graph(LEFT.grid.cells == FREE, LEFT.grid, 0.5)
    nodes = exploratory_nodes(graph, clusters_from(LEFT, (5.0, 1.0)))
    assert nodes
    assert graph.nodes[list(nodes), 0].max() <= 2.1
    assert graph.nodes[:, 0].max() > 8.0


def test_it_goes_where_the_frontier_is() -> None:
    assert choose(agent(), LEFT, 8.5) < 4.0


def test_an_unvisited_node_is_preferred() -> None:
    searching = agent()
    assert choose(searching, BOTH, 1.0) > 5.0


def test_objects_that_speak_for_the_target_decide() -> None:
    for seen_at, label, left in ((-1.3, "rug", True), (6.2, "rug", False)):
        searching = agent({label: 0.9})
        seen = detections_of({label: (18, 13, 22, 17)}, [1.0])
        searching._perceive(observation_at(seen_at, 1.0), seen, BOTH)
        likelihood = searching._likelihood(np.array([[0.7, 1.0], [8.2, 1.0]]), BOTH.floor)
        np.testing.assert_allclose(likelihood, [1.0, 0.0] if left else [0.0, 1.0])


def test_without_any_object_all_neighbours_are_alike() -> None:
    np.testing.assert_allclose(agent()._likelihood(np.zeros((4, 2)), 0), np.full(4, 0.25))


def test_it_turns_round_at_every_node_finds_the_target_and_stops() -> None:
    log = search(named("voronav"), max_steps=500)
    assert log.actions[:12] == TURNS
    assert log.actions[-1] is Action.STOP
    assert log.distance_to_goal <= 0.1


def test_it_stops_once_no_frontier_is_left() -> None:
    log = search(named("voronav"), goal="piano", max_steps=800)
    assert log.actions[-1] is Action.STOP
