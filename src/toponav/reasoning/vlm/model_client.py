"""Asks a model until there is a usable answer, or until there is no sense in asking on."""

from __future__ import annotations

import random
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TypeVar

from toponav.errors import ReasonerError
from toponav.reasoning.vlm.access import ModelAccess
from toponav.reasoning.vlm.answer_cache import AnswerCache
from toponav.reasoning.vlm.answers import UnusableAnswerError
from toponav.reasoning.vlm.chat import (
    RETRYABLE,
    Chat,
    ChatError,
    ChatReply,
    ChatRequest,
    FailureKind,
    Message,
)
from toponav.reasoning.vlm.circuit_breaker import CircuitBreaker
from toponav.reasoning.vlm.config import VlmConfig
from toponav.reasoning.vlm.exchange import Attempt, Exchange
from toponav.reasoning.vlm.prices import FREE
from toponav.reasoning.vlm.prompt import SYSTEM, Prompt, TextPart
from toponav.reasoning.vlm.retrying import wait_before
from toponav.reasoning.vlm.slots import Slots

T = TypeVar("T")

LONGEST_QUOTE = 2000
"""Characters of a wrong answer that are shown to the model again."""

REPAIR = """\
That answer cannot be used: {error}
Answer again with one JSON object that follows the schema, and nothing else."""


@dataclass(frozen=True)
class Endpoint:
    """A server, and what this process has learnt of it."""

    chat: Chat
    breaker: CircuitBreaker


class ModelClient:
    """Puts prompts to a model: cache, retries, one repair, ledger, replay."""

    def __init__(
        self,
        endpoint: Endpoint,
        config: VlmConfig,
        access: ModelAccess,
        seed: int = 0,
        sleep: Callable[[float], None] = time.sleep,
    ) -> None:
        """Ask at an endpoint.

        Args:
            endpoint: Shared by the episodes of a process.
            config: How to ask.
            access: Of the episode.
            seed: Draws the waits between requests.
            sleep: Waits so many seconds.
        """
        self._endpoint = endpoint
        self._config = config
        self._access = access
        self._draw = random.Random(seed)
        self._sleep = sleep
        self._price = config.price() or FREE
        settings = {"temperature": config.temperature, "tokens": config.max_answer_tokens}
        self._cache = AnswerCache(access.cache, f"{config.base_url} {config.model}", settings)
        self._slots = Slots(access.slots, config.concurrent_calls)

    def ask(self, prompt: Prompt, parse: Callable[[str], T]) -> T:
        """The usable answer to a prompt.

        Args:
            prompt: The question.
            parse: Makes an answer of what the model said, or raises `UnusableAnswerError`.

        Raises:
            ReasonerError: There is none; the message says why.
        """
        exchange = (
            self._recorded(prompt) or self._cached(prompt, parse) or self._asked(prompt, parse)
        )
        self._access.log.add(prompt, exchange)
        if exchange.answer is None:
            raise ReasonerError(f"{exchange.model}: {exchange.failure}")
        try:
            return parse(exchange.answer)
        except UnusableAnswerError as error:
            raise ReasonerError(f"{exchange.model}: recorded answer: {error}") from error

    def _recorded(self, prompt: Prompt) -> Exchange | None:
        """What was recorded, when an episode is replayed."""
        if self._access.replay is None:
            return None
        exchange = self._access.replay.next(prompt.digest)
        return exchange or self._exchange(prompt, None, FailureKind.NOT_RECORDED)

    def _cached(self, prompt: Prompt, parse: Callable[[str], T]) -> Exchange | None:
        answer = self._cache.get(prompt.digest)
        if answer is None:
            return None
        try:
            parse(answer)
        except UnusableAnswerError:
            return None
        return replace(self._exchange(prompt, answer), cached=True)

    def _asked(self, prompt: Prompt, parse: Callable[[str], T]) -> Exchange:
        """Ask over the network, again and again within the limits."""
        config = self._config.retry
        deadline = time.monotonic() + config.deadline_s
        messages: tuple[Message, ...] = (
            Message("system", (TextPart(SYSTEM),)),
            Message("user", prompt.parts),
        )
        attempts: list[Attempt] = []
        repaired = False
        while len(attempts) < config.attempts and time.monotonic() < deadline:
            if self._endpoint.breaker.is_open:
                return self._exchange(prompt, None, FailureKind.CIRCUIT_OPEN, attempts)
            request = ChatRequest(prompt.name, messages, prompt.schema)
            attempt, wait_s = self._attempt(request, len(attempts), deadline)
            attempt = _judged(attempt, parse)
            attempts.append(attempt)
            if not attempt.failure:
                self._cache.put(prompt.digest, attempt.answer)
                return self._exchange(prompt, attempt.answer, "", attempts)
            if attempt.failure == FailureKind.UNUSABLE:
                if repaired:
                    break
                repaired = True
                messages += _repair(attempt)
            if wait_s is None or time.monotonic() + wait_s >= deadline:
                break
            self._sleep(wait_s if len(attempts) < config.attempts else 0.0)
        return self._exchange(prompt, None, attempts[-1].failure, attempts)

    def _attempt(
        self, request: ChatRequest, retry: int, deadline: float
    ) -> tuple[Attempt, float | None]:
        """One request, and how long to wait before another one: None if that makes no sense."""
        breaker = self._endpoint.breaker
        with self._slots.one(deadline):
            started = time.monotonic()
            timeout_s = min(self._config.retry.timeout_s, deadline - started)
            try:
                reply = self._endpoint.chat.complete(request, timeout_s)
            except ChatError as error:
                latency = time.monotonic() - started
                if error.kind is FailureKind.UNAUTHORIZED:
                    breaker.break_now()
                elif error.kind in RETRYABLE:
                    breaker.failed()
                attempt = Attempt(failure=error.kind, message=str(error), latency_s=latency)
                if error.kind not in RETRYABLE:
                    return attempt, None
                wait = wait_before(retry, self._config.retry, self._draw, error.retry_after_s)
                return attempt, wait
        breaker.succeeded()
        return self._billed(reply, time.monotonic() - started), 0.0

    def _billed(self, reply: ChatReply, latency_s: float) -> Attempt:
        return Attempt(
            answer=reply.text,
            latency_s=latency_s,
            prompt_tokens=reply.prompt_tokens,
            completion_tokens=reply.completion_tokens,
            cost_usd=self._price.of(reply.prompt_tokens, reply.completion_tokens),
        )

    def _exchange(
        self,
        prompt: Prompt,
        answer: str | None,
        failure: str = "",
        attempts: list[Attempt] | None = None,
    ) -> Exchange:
        model = self._config.model
        return Exchange(
            prompt.name, prompt.digest, model, answer, str(failure), False, tuple(attempts or ())
        )


def _judged(attempt: Attempt, parse: Callable[[str], T]) -> Attempt:
    """An attempt whose answer, if there is one, has been found usable or not."""
    if attempt.failure:
        return attempt
    try:
        parse(attempt.answer)
    except UnusableAnswerError as error:
        return replace(attempt, failure=str(FailureKind.UNUSABLE), message=str(error))
    return attempt


def _repair(attempt: Attempt) -> tuple[Message, Message]:
    """The turns that show a model its wrong answer."""
    quote = attempt.answer[:LONGEST_QUOTE]
    return (
        Message("assistant", (TextPart(quote),)),
        Message("user", (TextPart(REPAIR.format(error=attempt.message)),)),
    )
