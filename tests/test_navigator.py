"""The navigator in a small house: phases, decisions, an object that is not there, ablations."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cache
from itertools import pairwise

import numpy as np
import pytest

from small_house import small_config, small_scene
from toponav.config import NavigatorConfig
from toponav.control.locomotion import Locomotion
from toponav.envs.simulator import HouseEnv
from toponav.mapping.view import FREE, MapView
from toponav.memory.graph import TopologicalMemory
from toponav.navigator import Navigator
from toponav.perception import OracleDetector
from toponav.policy.affordances import Phase
from toponav.policy.decision import Decision
from toponav.reasoning import Guidance, PriorReasoner, Query, Reasoner
from toponav.types import Action, Observation

TOILET, TV = 0, 1
"""The small house's own episodes."""


@dataclass
class Walk:
    """Everything that a navigator did in one episode; a decision listener."""

    actions: list[Action] = field(default_factory=list)
    observations: list[Observation] = field(default_factory=list)
    decisions: list[Decision] = field(default_factory=list)
    closed_with: list[tuple[MapView | None, TopologicalMemory | None]] = field(default_factory=list)
    distance_to_goal: float = math.inf

    def on_decision(self, decision: Decision) -> None:
        self.decisions.append(decision)

    def on_close(self, map_view: MapView | None, memory: TopologicalMemory | None) -> None:
        self.closed_with.append((map_view, memory))

    @property
    def last_view(self) -> MapView:
        view, _ = self.closed_with[-1]
        assert view is not None
        return view


@cache
def small_env() -> HouseEnv:
    return HouseEnv(small_scene(), small_config(max_steps=10_000).env)


def search(
    config: NavigatorConfig,
    episode: int = TV,
    goal: str | None = None,
    max_steps: int = 200,
    reasoner: Reasoner | None = None,
) -> Walk:
    """Look for `goal` from where an episode starts; by default for what the episode asks for."""
    env, own = small_env(), small_scene().episodes[episode]
    walk = Walk()
    agent = Navigator(OracleDetector(env.oracle), reasoner or PriorReasoner(), config, walk)
    env.reset(seed=0, options={"target": own.target, "start": (*own.start, own.yaw)})
    agent.reset(goal or own.target)
    while len(walk.actions) < max_steps:
        observation = env.observe()
        walk.observations.append(observation)
        walk.actions.append(agent.act(observation))
        if walk.actions[-1] is Action.STOP:
            break
        env.step(int(walk.actions[-1]))
    walk.distance_to_goal = env.oracle.distance_to_goal()
    agent.close()
    return walk


@cache
def found(preset: str, episode: int) -> Walk:
    return search(small_config(preset=preset).navigator, episode)


every_search = pytest.mark.parametrize(
    ("preset", "episode"), [("paper", TOILET), ("paper", TV), ("default", TOILET)]
)


@every_search
def test_it_explores_then_approaches_then_stops_at_the_target(preset: str, episode: int) -> None:
    walk = found(preset, episode)
    phases = [decision.phase for decision in walk.decisions]
    assert phases[0] is Phase.EXPLORATION
    assert phases[-1] is Phase.TARGET_ACQUISITION
    assert walk.actions[-1] is Action.STOP
    assert walk.distance_to_goal < 0.1


@every_search
def test_it_starts_with_a_full_panorama(preset: str, episode: int) -> None:
    first = found(preset, episode).decisions[0]
    views = small_config(preset=preset).navigator.panorama.views
    assert len(first.panorama) == views
    assert first.step == views - 1
    assert found(preset, episode).actions[: views - 1] == [Action.TURN_LEFT] * (views - 1)
    turns = [math.remainder(b.bearing - a.bearing, math.tau) for a, b in pairwise(first.panorama)]
    np.testing.assert_allclose(turns, math.tau / views, atol=1e-6)


@every_search
def test_every_decision_is_consistent(preset: str, episode: int) -> None:
    walk = found(preset, episode)
    assert [decision.index for decision in walk.decisions] == list(range(len(walk.decisions)))
    assert all(a.step < b.step for a, b in pairwise(walk.decisions))
    for decision in walk.decisions:
        memory, guidance, view = decision.memory, decision.guidance, decision.map_view
        assert memory is not None
        assert guidance is not None
        ids = {node.id for node in memory.nodes}
        assert guidance.node_id in ids
        assert memory.history[-1] == memory.current in ids
        assert {end for edge in memory.edges for end in (edge.source, edge.target)} <= ids
        assert 0 <= guidance.direction < len(decision.panorama)
        if decision.phase is Phase.TARGET_ACQUISITION:
            assert guidance.target_found
        foot = walk.observations[decision.step].world_from_base.translation
        assert abs(view.floor_z - foot[2]) < 0.1


@every_search
def test_every_waypoint_has_a_way_to_it_and_is_a_safe_point_of_m_nav_where_a_sum_chose_it(
    preset: str, episode: int
) -> None:
    walk = found(preset, episode)
    for decision in walk.decisions:
        waypoint = decision.waypoint
        assert waypoint is not None
        foot = walk.observations[decision.step].world_from_base.translation
        grid = decision.map_view.grid
        assert np.hypot(*(decision.path[0] - foot[:2])) < 2 * grid.resolution
        assert np.hypot(*(decision.path[-1] - waypoint[:2])) < 2 * grid.resolution
        affordances = decision.affordances
        if preset == "default" and affordances is None:
            continue
        assert affordances is not None
        np.testing.assert_array_equal(affordances.points, decision.map_view.navigable.points)
        (row,) = np.flatnonzero((affordances.points == waypoint.astype(np.float32)).all(axis=1))
        assert affordances.safe[row]
        terms = {"dir", "sem"} if decision.phase is Phase.TARGET_ACQUISITION else {
            "dir", "node", "front", "hist"
        }  # fmt: skip
        assert set(affordances.terms) == terms
        assert affordances.total[row] == pytest.approx(
            sum(term[row] for term in affordances.terms.values())
        )


def test_the_first_waypoint_is_the_best_of_those_in_reach() -> None:
    """Nothing has been tried in vain yet: only what cannot be walked to may score higher."""
    walk = found("paper", TV)
    decision = walk.decisions[0]
    affordances = decision.affordances
    assert affordances is not None
    locomotion = Locomotion(small_config().navigator.locomotion)
    for observation in walk.observations[: decision.step + 1]:
        locomotion.observe(observation)
    reach = locomotion.reach(walk.observations[decision.step], decision.map_view.grid)
    reachable = np.isfinite(reach.at(affordances.points[:, :2]))
    best = np.argmax(np.where(affordances.safe & reachable, affordances.total, -1.0))
    np.testing.assert_array_equal(decision.waypoint, affordances.points[best])


def test_without_the_object_it_searches_all_there_is_and_never_claims_it() -> None:
    walk = search(small_config().navigator, goal="piano", max_steps=450)
    assert {decision.phase for decision in walk.decisions} == {Phase.EXPLORATION}
    assert not any(d.guidance.target_found for d in walk.decisions if d.guidance is not None)
    view = walk.last_view
    mapped = float((view.grid.cells == FREE).sum()) * view.grid.resolution**2
    rng = np.random.default_rng(0)
    places = np.array([small_env().surface.random_point(rng) for _ in range(200)])
    index = view.grid.index_of(places[:, :2])
    inside = view.grid.contains(index)
    known = view.grid.cells[tuple(index[inside].T)] == FREE
    assert mapped > 10.0
    assert known.sum() / len(places) > 0.8
    assert len(walk.actions) == 450 or walk.actions[-1] is Action.STOP


def test_the_listener_gets_the_last_map_and_memory() -> None:
    walk = found("paper", TV)
    ((view, memory),) = walk.closed_with
    assert view is not None
    assert memory is not None
    assert walk.decisions[-1].memory is not None
    assert {node.id for node in walk.decisions[-1].memory.nodes} == {n.id for n in memory.nodes}
    assert "tv_monitor" in view.objects


def test_an_agent_that_saw_nothing_closes_without_a_map() -> None:
    walk = Walk()
    agent = Navigator(OracleDetector(small_env().oracle), PriorReasoner(), listener=walk)
    agent.close()
    ((view, memory),) = walk.closed_with
    assert view is None
    assert memory is not None
    assert not memory.nodes


def shows(word: str, decision: Decision) -> bool:
    """Whether any node that the reasoner saw had the attribute."""
    assert decision.memory is not None
    nodes = decision.memory.nodes
    return {
        "rooms": any(node.room_type != "unknown" for node in nodes),
        "objects": any(node.objects for node in nodes),
        "frontiers": any(node.frontier_count > 0 for node in nodes),
    }[word]


@pytest.mark.parametrize("word", ["rooms", "objects", "frontiers"])
def test_an_ablated_attribute_is_hidden_from_the_reasoner(word: str) -> None:
    overrides = {f"navigator.memory.include_{word}": "false"}
    ablated = search(small_config(overrides=overrides).navigator, TOILET)
    full, less = found("paper", TOILET).decisions, ablated.decisions
    assert full[1].memory is not None
    assert less[1].memory is not None
    assert full[1].memory.text != less[1].memory.text
    assert any(shows(word, decision) for decision in full)
    assert not any(shows(word, decision) for decision in less)


@pytest.mark.parametrize("term", ["dir", "node", "front", "hist"])
def test_an_affordance_without_weight_does_not_count(term: str) -> None:
    overrides = {f"navigator.affordances.weight_{term}": "0"}
    first = search(small_config(overrides=overrides).navigator, max_steps=12).decisions[0]
    affordances = first.affordances
    assert affordances is not None
    counted = sum(value for name, value in affordances.terms.items() if name != term)
    np.testing.assert_allclose(affordances.total, np.where(affordances.safe, counted, 0.0))
    assert affordances.terms[term].any()


def test_goals_are_taken_by_any_of_their_names() -> None:
    by_name = search(small_config().navigator, TV, goal="TV monitor", max_steps=30)
    assert by_name.actions == found("paper", TV).actions[:30]


def late_by(latency_s: float, preset: str = "paper") -> NavigatorConfig:
    """Answers come so long after the question, while the agent walks on; a step takes a second."""
    overrides = {
        "navigator.counsel.mode": "simulated",
        "navigator.counsel.latency_s": str(latency_s),
    }
    return small_config(preset=preset, overrides=overrides).navigator


class Denier(PriorReasoner):
    """Has never seen the target."""

    def decide(self, query: Query) -> Guidance:
        return super().decide(query).model_copy(update={"target_found": False, "reason": "no"})


@every_search
def test_late_answers_that_agree_with_the_stand_in_change_nothing(
    preset: str, episode: int
) -> None:
    late = search(late_by(8.0, preset), episode)
    waits = len(late.actions) - len(found(preset, episode).actions)
    assert 0 <= waits <= 8  # before the stop alone
    assert late.actions[: -waits - 1] == found(preset, episode).actions[:-1]
    assert late.actions[-1] is Action.STOP


def test_an_answer_that_comes_at_once_changes_nothing() -> None:
    assert search(late_by(0.0), TV).actions == found("paper", TV).actions


def test_it_does_not_stop_before_the_reasoner_has_had_its_say() -> None:
    walk = search(late_by(40.0), TV, reasoner=Denier(), max_steps=400)
    assert Action.STOP not in walk.actions
    said = [decision.guidance.reason for decision in walk.decisions if decision.guidance]
    assert "no" in said
    phases = {decision.phase for decision in walk.decisions}
    assert phases == {Phase.EXPLORATION, Phase.TARGET_ACQUISITION}  # the stand-in's, taken back


def test_an_answer_to_a_question_that_is_over_is_not_heard() -> None:
    walk = search(late_by(1000.0), TV, reasoner=Denier(), max_steps=120)
    assert all(decision.guidance.reason != "no" for decision in walk.decisions if decision.guidance)
