"""How much memory this process holds."""

from __future__ import annotations

import math
import os
from pathlib import Path

PROCESS_MEMORY = Path("/proc/self/statm")
"""Where Linux tells of a process's memory, in pages; the second number is what is in RAM."""


def resident_mb() -> float:
    """Megabytes in RAM; NaN where the system does not tell."""
    try:
        pages = int(PROCESS_MEMORY.read_text(encoding="ascii").split()[1])
    except OSError:
        return math.nan
    return pages * os.sysconf("SC_PAGE_SIZE") / 1e6
