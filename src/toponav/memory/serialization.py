"""Saving and loading a topological memory: the JSON format `toponav-memory/1`.

Lengths and positions are metres in the frame of the episode that made the memory; a file is of use
only where that frame is known, as on a robot with a map or in a simulator's scene.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, Final, Literal, NoReturn

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from toponav.errors import InputError
from toponav.files import write_atomic
from toponav.memory.graph import TopologicalMemory
from toponav.memory.snapshot import EdgeView, NodeView

FORMAT: Final = "toponav-memory/1"
"""Name and version; a change that old readers would misread gets a new version."""

Finite = Annotated[float, Field(allow_inf_nan=False)]


class _Record(BaseModel):
    """Strict (no coercion of types), unknown keys rejected."""

    model_config = ConfigDict(strict=True, extra="forbid", frozen=True)


class _NodeRecord(_Record):
    id: int
    position: tuple[Finite, Finite]
    floor: int
    objects: tuple[str, ...]
    room_type: str
    frontier_count: int = Field(ge=0)
    visits: int = Field(ge=0)


class _EdgeRecord(_Record):
    source: int
    target: int
    travelled_m: Finite
    geodesic_m: Finite


class _MemoryRecord(_Record):
    format: Literal["toponav-memory/1"]
    nodes: tuple[_NodeRecord, ...]
    edges: tuple[_EdgeRecord, ...]
    history: tuple[int, ...]
    next_id: int = Field(ge=1)


def memory_json(memory: TopologicalMemory) -> str:
    """A memory as JSON."""
    record = _MemoryRecord(
        format=FORMAT,
        nodes=tuple(_NodeRecord(**vars(node)) for node in memory.nodes),
        edges=tuple(_EdgeRecord(**vars(edge)) for edge in memory.edges),
        history=memory.history,
        next_id=memory.next_id,
    )
    return record.model_dump_json(indent=1) + "\n"


def save_memory(memory: TopologicalMemory, path: Path | str) -> None:
    """Write a memory as JSON, whole or not at all.

    Raises:
        InputError: The folder cannot be written.
    """
    target = Path(path)
    try:
        write_atomic(target, memory_json(memory))
    except OSError as error:
        raise InputError(f"cannot write memory {target}: {error.strerror}") from error


def load_memory(path: Path | str) -> TopologicalMemory:
    """Read a memory that `save_memory` wrote.

    Raises:
        InputError: No such file, not JSON, another format or version, or broken content.
    """
    source = Path(path)
    try:
        text = source.read_text(encoding="utf-8")
    except OSError as error:
        raise InputError(f"cannot read memory {source}: {error.strerror}") from error
    except UnicodeDecodeError as error:
        raise InputError(f"memory {source} is not JSON: {_one_line(error)}") from error
    return memory_from_json(text, source)


def memory_from_json(text: str, source: Path) -> TopologicalMemory:
    """A memory from what `memory_json` wrote; `source` names it in errors.

    Raises:
        InputError: Not JSON, another format or version, or broken content.
    """
    try:
        data = json.loads(text, parse_constant=_reject_constant)
    except (ValueError, RecursionError) as error:
        raise InputError(f"memory {source} is not JSON: {_one_line(error)}") from error
    found = data.get("format") if isinstance(data, dict) else None
    if found != FORMAT:
        raise InputError(f"memory {source} has format {found!r}; this version reads {FORMAT!r}")
    try:
        # Validated as JSON, in which a list is a tuple even to a strict model.
        record = _MemoryRecord.model_validate_json(json.dumps(data))
        return TopologicalMemory.from_parts(
            nodes=(NodeView(**vars(node)) for node in record.nodes),
            edges=(EdgeView(**vars(edge)) for edge in record.edges),
            history=record.history,
            next_id=record.next_id,
        )
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(str(part) for part in first["loc"])
        raise InputError(f"memory {source}: {where}: {first['msg']}") from error
    except InputError as error:
        raise InputError(f"memory {source}: {error}") from error


def _reject_constant(name: str) -> NoReturn:
    raise ValueError(f"{name} is not a number that JSON knows")


def _one_line(error: Exception) -> str:
    return " ".join(str(error).split())
