"""Not asking a server that does not answer."""

from __future__ import annotations

from collections.abc import Callable

from pydantic import Field

from toponav.config_model import ConfigModel


class CircuitBreakerConfig(ConfigModel):
    """When a server counts as down."""

    failures: int = Field(default=5, ge=1)
    """Failures in a row after which nothing is asked for a while."""

    pause_s: float = Field(default=30.0, ge=0.0)
    """How long; then one request tries whether the server is back."""


class CircuitBreaker:
    """Counts failures in a row, over all episodes of a process."""

    def __init__(self, config: CircuitBreakerConfig, now: Callable[[], float]) -> None:
        """Start closed, which lets requests pass; `now` is a clock in seconds."""
        self._config = config
        self._now = now
        self._failures = 0
        self._opened_at = 0.0

    @property
    def is_open(self) -> bool:
        """Whether nothing is to be asked now."""
        if self._failures < self._config.failures:
            return False
        return self._now() - self._opened_at < self._config.pause_s

    def succeeded(self) -> None:
        """The server has answered."""
        self._failures = 0

    def failed(self) -> None:
        """The server has not answered; one more failure in a row, also after the pause."""
        self._failures += 1
        self._opened_at = self._now()

    def break_now(self) -> None:
        """There is no sense in asking again soon, as with a wrong key."""
        self._failures = max(self._failures, self._config.failures)
        self._opened_at = self._now()
