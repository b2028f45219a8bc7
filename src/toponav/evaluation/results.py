"""Episode results: the record, its JSON line, and files that are never left half-written."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any

from pydantic import TypeAdapter, ValidationError

from toponav.errors import InputError
from toponav.evaluation.funnel import SearchTrace
from toponav.evaluation.metrics import (
    BENCHMARK_RADIUS_M,
    SUCCESS_RADII_M,
    soft_spl,
    spl,
    success,
)
from toponav.reasoning.usage import VlmUsage


@dataclass(frozen=True)
class EpisodeResult:
    """One episode, with all that is needed to score it again at another radius.

    Attributes:
        scene: Name of the scene.
        index: Index of the episode in its scene; (scene, index) is the key.
        target: Category searched for.
        method: Name of the agent.
        seed: Seed of the episode.
        stop_called: Whether the agent ended the episode by itself.
        distance_to_goal: DTG at the end, metres; infinite without a path.
        shortest_path: l, DTG at the start, metres.
        path_length: p, sum of the 3-D displacements, metres.
        success: By radius in metres.
        spl: At the benchmark's radius.
        soft_spl: SoftSPL.
        steps: Actions taken, stop included.
        collisions: Steps that were cut short.
        decisions: Decisions of the reasoner.
        vlm: Model usage.
        seconds: Wall-clock seconds by stage; not reproducible.
        ended: "stop", "step-limit" or "error: ...".
        floor_change: Whether the nearest goal lay on another floor than the start.
        config_sha: Hash of the resolved configuration.
        scene_m2: Area on which the agent can stand in the scene, square metres.
        failure: "" on success at the benchmark's radius, else one of `funnel.FAILURES`.
        search: How far the search got, and when.
    """

    scene: str
    index: int
    target: str
    method: str
    seed: int
    stop_called: bool
    distance_to_goal: float
    shortest_path: float
    path_length: float
    success: Mapping[str, bool]
    spl: float
    soft_spl: float
    steps: int
    collisions: int
    decisions: int
    seconds: Mapping[str, float]
    ended: str
    floor_change: bool
    config_sha: str
    scene_m2: float = 0.0
    failure: str = ""
    search: SearchTrace = field(default_factory=SearchTrace)
    vlm: VlmUsage = field(default_factory=VlmUsage)

    @property
    def key(self) -> tuple[str, int]:
        """(scene, index): the same in every run of the same source."""
        return self.scene, self.index

    @property
    def succeeded(self) -> bool:
        """Success at the benchmark's radius."""
        return self.success[str(BENCHMARK_RADIUS_M)]


_RECORD = TypeAdapter(EpisodeResult)


@dataclass(frozen=True)
class Score:
    """The protocol's metrics of one finished episode."""

    success: dict[str, bool]
    spl: float
    soft_spl: float


def score_episode(
    stop_called: bool, distance_to_goal: float, shortest_path: float, path_length: float
) -> Score:
    """Score an episode from the four numbers that the protocol stores."""
    by_radius = {
        str(radius): success(stop_called, distance_to_goal, radius) for radius in SUCCESS_RADII_M
    }
    return Score(
        success=by_radius,
        spl=spl(by_radius[str(BENCHMARK_RADIUS_M)], shortest_path, path_length),
        soft_spl=soft_spl(distance_to_goal, shortest_path, path_length),
    )


def to_json(result: EpisodeResult) -> str:
    """One line of `episodes.jsonl`; an infinite distance is written as null, as JSON has none."""
    return json.dumps(json_ready(asdict(result)), allow_nan=False)


def from_json(line: str, where: str = "an episode") -> EpisodeResult:
    """The record that `to_json` wrote; a distance of null is infinite again.

    Args:
        line: One line of `episodes.jsonl`.
        where: Names the line in messages.

    Raises:
        InputError: Not such a line.
    """
    try:
        data = json.loads(line)
        for record, name in ((data, "distance_to_goal"), (data, "shortest_path"),
                             (data.get("search", {}), "closest_m")):  # fmt: skip
            if name in record and record[name] is None:
                record[name] = math.inf
        return _RECORD.validate_python(data)
    except ValidationError as error:
        first = error.errors()[0]
        key = ".".join(str(part) for part in first["loc"])
        raise InputError(f"{where}: {key}: {first['msg']}; not a result of toponav eval") from error
    except (ValueError, TypeError, AttributeError, RecursionError) as error:
        raise InputError(f"{where}: not a JSON record of an episode") from error


def json_ready(value: Any) -> Any:
    """The same data with infinities and NaN as None, since JSON has no word for them."""
    if isinstance(value, dict):
        return {str(key): json_ready(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [json_ready(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
