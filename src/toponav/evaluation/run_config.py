"""The configuration of a run: method, perception, reasoner, environment and seed."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from toponav.config import NavigatorConfig, parse_config, preset
from toponav.config_model import ConfigModel
from toponav.envs.simulator import HouseEnvConfig
from toponav.perception import PerceptionConfig
from toponav.perception.config import perception_preset
from toponav.reasoning import ReasoningConfig
from toponav.reasoning.config import reasoning_preset


class RunConfig(ConfigModel):
    """All that determines an episode's actions; saved as `config.json` beside the results."""

    method: str = "toponav"
    """The agent: toponav or a baseline."""

    preset: str = "default"
    """Where the navigator's values came from: paper or default, before any override."""

    detector: str = "oracle"
    """Perception; `oracle` reads the simulator's labels and is named in every result."""

    reasoner: str = "prior"
    """What plays the VLM; `prior` is offline and deterministic."""

    seed: int = Field(default=0, ge=0)
    """Seed of the run; episodes derive theirs from it."""

    revisit: int = Field(default=0, ge=0)
    """Search for so many other objects of the scene first, unscored, and keep what was learnt: a
    track of its own, never to be mixed with cold starts."""

    perception: PerceptionConfig = Field(default_factory=PerceptionConfig)
    """Every parameter of the detectors."""

    reasoning: ReasoningConfig = Field(default_factory=ReasoningConfig)
    """Every parameter of the reasoners."""

    navigator: NavigatorConfig = Field(default_factory=NavigatorConfig)
    """Every parameter of the agent."""

    backend: str = "embedded"
    """What simulates: embedded, or habitat for scenes in Habitat's own files."""

    follower: Literal["map", "oracle"] = "map"
    """How walks are planned: over the agent's own map, or with the simulator's navmesh, which no
    agent of the benchmark may see; the latter is named in every table."""

    env: HouseEnvConfig = Field(default_factory=HouseEnvConfig)
    """The protocol's agent and camera, and the noise models."""


def run_config(
    preset_name: str, method: str = "toponav", seed: int = 0, env: HouseEnvConfig | None = None
) -> RunConfig:
    """The configuration of a preset.

    Raises:
        ConfigError: Unknown preset, or a negative seed.
    """
    values = {
        "method": method,
        "preset": preset_name,
        "seed": seed,
        "navigator": preset(preset_name),
        "perception": perception_preset(preset_name),
        "reasoning": reasoning_preset(preset_name),
        "env": env or HouseEnvConfig(),
    }
    return parse_config(RunConfig, values, "the run")
