"""The ledger of one episode: every exchange, on disk as it happens, and its sums."""

from __future__ import annotations

import json
import math
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from PIL import Image

from toponav.files import append_line, temporary_beside
from toponav.reasoning.usage import VlmUsage
from toponav.reasoning.vlm.chat import FailureKind
from toponav.reasoning.vlm.exchange import Attempt, Exchange, exchange_data
from toponav.reasoning.vlm.prompt import ImagePart, Prompt

IMAGES = "images"
"""Folder beside the logs of all episodes; an image that is shown twice is there once."""

IMAGE_QUALITY = 85


class CallLog:
    """Keeps the exchanges of one episode."""

    def __init__(self, path: Path | None = None) -> None:
        """Write into `path`, anew; without one nothing is written."""
        self._path = path
        self._exchanges: list[Exchange] = []
        if path is not None:
            path.unlink(missing_ok=True)

    @property
    def exchanges(self) -> Sequence[Exchange]:
        """All of them, in order."""
        return tuple(self._exchanges)

    def add(self, prompt: Prompt, exchange: Exchange) -> None:
        """Keep one exchange, with what was asked."""
        self._exchanges.append(exchange)
        if self._path is None:
            return
        self._path.parent.mkdir(parents=True, exist_ok=True)
        images = [part for part in prompt.parts if isinstance(part, ImagePart)]
        for image in images:
            self._save_image(self._path.parent / IMAGES / f"{image.digest}.jpg", image)
        line = {
            **exchange_data(exchange),
            "text": prompt.text,
            "images": [image.digest for image in images],
            "left_out": prompt.left_out,
            "estimated_tokens": prompt.tokens,
        }
        append_line(self._path, json.dumps(line))

    def usage(self) -> VlmUsage:
        """What the episode took."""
        attempts = self._attempts()
        kinds = Counter(attempt.failure for attempt in attempts if attempt.failure)
        return VlmUsage(
            calls=len(attempts),
            failures=kinds.total(),
            failure_kinds=dict(sorted(kinds.items())),
            unanswered=sum(exchange.answer is None for exchange in self._exchanges),
            not_recorded=sum(e.failure == FailureKind.NOT_RECORDED for e in self._exchanges),
            cached=sum(exchange.cached for exchange in self._exchanges),
            prompt_tokens=sum(attempt.prompt_tokens for attempt in attempts),
            completion_tokens=sum(attempt.completion_tokens for attempt in attempts),
            cost_usd=math.fsum(attempt.cost_usd for attempt in attempts),
        )

    def _attempts(self) -> list[Attempt]:
        return [attempt for exchange in self._exchanges for attempt in exchange.attempts]

    @staticmethod
    def _save_image(path: Path, part: ImagePart) -> None:
        if path.exists():
            return
        path.parent.mkdir(parents=True, exist_ok=True)
        temporary = temporary_beside(path)
        Image.fromarray(part.image).save(temporary, quality=IMAGE_QUALITY)
        temporary.replace(path)
