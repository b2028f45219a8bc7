"""The seam to a server that speaks chat-completions: one request, one reply or one failure."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from typing import Any, Literal, Protocol

from toponav.reasoning.vlm.prompt import ImagePart, TextPart


class FailureKind(StrEnum):
    """Why a request brought no usable answer."""

    NO_CONNECTION = "no connection"
    TIMEOUT = "timeout"
    UNAUTHORIZED = "unauthorized"
    RATE_LIMITED = "rate limited"
    SERVER_ERROR = "server error"
    BAD_REQUEST = "bad request"
    MALFORMED = "malformed reply"
    TOO_LONG = "reply too long"
    FILTERED = "content filter"
    UNUSABLE = "unusable answer"
    CIRCUIT_OPEN = "circuit open"
    NOT_RECORDED = "not recorded"


RETRYABLE = frozenset(
    {
        FailureKind.NO_CONNECTION,
        FailureKind.TIMEOUT,
        FailureKind.RATE_LIMITED,
        FailureKind.SERVER_ERROR,
        FailureKind.MALFORMED,
        FailureKind.TOO_LONG,
    }
)
"""Kinds after which the same request may succeed."""


class ChatError(Exception):
    """A request that failed.

    Attributes:
        kind: Why.
        retry_after_s: How long the server asks to wait; None if it does not say.
    """

    def __init__(self, kind: FailureKind, message: str, retry_after_s: float | None = None) -> None:
        super().__init__(message)
        self.kind = kind
        self.retry_after_s = retry_after_s


@dataclass(frozen=True, eq=False)
class Message:
    """One turn of a conversation."""

    role: Literal["system", "user", "assistant"]
    parts: tuple[TextPart | ImagePart, ...]


@dataclass(frozen=True, eq=False)
class ChatRequest:
    """A conversation to be continued by an answer of a schema.

    Attributes:
        name: Names the schema.
        messages: So far.
        schema: JSON schema of the answer.
    """

    name: str
    messages: tuple[Message, ...]
    schema: Mapping[str, Any]


@dataclass(frozen=True)
class ChatReply:
    """What the model said, and the tokens that the server counted (0 if it does not tell)."""

    text: str
    prompt_tokens: int = 0
    completion_tokens: int = 0


class Chat(Protocol):
    """A model behind a server."""

    def complete(self, request: ChatRequest, timeout_s: float) -> ChatReply:
        """One request over the network; never retried here.

        Raises:
            ChatError: No reply, or none that can be read.
        """
        ...
