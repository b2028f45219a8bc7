"""The one small house in which the whole is tested, with a camera small enough to be fast."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache

from toponav.config import with_overrides
from toponav.envs.simulator import HouseEnvConfig
from toponav.evaluation.run_config import RunConfig, run_config
from toponav.evaluation.runner import SceneRunner
from toponav.scenes.loading import load_scene
from toponav.scenes.mesh import Scene

SMALL = ("--camera", "160x120")
"""The same camera on the command line."""


@cache
def small_scene() -> Scene:
    """A generated house on one floor; its own two episodes look for a toilet and a TV."""
    return load_scene("generated:6")


def small_config(
    method: str = "toponav",
    preset: str = "paper",
    max_steps: int = 200,
    overrides: Mapping[str, str] | None = None,
) -> RunConfig:
    """A run in the small house; `overrides` are those of --set."""
    env = HouseEnvConfig(width=160, height=120, max_steps=max_steps)
    return with_overrides(run_config(preset, method, seed=0, env=env), overrides or {})


def small_runner(
    method: str = "toponav",
    preset: str = "paper",
    max_steps: int = 200,
    overrides: Mapping[str, str] | None = None,
) -> SceneRunner:
    """A runner in the small house; arguments as those of `small_config`."""
    return SceneRunner(small_scene(), small_config(method, preset, max_steps, overrides))
