"""What tokens cost: a table that ages, and that the configuration overrides."""

from __future__ import annotations

import json
import re
from dataclasses import dataclass
from functools import cache
from importlib.resources import files

DATED = re.compile(r"-\d{4}-\d{2}-\d{2}$")
"""Suffix of a model's dated version, which costs what the model costs."""


@dataclass(frozen=True)
class Price:
    """Dollars per million tokens, in and out."""

    prompt: float
    completion: float

    def of(self, prompt_tokens: int, completion_tokens: int) -> float:
        """Dollars for so many tokens."""
        return (self.prompt * prompt_tokens + self.completion * completion_tokens) / 1e6


FREE = Price(0.0, 0.0)


@cache
def price_table() -> dict[str, Price]:
    """`prices.json`: hosted models by name."""
    text = files("toponav.reasoning.vlm").joinpath("prices.json").read_text(encoding="utf-8")
    return {model: Price(*prices) for model, prices in json.loads(text).items()}


def known_price(model: str) -> Price | None:
    """The price of a model, or of the model that it is a dated version of; None if unknown."""
    return price_table().get(DATED.sub("", model))
