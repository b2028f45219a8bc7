"""Reasoners: from target, memory, history and panorama to guidance (Section III-E).

Sees `memory` and what lies below it. `base` declares the seam and the registry, `schema` the
answer, `prior` is the offline reasoner, with `knowledge` and `affinity` behind it, and `noisy`
gives it a model's errors of sight.
"""

from toponav.reasoning.base import (
    PanoramaView,
    Query,
    Reasoner,
    ReasonerContext,
    ReasonerFactory,
    SeenObject,
    reasoners,
)
from toponav.reasoning.config import ReasoningConfig
from toponav.reasoning.noisy import NoisyReasoner, NoisyReasonerConfig
from toponav.reasoning.prior import PriorConfig, PriorReasoner
from toponav.reasoning.schema import Guidance

__all__ = [
    "Guidance",
    "NoisyReasoner",
    "NoisyReasonerConfig",
    "PanoramaView",
    "PriorConfig",
    "PriorReasoner",
    "Query",
    "Reasoner",
    "ReasonerContext",
    "ReasonerFactory",
    "ReasoningConfig",
    "SeenObject",
    "reasoners",
]
