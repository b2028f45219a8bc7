"""Any server that speaks OpenAI's chat-completions, through the `openai` library.

What a server does not support (a JSON schema, images, the name of an option) is learnt from its
first refusal and remembered for the process.
"""

from __future__ import annotations

import base64
import io
import json
import os
import time
from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

from PIL import Image

from toponav.errors import InputError
from toponav.reasoning.base import Reasoner, ReasonerContext, reasoners
from toponav.reasoning.fallback import FallbackReasoner
from toponav.reasoning.prior import PriorReasoner
from toponav.reasoning.vlm.access import ModelAccess
from toponav.reasoning.vlm.chat import (
    ChatError,
    ChatReply,
    ChatRequest,
    FailureKind,
    Message,
)
from toponav.reasoning.vlm.circuit_breaker import CircuitBreaker
from toponav.reasoning.vlm.config import Structured, VlmConfig
from toponav.reasoning.vlm.model_client import Endpoint, ModelClient
from toponav.reasoning.vlm.prompt import ImagePart, TextPart
from toponav.reasoning.vlm.vlm_reasoner import VlmReasoner

NAME = "openai"

LONGEST_REPLY = 1_000_000
"""Bytes of a reply that are read; an answer has a few hundred."""

LONGEST_MESSAGE = 200
"""Characters of a server's complaint that are kept."""

JPEG_QUALITY = 85

NO_KEY = "none"
"""Sent to a server of one's own, which asks for no key."""

BAD_REQUEST, NOT_FOUND, UNPROCESSABLE, SERVER_ERRORS = 400, 404, 422, 500

LOOSER: dict[Structured, Structured] = {"schema": "object", "object": "instruction"}

SIGNS = {
    "limit": ("max_tokens",),
    "temperature": ("temperature",),
    "structured": ("response_format", "json_schema", "json_object", "schema", "grammar"),
    "images": ("image", "vision", "multimodal", "multi-modal"),
}
"""Words of a refusal that tell which option it is about."""


@dataclass(frozen=True)
class Capabilities:
    """What a server takes.

    Attributes:
        structured: The strictest form of answer.
        images: Whether the model sees.
        temperature: Whether the temperature may be set.
        limit: Name of the option that limits the answer's length.
    """

    structured: Structured = "schema"
    images: bool = True
    temperature: bool = True
    limit: str = "max_tokens"

    def without(self, complaint: str, *, guess: bool) -> Capabilities | None:
        """Less, after a refusal; None if it is about something else.

        Args:
            complaint: What the server said.
            guess: Take a refusal that names nothing known as one of the answer's form.
        """
        named = {
            option for option, words in SIGNS.items() if any(w in complaint.lower() for w in words)
        }
        if "limit" in named and self.limit == "max_tokens":
            return replace(self, limit="max_completion_tokens")
        if "temperature" in named and self.temperature:
            return replace(self, temperature=False)
        if "structured" in named and self.structured in LOOSER:
            return replace(self, structured=LOOSER[self.structured])
        if "images" in named and self.images:
            return replace(self, images=False)
        if guess and not named and self.structured in LOOSER:
            return replace(self, structured=LOOSER[self.structured])
        return None


class OpenAiChat:
    """A model behind chat-completions."""

    def __init__(self, config: VlmConfig, key: str) -> None:
        """Connect to nothing yet; `key` never leaves this object but in requests."""
        import openai

        self._openai = openai
        self._config = config
        self._key = key
        self._client = openai.OpenAI(api_key=key, base_url=config.base_url or None, max_retries=0)
        self._answered = False
        self.capabilities = Capabilities(structured=config.structured)

    def complete(self, request: ChatRequest, timeout_s: float) -> ChatReply:
        """One request; refusals of options lead to the next one at once, without them.

        Raises:
            ChatError: No reply, or none that can be read.
        """
        deadline = time.monotonic() + timeout_s
        while True:
            try:
                reply = _reply(self._send(request, deadline))
            except self._openai.APIStatusError as error:
                self._learn(error)
                continue
            self._answered = True
            return reply

    def _send(self, request: ChatRequest, deadline: float) -> bytes:
        """The body of the reply."""
        openai = self._openai
        left = deadline - time.monotonic()
        if left <= 0.0:
            raise ChatError(FailureKind.TIMEOUT, "no time left")
        try:
            completions = self._client.chat.completions.with_streaming_response
            with completions.create(**self._payload(request), timeout=left) as response:
                return _read(response.iter_bytes(), deadline)
        except (ChatError, openai.APIStatusError):
            raise
        except openai.APITimeoutError as error:
            raise ChatError(FailureKind.TIMEOUT, "the server did not answer in time") from error
        except Exception as error:  # of the HTTP library below, whichever and whatever that is
            late = "Timeout" in type(error).__name__
            kind = FailureKind.TIMEOUT if late else FailureKind.NO_CONNECTION
            raise ChatError(kind, self._without_key(str(error))) from error

    def _payload(self, request: ChatRequest) -> dict[str, Any]:
        """The request's body."""
        can, config = self.capabilities, self._config
        payload: dict[str, Any] = {
            "model": config.model,
            "messages": [_message(message, can.images) for message in request.messages],
            can.limit: config.max_answer_tokens,
        }
        if can.temperature:
            payload["temperature"] = config.temperature
        if can.structured == "schema":
            schema = {"name": request.name, "strict": True, "schema": dict(request.schema)}
            payload["response_format"] = {"type": "json_schema", "json_schema": schema}
            return payload
        if can.structured == "object":
            payload["response_format"] = {"type": "json_object"}
        told = f"Schema of the answer: {json.dumps(request.schema)}"
        payload["messages"][0]["content"] += f"\n{told}"
        return payload

    def _learn(self, error: Any) -> None:
        """Do without what the server refuses.

        Raises:
            ChatError: The refusal is about something else.
        """
        status: int = error.status_code
        message = self._without_key(str(error.message))
        if status in {BAD_REQUEST, UNPROCESSABLE}:
            less = self.capabilities.without(message, guess=not self._answered)
            if less is not None:
                self.capabilities = less
                return
        raise ChatError(
            _kind(status, message), f"{status}: {message}", _retry_after_s(error.response.headers)
        ) from None

    def _without_key(self, text: str) -> str:
        return text.replace(self._key, "***")[:LONGEST_MESSAGE]


def _kind(status: int, message: str) -> FailureKind:
    if status in {401, 403}:
        return FailureKind.UNAUTHORIZED
    if status == 429:
        return FailureKind.RATE_LIMITED
    if status in {408, 409} or status >= SERVER_ERRORS:
        return FailureKind.SERVER_ERROR
    if "content_filter" in message or "content management policy" in message:
        return FailureKind.FILTERED
    return FailureKind.BAD_REQUEST


def _retry_after_s(headers: Any) -> float | None:
    """Seconds that the server asks to wait; a date, which such servers do not send, is none."""
    try:
        wait = float(headers.get("retry-after", ""))
    except ValueError:
        return None
    return wait if 0.0 <= wait < float("inf") else None


def _read(chunks: Iterable[bytes], deadline: float) -> bytes:
    """A body of bounded length, within bounded time."""
    body = bytearray()
    for chunk in chunks:
        body += chunk
        if len(body) > LONGEST_REPLY:
            raise ChatError(FailureKind.TOO_LONG, f"more than {LONGEST_REPLY} bytes")
        if time.monotonic() > deadline:
            raise ChatError(FailureKind.TIMEOUT, "the reply did not end in time")
    return bytes(body)


def _reply(body: bytes) -> ChatReply:
    """What the model said."""
    try:
        data = json.loads(body.decode("utf-8"))
        choice = data["choices"][0]
        message = choice["message"]
        text = message.get("content")
        filtered = choice.get("finish_reason") == "content_filter" or message.get("refusal")
        usage = data.get("usage") or {}
        tokens = [int(usage.get(key) or 0) for key in ("prompt_tokens", "completion_tokens")]
    except (ValueError, LookupError, TypeError, AttributeError, RecursionError) as error:
        raise ChatError(FailureKind.MALFORMED, "the reply is no chat completion") from error
    if filtered:
        raise ChatError(FailureKind.FILTERED, "the model's provider withheld the answer")
    if not isinstance(text, str) or not text.strip():
        raise ChatError(FailureKind.MALFORMED, "the reply holds no text")
    return ChatReply(text, *tokens)


def _message(message: Message, images: bool) -> dict[str, Any]:
    """A turn, with its images if the model sees."""
    shown = [part for part in message.parts if images or isinstance(part, TextPart)]
    if all(isinstance(part, TextPart) for part in shown):
        text = "\n\n".join(part.text for part in shown if isinstance(part, TextPart))
        return {"role": message.role, "content": text}
    return {"role": message.role, "content": [_part(part) for part in shown]}


def _part(part: TextPart | ImagePart) -> dict[str, Any]:
    if isinstance(part, TextPart):
        return {"type": "text", "text": part.text}
    stream = io.BytesIO()
    Image.fromarray(part.image).save(stream, format="JPEG", quality=JPEG_QUALITY)
    url = f"data:image/jpeg;base64,{base64.b64encode(stream.getvalue()).decode()}"
    return {"type": "image_url", "image_url": {"url": url, "detail": part.detail}}


def key_of(config: VlmConfig) -> str:
    """The key from the environment.

    Raises:
        InputError: There is none, and the server is not one's own.
    """
    key = os.environ.get(config.key_variable, "").strip()
    if not key and not config.base_url:
        raise InputError(
            f"--reasoner openai needs a key in the environment variable {config.key_variable}, or "
            "--base-url of a server of your own"
        )
    return key or NO_KEY


@cache
def _endpoint(config: VlmConfig, key: str) -> tuple[Endpoint, OpenAiChat]:
    """One server and its state a process, whatever the number of episodes."""
    chat = OpenAiChat(config, key)
    return Endpoint(chat, CircuitBreaker(config.breaker, time.monotonic)), chat


def connect(
    config: VlmConfig, access: ModelAccess, seed: int = 0
) -> tuple[ModelClient, OpenAiChat]:
    """A client of the configured server; nothing is sent yet.

    Args:
        config: Which model, and how it is asked.
        access: Ledger, cache and recording.
        seed: Draws the waits between requests.

    Raises:
        InputError: There is no key in the environment, and the server is not one's own.
    """
    key = NO_KEY if access.replay is not None else key_of(config)
    endpoint, chat = _endpoint(config, key)
    return ModelClient(endpoint, config, access, seed), chat


@reasoners.register(NAME)
def _openai(context: ReasonerContext) -> Reasoner:
    config = context.config.openai
    client, _ = connect(config, context.access or ModelAccess(), context.seed)
    return FallbackReasoner(VlmReasoner(client, config.prompt), PriorReasoner(context.config.prior))
