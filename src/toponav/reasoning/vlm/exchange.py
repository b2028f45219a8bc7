"""A question, all requests that it took, and what came of it: the unit of ledger and replay."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

from pydantic import TypeAdapter, ValidationError


@dataclass(frozen=True)
class Attempt:
    """One request over the network.

    Attributes:
        answer: What the model said; empty if nothing came.
        failure: A `FailureKind`, or "" if the answer was usable.
        message: What was wrong.
        latency_s: Seconds from the request to the reply; not reproducible.
        prompt_tokens: Tokens in, by the server's count.
        completion_tokens: Tokens out.
        cost_usd: By the price table.
    """

    answer: str = ""
    failure: str = ""
    message: str = ""
    latency_s: float = 0.0
    prompt_tokens: int = 0
    completion_tokens: int = 0
    cost_usd: float = 0.0


@dataclass(frozen=True)
class Exchange:
    """One question.

    Attributes:
        prompt: Name of the prompt.
        digest: Of the prompt.
        model: Who was asked.
        answer: The usable answer; None if there was none.
        failure: The last attempt's failure, or why nothing was asked; "" with an answer.
        cached: Whether the answer came from the cache, without a request.
        attempts: The requests, in order.
    """

    prompt: str
    digest: str
    model: str
    answer: str | None
    failure: str = ""
    cached: bool = False
    attempts: tuple[Attempt, ...] = ()


_EXCHANGE = TypeAdapter(Exchange)


def exchange_data(exchange: Exchange) -> dict[str, Any]:
    """As JSON values."""
    return asdict(exchange)


def exchange_of(data: Any) -> Exchange | None:
    """An exchange from JSON values that came from a file; None if they are not one."""
    try:
        return _EXCHANGE.validate_python(data)
    except ValidationError:
        return None
