"""How long things take, over the last of them."""

from __future__ import annotations

import threading
from collections import deque

import numpy as np

KEPT = 2000
"""Durations of each kind that are kept."""


class Timings:
    """Durations by name; safe to use from any thread."""

    def __init__(self) -> None:
        """Start without any."""
        self._lock = threading.Lock()
        self._taken: dict[str, deque[float]] = {}

    def add(self, name: str, seconds: float) -> None:
        """Something took so long."""
        with self._lock:
            self._taken.setdefault(name, deque(maxlen=KEPT)).append(seconds)

    def summary(self) -> dict[str, dict[str, float]]:
        """Count, median, 99th percentile and maximum of each, milliseconds."""
        with self._lock:
            taken = {name: np.array(values) for name, values in self._taken.items()}
        return {
            name: {
                "count": len(values),
                "median_ms": 1e3 * float(np.median(values)),
                "p99_ms": 1e3 * float(np.percentile(values, 99)),
                "max_ms": 1e3 * float(values.max()),
            }
            for name, values in sorted(taken.items())
        }
