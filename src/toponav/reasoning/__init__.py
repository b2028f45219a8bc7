"""Reasoners: from target, memory, history and panorama to guidance (Section III-E).

Sees `memory` and what lies below it. `base` declares the seam and the registry, `schema` the
answer, `prior` is the offline reasoner, with `knowledge` and `affinity` behind it, and `noisy`
gives it a model's errors of sight. `openai_compatible` asks a real model, through `vlm`, and
`fallback` answers where that fails.
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
from toponav.reasoning.fallback import FallbackReasoner
from toponav.reasoning.noisy import NoisyReasoner, NoisyReasonerConfig
from toponav.reasoning.openai_compatible import OpenAiChat
from toponav.reasoning.prior import PriorConfig, PriorReasoner
from toponav.reasoning.schema import Guidance
from toponav.reasoning.usage import VlmUsage
from toponav.reasoning.vlm.config import VlmConfig

__all__ = [
    "FallbackReasoner",
    "Guidance",
    "NoisyReasoner",
    "NoisyReasonerConfig",
    "OpenAiChat",
    "PanoramaView",
    "PriorConfig",
    "PriorReasoner",
    "Query",
    "Reasoner",
    "ReasonerContext",
    "ReasonerFactory",
    "ReasoningConfig",
    "SeenObject",
    "VlmConfig",
    "VlmUsage",
    "reasoners",
]
