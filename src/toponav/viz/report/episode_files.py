"""What an episode left on the disk, read back and checked line by line."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, TypeVar

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from toponav.errors import InputError
from toponav.evaluation.explanation_file import EXPLANATION_FILE, Explanation, load_explanation
from toponav.evaluation.model_files import CALLS, episode_name
from toponav.evaluation.recorder import episode_folder
from toponav.evaluation.results import EpisodeResult
from toponav.memory.graph import TopologicalMemory
from toponav.memory.serialization import load_memory
from toponav.reasoning.schema import Guidance

Finite = Annotated[float, Field(allow_inf_nan=False)]


class _Line(BaseModel):
    """A line of a record; keys that a later version adds are passed over."""

    model_config = ConfigDict(extra="ignore", frozen=True)


class StepLine(_Line):
    """One line of `trajectory.jsonl`."""

    step: int
    position: tuple[Finite, Finite, Finite]
    yaw: Finite
    action: str
    collided: bool = False


class ViewLine(_Line):
    """One view of a panorama; `seen` holds labels and scores."""

    bearing: Finite
    frontiers: int
    floor_m2: Finite
    seen: tuple[tuple[str, float], ...] = ()


class DecisionLine(_Line):
    """One line of `decisions.jsonl`."""

    index: int
    step: int
    phase: str
    node: int | None = None
    guidance: Guidance | None = None
    waypoint: tuple[Finite, Finite, Finite] | None = None
    path: tuple[tuple[Finite, Finite], ...] = ()
    memory_text: str | None = None
    views: tuple[ViewLine, ...] = ()


class AttemptLine(_Line):
    """One request to a model."""

    answer: str = ""
    failure: str = ""
    latency_s: Finite = 0.0
    prompt_tokens: int = 0
    completion_tokens: int = 0
    cost_usd: Finite = 0.0


class ExchangeLine(_Line):
    """One line of an episode's `calls`: what a model was asked and what it said."""

    prompt: str
    model: str
    text: str = ""
    answer: str | None = None
    failure: str = ""
    cached: bool = False
    images: tuple[str, ...] = ()
    attempts: tuple[AttemptLine, ...] = ()


@dataclass(frozen=True, eq=False)
class EpisodeRecords:
    """All that there is about one episode; what was not recorded is empty or None.

    Attributes:
        result: Its line of `episodes.jsonl`.
        steps: Where it went.
        decisions: What it decided.
        explanation: What the decisions rest on.
        memory: The memory at the end.
        exchanges: What a model was asked.
    """

    result: EpisodeResult
    steps: tuple[StepLine, ...]
    decisions: tuple[DecisionLine, ...]
    explanation: Explanation | None
    memory: TopologicalMemory | None
    exchanges: tuple[ExchangeLine, ...]


def read_episode(run: Path, result: EpisodeResult) -> EpisodeRecords:
    """Read what a run recorded of an episode.

    Args:
        run: The run's folder; that of a single episode holds its records itself.
        result: The episode.

    Raises:
        InputError: A file is damaged; the message names it and the line.
    """
    own = episode_folder(run, result.scene, result.index)
    folder = own if own.is_dir() else run
    explained, memory = folder / EXPLANATION_FILE, folder / "memory.json"
    calls = run / CALLS / f"{episode_name(result.scene, result.index)}.jsonl"
    return EpisodeRecords(
        result=result,
        steps=tuple(_lines(folder / "trajectory.jsonl", StepLine)),
        decisions=tuple(_lines(folder / "decisions.jsonl", DecisionLine)),
        explanation=load_explanation(explained) if explained.exists() else None,
        memory=load_memory(memory) if memory.exists() else None,
        exchanges=tuple(_lines(calls, ExchangeLine)),
    )


Line = TypeVar("Line", bound=_Line)


def _lines(path: Path, kind: type[Line]) -> Iterator[Line]:
    """The lines of a file; none where there is no file. A torn last line is left out."""
    if not path.exists():
        return
    text = path.read_bytes()
    whole = text[: text.rfind(b"\n") + 1].decode("utf-8", errors="replace")
    for number, line in enumerate(whole.split("\n")[:-1], start=1):
        yield _parsed(line, kind, f"{path}, line {number}")


def _parsed(line: str, kind: type[Line], where: str) -> Line:
    try:
        data: Any = json.loads(line)
        return kind.model_validate(data)
    except ValidationError as error:
        first = error.errors()[0]
        key = ".".join(map(str, first["loc"]))
        raise InputError(f"{where}: {key}: {first['msg']}; remove the file to leave it out") from (
            error
        )
    except (ValueError, RecursionError) as error:
        raise InputError(f"{where}: not JSON; remove the file to leave it out") from error
