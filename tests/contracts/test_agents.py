"""One conformance test over every registered method."""

from __future__ import annotations

import pytest

from toponav.config import preset
from toponav.envs.simulator import HouseEnv, HouseEnvConfig
from toponav.methods import AgentContext, methods
from toponav.perception import detectors
from toponav.policy.decision import Decision
from toponav.reasoning import reasoners
from toponav.scenes.generate import generate_house
from toponav.scenes.meshing import build_scene
from toponav.types import Action, Agent

STEPS = 40


@pytest.fixture(scope="module")
def env() -> HouseEnv:
    return HouseEnv(build_scene(generate_house(6)), HouseEnvConfig(width=96, height=72))


class Watcher:
    def __init__(self) -> None:
        self.decisions: list[Decision] = []
        self.closed = 0

    def on_decision(self, decision: Decision) -> None:
        self.decisions.append(decision)

    def on_close(self, map_view: object, memory: object) -> None:
        del map_view, memory
        self.closed += 1


def build(name: str, env: HouseEnv, watcher: Watcher) -> Agent:
    return methods.get(name)(
        AgentContext(
            detector=detectors.get("oracle")(env.oracle, 0),
            reasoner=reasoners.get("prior")(),
            config=preset("paper"),
            seed=3,
            listener=watcher,
        )
    )


def walk(agent: Agent, env: HouseEnv, target: str) -> list[Action]:
    env.reset(seed=1, options={"target": target})
    agent.reset(target)
    actions = []
    for _ in range(STEPS):
        actions.append(agent.act(env.observe()))
        if actions[-1] is Action.STOP:
            break
        env.step(actions[-1])
    return actions


@pytest.mark.parametrize("name", methods.names())
def test_a_method_is_an_agent(name: str, env: HouseEnv) -> None:
    watcher = Watcher()
    agent = build(name, env, watcher)
    assert isinstance(agent, Agent)
    first = walk(agent, env, "sofa")
    assert all(isinstance(action, Action) for action in first)
    assert Action.MOVE_FORWARD in first
    indices = [decision.index for decision in watcher.decisions]
    assert indices == list(range(len(indices)))
    # A reset forgets everything: the same observations give the same actions.
    assert walk(agent, env, "sofa") == first
    assert walk(build(name, env, Watcher()), env, "sofa") == first
    agent.close()
    assert watcher.closed == 1


@pytest.mark.parametrize("name", methods.names())
def test_an_agent_that_is_closed_before_it_acts_does_not_mind(name: str, env: HouseEnv) -> None:
    agent = build(name, env, Watcher())
    agent.reset("bed")
    agent.close()


def test_the_navigators_decisions_are_consistent(env: HouseEnv) -> None:
    watcher = Watcher()
    walk(build("toponav", env, watcher), env, "sofa")
    assert watcher.decisions
    for decision in watcher.decisions:
        assert decision.memory is not None
        assert decision.guidance is not None
        assert decision.guidance.node_id in {node.id for node in decision.memory.nodes}
        assert 0 <= decision.guidance.direction < len(decision.panorama) == 12
        assert decision.affordances is not None
        assert decision.waypoint is not None
        on_map = (decision.affordances.points == decision.waypoint.astype("float32")).all(axis=1)
        assert on_map.any()
        assert decision.affordances.safe[on_map].all()
