"""TopoNav: training-free object navigation with a topological memory.

The public API, loaded on first use so that `import toponav` costs nothing:

- `Navigator`, `NavigatorConfig`, `preset`: the method.
- `HouseEnv`, `HouseEnvConfig`, `load_scene`: somewhere to search.
- `OracleDetector`, `PriorReasoner`: perception and reasoning that need nothing else.
- `Action`, `Agent`, `Detections`, `Observation`, `Intrinsics`, `Pose`: what crosses the seams.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from toponav.config import NavigatorConfig, preset
    from toponav.envs.simulator import HouseEnv, HouseEnvConfig
    from toponav.errors import TopoNavError
    from toponav.geometry import Intrinsics, Pose
    from toponav.navigator import Navigator
    from toponav.perception.oracle import OracleDetector
    from toponav.reasoning.prior import PriorReasoner
    from toponav.scenes.loading import load_scene
    from toponav.types import Action, Agent, Detections, Observation

__version__ = "0.1.0"

__all__ = [
    "Action",
    "Agent",
    "Detections",
    "HouseEnv",
    "HouseEnvConfig",
    "Intrinsics",
    "Navigator",
    "NavigatorConfig",
    "Observation",
    "OracleDetector",
    "Pose",
    "PriorReasoner",
    "TopoNavError",
    "load_scene",
    "preset",
]

_HOME = {
    "Action": "toponav.types",
    "Agent": "toponav.types",
    "Detections": "toponav.types",
    "HouseEnv": "toponav.envs.simulator",
    "HouseEnvConfig": "toponav.envs.simulator",
    "Intrinsics": "toponav.geometry",
    "Navigator": "toponav.navigator",
    "NavigatorConfig": "toponav.config",
    "Observation": "toponav.types",
    "OracleDetector": "toponav.perception.oracle",
    "Pose": "toponav.geometry",
    "PriorReasoner": "toponav.reasoning.prior",
    "TopoNavError": "toponav.errors",
    "load_scene": "toponav.scenes.loading",
    "preset": "toponav.config",
}


def __getattr__(name: str) -> object:
    """Load a public name from where it lives (PEP 562)."""
    if name not in _HOME:
        raise AttributeError(f"module 'toponav' has no attribute {name!r}")
    return getattr(import_module(_HOME[name]), name)


def __dir__() -> list[str]:
    """The public names."""
    return [*__all__, "__version__"]
