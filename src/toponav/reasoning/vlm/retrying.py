"""How long to wait before a request is sent again."""

from __future__ import annotations

import random

from pydantic import Field

from toponav.config_model import ConfigModel


class RetryConfig(ConfigModel):
    """How often and how long a question is asked."""

    attempts: int = Field(default=5, ge=1)
    """Requests a question, the repair of an answer included."""

    timeout_s: float = Field(default=30.0, gt=0.0)
    """How long one request may take."""

    deadline_s: float = Field(default=90.0, gt=0.0)
    """How long a question may take with all its requests; then the stand-in answers."""

    backoff_s: float = Field(default=1.0, ge=0.0)
    """Wait before the second request, doubled before each further one."""

    longest_backoff_s: float = Field(default=20.0, ge=0.0)
    """Longest wait, unless the server asks for a longer one."""


def wait_before(
    retry: int, config: RetryConfig, draw: random.Random, retry_after_s: float | None
) -> float:
    """Seconds to wait before the `retry`-th repeat, counted from 0.

    Exponential with full jitter, so that many workers do not come back at once; never less than
    what the server asks for.
    """
    ceiling = min(config.longest_backoff_s, config.backoff_s * 2.0**retry)
    wait = draw.uniform(0.0, ceiling)
    return wait if retry_after_s is None else max(wait, retry_after_s)
