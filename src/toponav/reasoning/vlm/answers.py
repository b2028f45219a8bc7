"""From what a model said to a checked answer: data from outside, never orders."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ValidationError

from toponav.memory.text import clean_name
from toponav.reasoning.schema import Guidance
from toponav.reasoning.vlm.affinity_prompt import Affinities
from toponav.reasoning.vlm.prompt import Prompt

AnswerT = TypeVar("AnswerT", bound=BaseModel)

LONGEST_REASON = 300
"""Characters of a reason that are kept."""

LONGEST_ERROR = 300


class UnusableAnswerError(ValueError):
    """An answer that does not follow its schema; the message says what is wrong with it."""


def parse_answer(text: str, prompt: Prompt, answer: type[AnswerT], **known: Any) -> AnswerT:
    """The answer to a prompt, checked against what was shown.

    The first JSON object counts, whatever prose or fence is around it.

    Args:
        text: What the model said.
        prompt: What it was asked.
        answer: The kind of answer.
        known: Fields of it that were not asked for.

    Raises:
        UnusableAnswerError: No JSON object, wrong keys or types, or a number that was not on offer.
    """
    data = _first_object(text)
    try:
        found = answer.model_validate({**data, **known})
    except ValidationError as error:
        first = error.errors()[0]
        key = ".".join(str(part) for part in first["loc"]) or "the answer"
        raise UnusableAnswerError(f"{key}: {first['msg']}"[:LONGEST_ERROR]) from error
    for name, field in prompt.schema["properties"].items():
        allowed = field.get("enum")
        value = getattr(found, name)
        if allowed is not None and value not in allowed:
            raise UnusableAnswerError(f"{name}: {value} is not one of {allowed}"[:LONGEST_ERROR])
    return found


def parse_guidance(text: str, prompt: Prompt, room: str | None) -> Guidance:
    """Guidance whose free text is fit to be shown; `room` is R where it was asked for apart.

    Raises:
        UnusableAnswerError: As `parse_answer`.
    """
    known = {} if room is None else {"room_type": room}
    guidance = parse_answer(text, prompt, Guidance, **known)
    reason = " ".join(guidance.reason.split())[:LONGEST_REASON]
    return guidance.model_copy(
        update={"room_type": room_name(guidance.room_type), "reason": reason}
    )


def parse_affinities(text: str, prompt: Prompt, names: Sequence[str]) -> NDArray[np.float64]:
    """(N,) likelihoods in [0, 1], one for each name.

    Raises:
        UnusableAnswerError: As `parse_answer`, or not one number in [0, 1] for each.
    """
    values = np.array(parse_answer(text, prompt, Affinities).likelihoods, dtype=np.float64)
    if len(values) != len(names):
        raise UnusableAnswerError(
            f"likelihoods: {len(names)} numbers are needed, not {len(values)}"
        )
    if not ((values >= 0.0) & (values <= 1.0)).all():
        raise UnusableAnswerError("likelihoods: every number must be from 0 to 1")
    return values


def room_name(text: str) -> str:
    """A room's type as the memory keeps it: one short line in lower case."""
    return clean_name(text).lower() or "unknown"


def _first_object(text: str) -> dict[str, Any]:
    """The first JSON object in a text."""
    decoder = json.JSONDecoder()
    start = text.find("{")
    while start >= 0:
        try:
            found, _ = decoder.raw_decode(text, start)
        except (json.JSONDecodeError, RecursionError):
            start = text.find("{", start + 1)
            continue
        if isinstance(found, dict):
            return found
        start = text.find("{", start + 1)
    raise UnusableAnswerError("there is no JSON object in the answer")
