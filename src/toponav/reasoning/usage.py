"""What a model behind a reasoner took."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field


@dataclass(frozen=True)
class VlmUsage:
    """Model usage of one or more episodes; all zero for an offline reasoner.

    Attributes:
        calls: Requests that were sent, repeats included.
        failures: Those of them that brought no usable answer.
        prompt_tokens: Tokens in.
        completion_tokens: Tokens out.
        cost_usd: By the price table.
        failure_kinds: Failures by kind.
        unanswered: Questions that no request answered, so that the stand-in did.
        not_recorded: Those of them that a replayed run had not asked: their prompts changed.
        cached: Questions that the cache answered, without a request.
    """

    calls: int = 0
    failures: int = 0
    prompt_tokens: int = 0
    completion_tokens: int = 0
    cost_usd: float = 0.0
    failure_kinds: Mapping[str, int] = field(default_factory=dict)
    unanswered: int = 0
    not_recorded: int = 0
    cached: int = 0


def total_usage(usages: Iterable[VlmUsage]) -> VlmUsage:
    """The sum over episodes."""
    parts = list(usages)
    kinds: Counter[str] = Counter()
    for part in parts:
        kinds.update(part.failure_kinds)
    return VlmUsage(
        calls=sum(part.calls for part in parts),
        failures=sum(part.failures for part in parts),
        prompt_tokens=sum(part.prompt_tokens for part in parts),
        completion_tokens=sum(part.completion_tokens for part in parts),
        cost_usd=math.fsum(part.cost_usd for part in parts),
        failure_kinds=dict(sorted(kinds.items())),
        unanswered=sum(part.unanswered for part in parts),
        not_recorded=sum(part.not_recorded for part in parts),
        cached=sum(part.cached for part in parts),
    )
