"""Which model is asked, and how: the section `reasoning.openai` of a run's configuration."""

from __future__ import annotations

from typing import Literal
from urllib.parse import urlsplit

from pydantic import Field, field_validator

from toponav.config_model import ConfigModel
from toponav.reasoning.vlm.circuit_breaker import CircuitBreakerConfig
from toponav.reasoning.vlm.prices import FREE, Price, known_price
from toponav.reasoning.vlm.prompt import PromptConfig
from toponav.reasoning.vlm.retrying import RetryConfig

Structured = Literal["schema", "object", "instruction"]
"""How an answer's form is asked for: by JSON schema, as some JSON object, or in words only."""


class VlmConfig(ConfigModel):
    """A model behind a server that speaks chat-completions."""

    model: str = "gpt-4o"
    """Name of the model, as the server calls it; the paper's by default."""

    base_url: str = ""
    """Address of the server, such as http://localhost:8080/v1; OpenAI's without one."""

    key_variable: str = "OPENAI_API_KEY"
    """Environment variable that holds the key; a local server needs none."""

    temperature: float = Field(default=0.0, ge=0.0, le=2.0)
    """0 for answers that repeat as well as the server can."""

    max_answer_tokens: int = Field(default=400, ge=50)
    """Longest answer."""

    structured: Structured = "schema"
    """The strictest form to try; what the server refuses is not tried again."""

    prompt: PromptConfig = Field(default_factory=PromptConfig)
    """What is asked."""

    retry: RetryConfig = Field(default_factory=RetryConfig)
    """How often and how long."""

    breaker: CircuitBreakerConfig = Field(default_factory=CircuitBreakerConfig)
    """When to stop asking for a while."""

    concurrent_calls: int = Field(default=8, ge=1)
    """Requests at once, over all workers of a run."""

    price_per_million: tuple[float, float] | None = None
    """Dollars per million tokens in and out; by default a table's, and 0 for an own server."""

    @field_validator("base_url")
    @classmethod
    def _without_a_key(cls, url: str) -> str:
        """The configuration is written beside the results, and a key must not be."""
        if "@" in urlsplit(url).netloc:
            raise ValueError("put the key into the environment, not into the address")
        return url

    def price(self) -> Price | None:
        """What tokens cost; None if nobody knows."""
        if self.price_per_million is not None:
            return Price(*self.price_per_million)
        return known_price(self.model) or (FREE if self.base_url else None)
