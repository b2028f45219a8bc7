"""What `import toponav` offers."""

from __future__ import annotations

from importlib import import_module

import pytest

import toponav
from toponav import (
    Action,
    Agent,
    HouseEnv,
    HouseEnvConfig,
    Navigator,
    OracleDetector,
    PriorReasoner,
    load_scene,
    preset,
)


@pytest.mark.parametrize("name", toponav.__all__)
def test_every_public_name_is_the_one_of_its_module(name: str) -> None:
    public = getattr(toponav, name)
    assert public.__doc__
    assert getattr(import_module(public.__module__), name) is public


def test_the_names_are_listed_and_no_others_exist() -> None:
    assert set(dir(toponav)) == {*toponav.__all__, "__version__"}
    assert toponav.__all__ == sorted(toponav.__all__)
    with pytest.raises(AttributeError, match="nonsense"):
        _ = toponav.nonsense


def test_a_search_written_with_public_names_alone() -> None:
    env = HouseEnv(load_scene("generated:6"), HouseEnvConfig(width=64, height=48))
    agent: Agent = Navigator(OracleDetector(env.oracle), PriorReasoner(), preset("default"))
    env.reset(seed=0, options={"target": "chair"})
    agent.reset("chair")
    first = agent.act(env.observe())
    assert first is Action.TURN_LEFT  # the first panorama
    env.step(first)
    assert isinstance(agent.act(env.observe()), Action)
    agent.close()
