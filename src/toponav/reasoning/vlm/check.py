"""A handful of fixed questions that tell what a configured model can do, and at what cost."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np
from pydantic import BaseModel, ConfigDict

from toponav.errors import ReasonerError
from toponav.memory.snapshot import EdgeView, MemorySnapshot, NodeView
from toponav.memory.text import TextBudget, describe
from toponav.reasoning.base import PanoramaView, Query, SeenObject
from toponav.reasoning.vlm.access import ModelAccess
from toponav.reasoning.vlm.answers import UnusableAnswerError, parse_answer, parse_guidance
from toponav.reasoning.vlm.guidance_prompt import guidance_prompt
from toponav.reasoning.vlm.model_client import ModelClient
from toponav.reasoning.vlm.prompt import ImagePart, Prompt, PromptConfig, TextPart, closed_schema

DECISIONS_PER_EPISODE = 6
"""Mean of the preset `paper` in the development houses; see docs/results.md."""

SIGHT = "sees images"

COLOURS = {"red": (200, 30, 30), "green": (30, 160, 60), "blue": (40, 60, 200)}


class _Word(BaseModel):
    model_config = ConfigDict(extra="forbid", use_attribute_docstrings=True)

    reason: str
    """One word."""


@dataclass(frozen=True)
class CheckedQuestion:
    """One question and what came of it.

    Attributes:
        name: What it is about.
        passed: Whether the answer was usable, and right where there is a right one.
        detail: What was said, or what went wrong.
        latency_s: Of the last request.
        tokens: In and out, of the last request.
        cost_usd: Of all requests that it took.
    """

    name: str
    passed: bool
    detail: str
    latency_s: float
    tokens: tuple[int, int]
    cost_usd: float


def check_model(
    client: ModelClient, access: ModelAccess, refuses_images: Callable[[], bool]
) -> list[CheckedQuestion]:
    """Ask everything, in order; the first question that no reply comes to is the last.

    Args:
        client: Asks the model.
        access: The client's, with its ledger.
        refuses_images: Whether the server has refused images, so that none is sent any more.
    """
    questions = (
        ("answers in the given form", _ask_word),
        (SIGHT, _ask_colour),
        ("guides by text alone", partial(_ask_guidance, images=False)),
        ("guides by the panorama", partial(_ask_guidance, images=True)),
    )
    checked = []
    for name, ask in questions:
        try:
            passed, detail = ask(client)
        except ReasonerError as error:
            attempts = access.log.exchanges[-1].attempts
            passed, detail = False, attempts[-1].message if attempts else str(error)
        if name == SIGHT and refuses_images():
            passed, detail = False, "the server refuses images"
        exchange = access.log.exchanges[-1]
        last = exchange.attempts[-1] if exchange.attempts else None
        checked.append(
            CheckedQuestion(
                name,
                passed,
                detail,
                0.0 if last is None else last.latency_s,
                (0, 0) if last is None else (last.prompt_tokens, last.completion_tokens),
                math.fsum(attempt.cost_usd for attempt in exchange.attempts),
            )
        )
        if not any(attempt.answer for attempt in exchange.attempts):
            break
    return checked


def _ask_word(client: ModelClient) -> tuple[bool, str]:
    prompt = Prompt(
        "check", (TextPart("Give the word ready as the reason."),), closed_schema(_Word)
    )
    word = client.ask(prompt, partial(parse_answer, prompt=prompt, answer=_Word)).reason
    return "ready" in word.lower(), word[:80]


def _ask_colour(client: ModelClient) -> tuple[bool, str]:
    """The colour of the square in the middle, which the text does not tell."""
    image = np.full((256, 256, 3), 255, np.uint8)
    image[64:192, 64:192] = COLOURS["green"]
    question = f"Give the colour of the square as the reason: one of {', '.join(COLOURS)}."
    parts = (TextPart(question), ImagePart(image, "low"))
    prompt = Prompt("check", parts, closed_schema(_Word))
    word = client.ask(prompt, partial(_parse_colour, prompt=prompt))
    return word == "green", f"takes the green square for {word}" if word != "green" else word


def _parse_colour(text: str, prompt: Prompt) -> str:
    said = parse_answer(text, prompt, _Word).reason.lower()
    named = [colour for colour in COLOURS if colour in said]
    if len(named) != 1:
        raise UnusableAnswerError(f"reason: name one of {', '.join(COLOURS)}")
    return named[0]


def _ask_guidance(client: ModelClient, images: bool) -> tuple[bool, str]:
    """A bed is sought; view 1 and place 2 lead to a bedroom."""
    prompt = guidance_prompt(_query(), PromptConfig(images=images))
    guidance = client.ask(prompt, partial(parse_guidance, prompt=prompt, room=None))
    said = f"node {guidance.node_id}, view {guidance.direction}: {guidance.reason}"
    right = guidance.node_id == 2 and guidance.direction == 1 and not guidance.target_found
    return True, said if right else f"{said} (expected node 2, view 1)"


def _query() -> Query:
    nodes = (
        NodeView(1, (0.0, 0.0), 0, ("counter", "fridge"), "kitchen", 3, 1),
        NodeView(2, (4.0, 0.0), 0, ("nightstand",), "bedroom", 40, 1),
    )
    edges = (EdgeView(1, 2, 4.2, 4.0),)
    text = describe(nodes, edges, 1, (2, 1), TextBudget())
    fridge, nightstand = SeenObject("fridge", 0.9, 1.5), SeenObject("nightstand", 0.8, 4.5)
    image = np.full((120, 160, 3), 180, np.uint8)
    panorama = (
        PanoramaView(image, math.pi, (fridge,), 1.0, 3),
        PanoramaView(image, 0.0, (nightstand,), 6.0, 40),
    )
    return Query("bed", MemorySnapshot(nodes, edges, 1, (2, 1), text), panorama)
