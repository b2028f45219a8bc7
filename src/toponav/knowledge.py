"""What an agent knows of a building: map and memory, kept for the next goal or the next day.

It holds in the frame in which it was made; an agent that recalls it must be told its pose in that
frame, as a robot with a localised map or a simulator's scene tells it.
"""

from __future__ import annotations

import io
import zipfile
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol, runtime_checkable

import numpy as np

from toponav.errors import InputError
from toponav.files import write_atomic
from toponav.mapping.semantic_map import MapConfig, SemanticMap
from toponav.mapping.serialization import map_arrays, map_of
from toponav.memory.graph import TopologicalMemory
from toponav.memory.serialization import memory_from_json, memory_json
from toponav.types import Agent

FORMAT = "toponav-knowledge/2"
"""Name and version of the file: a NumPy archive of the map's arrays, and the memory's JSON."""


@dataclass(frozen=True, eq=False)
class Knowledge:
    """A map and a memory of the same building.

    Attributes:
        semantic_map: Section III-C.
        memory: Section III-D.
    """

    semantic_map: SemanticMap
    memory: TopologicalMemory


@runtime_checkable
class RecallingAgent(Agent, Protocol):
    """An agent that can start with what another episode in the same building has taught."""

    @property
    def knowledge(self) -> Knowledge:
        """What it knows by now."""
        ...

    def recall(self, knowledge: Knowledge) -> None:
        """Start with this after the next `reset`, which takes it over and changes it."""
        ...


def save_knowledge(knowledge: Knowledge, path: Path) -> None:
    """Write it, whole or not at all.

    Raises:
        InputError: The folder cannot be written.
    """
    buffer = io.BytesIO()
    texts = {"format": FORMAT, "memory": memory_json(knowledge.memory)}
    np.savez_compressed(
        buffer,
        allow_pickle=False,
        **map_arrays(knowledge.semantic_map),
        **{name: np.array(text) for name, text in texts.items()},
    )
    try:
        write_atomic(path, buffer.getvalue())
    except OSError as error:
        raise InputError(f"cannot write {path}: {error.strerror}") from error


def load_knowledge(path: Path, config: MapConfig) -> Knowledge:
    """Read what `save_knowledge` wrote.

    Raises:
        InputError: No such file, another format, broken content, or a map of another resolution.
    """
    try:
        with np.load(path, allow_pickle=False) as archive:
            arrays = {name: archive[name] for name in archive.files}
    except OSError as error:
        raise InputError(f"cannot read {path}: {error.strerror or error}") from error
    except (ValueError, EOFError, zipfile.BadZipFile) as error:
        raise InputError(f"{path} is no file of --memory: {error}") from error
    found = str(arrays.pop("format", None))
    if found != FORMAT:
        raise InputError(f"{path} has format {found!r}; this version reads {FORMAT!r}")
    memory = memory_from_json(str(arrays.pop("memory", "")), path)
    try:
        return Knowledge(map_of(arrays, config), memory)
    except InputError as error:
        raise InputError(f"{path}: {error}") from error
