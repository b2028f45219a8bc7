"""The navigator's configuration: the modules' configs composed, presets, strict load and save."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Literal, TypeVar

from pydantic import Field, ValidationError

from toponav.categories import DEFAULT_VOCABULARY
from toponav.config_model import ConfigModel
from toponav.control.locomotion import LocomotionConfig
from toponav.control.search_plan import SearchPlanConfig
from toponav.errors import ConfigError
from toponav.mapping.semantic_map import MapConfig
from toponav.memory.builder import MemoryConfig
from toponav.policy.affordances import AffordanceConfig
from toponav.policy.goal import GoalConfig
from toponav.reasoning.counsel import CounselConfig
from toponav.reasoning.panorama import PanoramaConfig

Preset = Literal["paper", "default"]
ConfigT = TypeVar("ConfigT", bound=ConfigModel)


class NavigatorConfig(ConfigModel):
    """Every parameter of `Navigator`; the defaults are the preset `paper`."""

    map: MapConfig = Field(default_factory=MapConfig)
    """Section III-C."""

    memory: MemoryConfig = Field(default_factory=MemoryConfig)
    """Section III-D."""

    panorama: PanoramaConfig = Field(default_factory=PanoramaConfig)
    """The views of a decision."""

    counsel: CounselConfig = Field(default_factory=CounselConfig)
    """Whether the agent waits for its reasoner."""

    affordances: AffordanceConfig = Field(default_factory=AffordanceConfig)
    """Section III-E."""

    goal: GoalConfig = Field(default_factory=GoalConfig)
    """When a target counts as mapped, and when to stop."""

    locomotion: LocomotionConfig = Field(default_factory=LocomotionConfig)
    """Planning, following and recovery."""

    search: SearchPlanConfig | None = None
    """Explore by a plan over frontiers, with short looks; without it, as in the paper, by the sum
    of affordances and a panorama at every waypoint."""

    vocabulary: tuple[str, ...] = DEFAULT_VOCABULARY
    """T: what the detector looks for beside the target."""

    decide_on_sight: bool = False
    """Decide from the current view alone as soon as the target is detected on the way."""


_PRESETS: dict[str, dict[str, Any]] = {
    "paper": {},
    "default": {
        "decide_on_sight": True,
        "map": {"stairwells": True, "stairs_by_shape": True, "clearing": {}},
        "goal": {"evidence": {}, "glimpses": {}, "stop_distance_m": 0.92},
        "locomotion": {
            "planner": {
                "clearance_weight": 1.0,
                "landing_m": 0.8,
                "preferred_clearance_m": 0.35,
                "tight_weight": 10.0,
            },
            "recovery": {"maneuver_m": 0.7},
        },
        "search": {},
    },
}


def preset(name: str) -> NavigatorConfig:
    """`paper`: the paper's equations and nothing more; `default`: the best we can do.

    Raises:
        ConfigError: Unknown name.
    """
    if name not in _PRESETS:
        raise ConfigError(f"unknown preset {name!r}; known: {', '.join(sorted(_PRESETS))}")
    return NavigatorConfig(**_PRESETS[name])


def with_overrides(config: ConfigT, overrides: Mapping[str, str]) -> ConfigT:
    """A copy with values replaced by dotted key, as `navigator.memory.d_merge=2` does.

    Args:
        config: Any configuration.
        overrides: Dotted key to a JSON value; what is not JSON is taken as text.

    Raises:
        ConfigError: Unknown key or impossible value; names the key.
    """
    data = config.model_dump()
    for key, text in overrides.items():
        *parents, leaf = key.split(".")
        node: Any = data
        for name in parents:
            node = node.get(name) if isinstance(node, dict) else None
        if not isinstance(node, dict) or leaf not in node:
            raise ConfigError(f"unknown configuration key {key!r}; {_known_keys(data, parents)}")
        try:
            node[leaf] = json.loads(text)
        except json.JSONDecodeError:
            node[leaf] = text
    return parse_config(type(config), data, "--set")


def _known_keys(data: dict[str, Any], parents: list[str]) -> str:
    """The keys at the deepest level of `parents` that exists."""
    node: Any = data
    for name in parents:
        if not isinstance(node, dict) or name not in node:
            break
        node = node[name]
    return "known here: " + ", ".join(sorted(node if isinstance(node, dict) else data))


def parse_config(kind: type[ConfigT], data: Any, source: str) -> ConfigT:
    """Validate data that came from outside.

    Raises:
        ConfigError: One line that names `source`, the first wrong key and what is wrong with it.
    """
    try:
        return kind.model_validate(data)
    except ValidationError as error:
        first = error.errors()[0]
        key = ".".join(str(part) for part in first["loc"]) or "the whole"
        raise ConfigError(f"{source}: {key}: {first['msg']}") from error


def load_config(kind: type[ConfigT], path: Path) -> ConfigT:
    """Read a configuration that `config_json` wrote; unknown keys are errors.

    Raises:
        ConfigError: No such file, not JSON, an unknown key or an impossible value.
    """
    try:
        data = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise ConfigError(f"cannot read the configuration {path}: {error.strerror}") from error
    except ValueError as error:
        raise ConfigError(f"the configuration {path} is not JSON: {error}") from error
    return parse_config(kind, data, str(path))


def config_json(config: ConfigModel) -> str:
    """The resolved configuration as JSON, every default written out."""
    return json.dumps(config.model_dump(mode="json"), indent=2) + "\n"


def config_sha(config: ConfigModel) -> str:
    """The first 12 hex digits of the resolved configuration's SHA-256."""
    return hashlib.sha256(config_json(config).encode()).hexdigest()[:12]
