"""What explains an episode's decisions, as a file: the format `toponav-explanation/1`.

One gzipped JSON file an episode, beside `decisions.jsonl`: the map at each decision, what was
weighed on it, the memory as a graph, and small pictures. Lengths are metres in the world frame.
"""

from __future__ import annotations

import base64
import gzip
import json
import zlib
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Final, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from toponav.errors import InputError
from toponav.files import write_atomic

FORMAT: Final = "toponav-explanation/1"
"""Name and version; a change that old readers would misread gets a new version."""

EXPLANATION_FILE = "explanation.json.gz"

LONGEST_SIDE = 8192
"""Cells along a side of a map; a file that says more is damaged."""

Finite = Annotated[float, Field(allow_inf_nan=False)]
Point = tuple[Finite, Finite]
Corner = tuple[Finite, Finite, Finite]


class _Record(BaseModel):
    """Unknown keys are rejected: a file is of this format or it is not."""

    model_config = ConfigDict(extra="forbid", frozen=True)


class MapRecord(_Record):
    """The grid of one floor and what lies on it, every layer as runs of value and length.

    Cell (i, j) covers x in origin + [i, i + 1) * resolution; layers are in raster order, j fastest.
    """

    origin: Point
    resolution: Annotated[float, Field(gt=0.0, allow_inf_nan=False)]
    shape: tuple[
        Annotated[int, Field(ge=0, le=LONGEST_SIDE)], Annotated[int, Field(ge=0, le=LONGEST_SIDE)]
    ]
    cells: tuple[int, ...]
    """0 unknown, 1 free, 2 obstacle, 3 frontier."""

    objects: tuple[int, ...]
    """0 nothing, else one more than the index of the category."""

    categories: tuple[str, ...]
    """Of the objects mapped on this floor."""

    heat: tuple[int, ...] | None = None
    """0 no navigable point, 1 masked as unsafe, 2 and more the affordance; None without any."""

    @model_validator(mode="after")
    def _layers_fill_the_shape(self) -> MapRecord:
        size = self.shape[0] * self.shape[1]
        for layer in (self.cells, self.objects, self.heat):
            if layer is not None and (len(layer) % 2 or sum(layer[1::2]) != size):
                raise ValueError("a layer does not fill the map")
        return self


class NodeRecord(_Record):
    """A place of the memory."""

    id: int
    position: Point
    floor: int
    objects: tuple[str, ...]
    room_type: str
    frontier_count: int
    visits: int


class FrontierRecord(_Record):
    """A frontier as the search weighed it; see `WeighedFrontier`."""

    at: Point
    cells: int
    path_cost: Finite
    unknown_m2: Finite
    likelihood: Finite
    speaks: str
    guided: bool
    on_stairs: bool
    promise: Finite
    rank: int | None


class SideRecord(_Record):
    """What one side says of a candidate; see `SideView`."""

    side: int
    near: bool
    frames: int
    hits: int
    others: int
    log_odds: Finite


class CandidateRecord(_Record):
    """A candidate and its evidence; see `CandidateView`."""

    low: Corner
    high: Corner
    log_odds: Finite
    verdict: Finite
    returns: int
    chosen: bool
    sides: tuple[SideRecord, ...]


class TermRecord(_Record):
    """One term of the affordance at the waypoint."""

    name: str
    value: Finite


class DecisionRecord(_Record):
    """What explains one decision; `index` is that of its line in `decisions.jsonl`."""

    index: int
    floor: int
    map: MapRecord
    nodes: tuple[NodeRecord, ...] = ()
    edges: tuple[tuple[int, int, Finite], ...] = ()
    """Smaller id, larger id, length of the way between them."""

    history: tuple[int, ...] = ()
    frontiers: tuple[FrontierRecord, ...] = ()
    candidates: tuple[CandidateRecord, ...] = ()
    terms: tuple[TermRecord, ...] = ()
    exchanges: int = 0
    """Questions to a model answered so far in the episode."""

    panorama: str | None = None
    """Its views side by side: WebP, base64."""


class PictureRecord(_Record):
    """One floor from above in its own colours at the end of the episode."""

    floor: int
    low: Point
    high: Point
    image: str
    """WebP with alpha, base64; x to the right, y up."""


class Explanation(_Record):
    """The file."""

    format: Literal["toponav-explanation/1"] = FORMAT
    target: str
    decisions: tuple[DecisionRecord, ...] = ()
    end: MapRecord | None = None
    """The map when the episode was over."""

    picture: PictureRecord | None = None


def save_explanation(explanation: Explanation, path: Path) -> None:
    """Write the file whole; the same explanation makes the same bytes.

    Raises:
        OSError: It cannot be written.
    """
    write_atomic(path, gzip.compress(explanation.model_dump_json().encode(), mtime=0))


def load_explanation(path: Path) -> Explanation:
    """Read the file back.

    Raises:
        InputError: It cannot be read or is not of this format.
    """
    try:
        data = json.loads(gzip.decompress(path.read_bytes()))
        return Explanation.model_validate(data)
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(map(str, first["loc"]))
        raise InputError(
            f"{path}: {where}: {first['msg']}; not a file of this version's eval --explain"
        ) from error
    except (OSError, EOFError, zlib.error, ValueError, RecursionError) as error:
        raise InputError(f"{path} cannot be read: {error}; remove it or run it again") from error


def runs_of(values: NDArray[np.integer]) -> tuple[int, ...]:
    """Value, length, value, length, ... of an array in raster order."""
    flat = values.ravel()
    if not len(flat):
        return ()
    starts = np.concatenate([[0], np.flatnonzero(flat[1:] != flat[:-1]) + 1])
    lengths = np.diff(np.append(starts, len(flat)))
    return tuple(np.stack([flat[starts], lengths], axis=1).ravel().tolist())


def values_of(runs: Sequence[int], shape: tuple[int, int]) -> NDArray[np.int64]:
    """The (N_x, N_y) array whose `runs_of` those are."""
    return np.repeat(np.array(runs[0::2], np.int64), runs[1::2]).reshape(shape)


def base64_text(data: bytes) -> str:
    """Bytes as ASCII."""
    return base64.b64encode(data).decode("ascii")
