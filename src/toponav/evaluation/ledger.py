"""What the models of a run were asked and took, read from the logs of its episodes."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from toponav.evaluation.model_files import CALLS, check_replay
from toponav.reasoning.vlm.exchange import Exchange
from toponav.reasoning.vlm.replay import read_exchanges


@dataclass(frozen=True)
class LedgerRow:
    """The exchanges about one kind of prompt, or all of them.

    Attributes:
        prompt: Name of the prompt, or "all".
        questions: How many were put.
        cached: Those that the cache answered.
        unanswered: Those that the stand-in answered.
        calls: Requests.
        failures: Failed requests by kind.
        latency_s: Median and 95th percentile of the requests; None without any.
        prompt_tokens: In.
        completion_tokens: Out.
        cost_usd: By the price table.
    """

    prompt: str
    questions: int
    cached: int
    unanswered: int
    calls: int
    failures: dict[str, int]
    latency_s: tuple[float, float] | None
    prompt_tokens: int
    completion_tokens: int
    cost_usd: float


def ledger(run: Path) -> list[LedgerRow]:
    """One row a kind of prompt, by name, and one for all.

    Raises:
        InputError: No model was asked in the run, or a log is damaged.
    """
    check_replay(run)
    exchanges = [
        exchange
        for path in sorted((run / CALLS).glob("*.jsonl"))
        for exchange in read_exchanges(path)
    ]
    names = sorted({exchange.prompt for exchange in exchanges})
    rows = [_row(name, [e for e in exchanges if e.prompt == name]) for name in names]
    return [*rows, _row("all", exchanges)]


def _row(name: str, exchanges: Sequence[Exchange]) -> LedgerRow:
    attempts = [attempt for exchange in exchanges for attempt in exchange.attempts]
    failures = Counter(attempt.failure for attempt in attempts if attempt.failure)
    latency = None
    if attempts:
        median, slow = np.percentile([attempt.latency_s for attempt in attempts], [50, 95])
        latency = float(median), float(slow)
    return LedgerRow(
        prompt=name,
        questions=len(exchanges),
        cached=sum(exchange.cached for exchange in exchanges),
        unanswered=sum(exchange.answer is None for exchange in exchanges),
        calls=len(attempts),
        failures=dict(sorted(failures.items())),
        latency_s=latency,
        prompt_tokens=sum(attempt.prompt_tokens for attempt in attempts),
        completion_tokens=sum(attempt.completion_tokens for attempt in attempts),
        cost_usd=float(np.sum([attempt.cost_usd for attempt in attempts])),
    )
