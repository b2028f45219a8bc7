"""Reasoners: from target, memory, history and panorama to guidance (Section III-E).

Sees `memory` and what lies below it. `base` declares the seam and the registry, `schema` the
answer, `prior` is the offline reasoner, with `knowledge` and `affinity` behind it.
"""

from toponav.reasoning.base import (
    PanoramaView,
    Query,
    Reasoner,
    ReasonerFactory,
    SeenObject,
    reasoners,
)
from toponav.reasoning.prior import PriorConfig, PriorReasoner
from toponav.reasoning.schema import Guidance

__all__ = [
    "Guidance",
    "PanoramaView",
    "PriorConfig",
    "PriorReasoner",
    "Query",
    "Reasoner",
    "ReasonerFactory",
    "SeenObject",
    "reasoners",
]
