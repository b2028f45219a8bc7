"""What this process has cost so far."""

from __future__ import annotations

import resource
import threading
import time

_BEGUN_S = time.monotonic()


def process_cost() -> dict[str, float]:
    """Seconds of the clock and of the processor, greatest memory (MB), and threads."""
    used = resource.getrusage(resource.RUSAGE_SELF)
    return {
        "wall_s": time.monotonic() - _BEGUN_S,
        "cpu_s": used.ru_utime + used.ru_stime,
        "peak_mb": used.ru_maxrss / 1024.0,
        "threads": threading.active_count(),
    }
