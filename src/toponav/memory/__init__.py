"""Topological memory: places, what is near them, and how they connect (Section III-D).

Sees `mapping` and what lies below it. `graph` is the data, `builder` maintains it, `text` words it
for a language model, `serialization` keeps it between runs, `snapshot` is what others read.
"""

from toponav.memory.builder import Geodesic, MemoryBuilder, MemoryConfig
from toponav.memory.graph import TopologicalMemory, path_lengths
from toponav.memory.serialization import load_memory, save_memory
from toponav.memory.snapshot import (
    UNKNOWN_ROOM,
    EdgeView,
    MemorySnapshot,
    NodeAttribute,
    NodeView,
)
from toponav.memory.text import TextBudget, describe

__all__ = [
    "UNKNOWN_ROOM",
    "EdgeView",
    "Geodesic",
    "MemoryBuilder",
    "MemoryConfig",
    "MemorySnapshot",
    "NodeAttribute",
    "NodeView",
    "TextBudget",
    "TopologicalMemory",
    "describe",
    "load_memory",
    "path_lengths",
    "save_memory",
]
