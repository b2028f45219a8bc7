"""The ObjectNav episode file of the Habitat challenges, as it is on the disk.

Everything here is in the file's own terms: y up, -z forward, metres, quaternions (x, y, z, w). Keys
that this project does not use are kept, so that a file that is read and written is the same file.
"""

from __future__ import annotations

import gzip
import json
import zlib
from pathlib import Path
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from toponav.errors import InputError
from toponav.files import write_atomic

SUFFIXES = (".json.gz", ".json")
MARK = '"object_category"'
"""Stands in every file that holds an episode."""

CATEGORY_TABLE = '"category_to_task_category_id"'
"""Stands in every file, also in that of a split whose episodes lie in files of their own."""

SNIFFED_BYTES = 1 << 16

Coordinate = Annotated[float, Field(allow_inf_nan=False)]
Vector = Annotated[list[Coordinate], Field(min_length=3, max_length=3)]
Quaternion = Annotated[list[Coordinate], Field(min_length=4, max_length=4)]


class _Record(BaseModel):
    """A part of the file; unknown keys are kept."""

    model_config = ConfigDict(frozen=True, extra="allow")


class AgentState(_Record):
    """A pose of the agent's foot point."""

    position: Vector
    rotation: Quaternion


class ViewPoint(_Record):
    """A pose from which the object is seen."""

    agent_state: AgentState
    iou: float | None = None


class FileGoal(_Record):
    """One instance of a goal category."""

    position: Vector
    object_id: int | str
    object_category: str
    object_name: str | None = None
    view_points: list[ViewPoint]


class EpisodeInfo(_Record):
    """What the dataset's authors measured; without a path the distance is infinite."""

    geodesic_distance: float
    euclidean_distance: float


class FileEpisode(_Record):
    """One episode."""

    episode_id: str | int
    scene_id: Annotated[str, Field(min_length=1)]
    start_position: Vector
    start_rotation: Quaternion
    info: EpisodeInfo
    object_category: str


class ObjectNavFile(_Record):
    """A whole file: a split, or one scene of it."""

    episodes: list[FileEpisode]
    goals_by_category: dict[str, list[FileGoal]] = Field(default_factory=dict)
    category_to_task_category_id: dict[str, int]


def is_objectnav_file(path: Path) -> bool:
    """Whether a file looks like one of episodes; reads its beginning only."""
    if not path.name.endswith(SUFFIXES) or not path.is_file():
        return False
    try:
        with gzip.open(path) if path.suffix == ".gz" else path.open("rb") as stream:
            head = stream.read(SNIFFED_BYTES).decode("utf-8", errors="replace")
    except (OSError, EOFError, zlib.error):
        return path.suffix == ".gz"  # damaged: its reader says how
    return MARK in head or CATEGORY_TABLE in head or path.suffix == ".gz"


def read_file(path: Path) -> ObjectNavFile:
    """Read and validate one file.

    Raises:
        InputError: It cannot be read, is cut short, is not JSON, or breaks the format; one line
            that names the file and the place.
    """
    try:
        data = path.read_bytes()
        text = gzip.decompress(data) if path.suffix == ".gz" else data
        content = json.loads(text)
    except OSError as error:
        reason = error.strerror or "not a gzip file; fetch it again"
        raise InputError(f"{path}: {reason}") from error
    except (EOFError, zlib.error) as error:
        raise InputError(
            f"{path}: the gzip file is damaged or cut short; fetch it again"
        ) from error
    except (ValueError, RecursionError) as error:
        raise InputError(f"{path}: not JSON ({error}); fetch it again") from error
    try:
        return ObjectNavFile.model_validate(content)
    except ValidationError as error:
        first = error.errors()[0]
        place = "".join(f"[{k}]" if isinstance(k, int) else f".{k}" for k in first["loc"])
        what = place.lstrip(".") or "the whole"
        raise InputError(
            f"{path}: {what}: {first['msg']}; not an ObjectNav episode file"
        ) from error


def write_file(path: Path, content: ObjectNavFile) -> None:
    """Write one file; the same content gives the same bytes."""
    data: Any = content.model_dump(mode="python", exclude_unset=True)
    text = json.dumps(data).encode()
    write_atomic(path, gzip.compress(text, mtime=0) if path.suffix == ".gz" else text)
