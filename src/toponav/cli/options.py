"""Options that several commands share."""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import tyro

from toponav.errors import InputError

if TYPE_CHECKING:
    from toponav.viz.live.stream import LiveOptions

WorldOption = Literal["z-up", "y-up", "y-down"] | None
"""Which way a recording's world points up."""

JsonFlag = Annotated[bool, tyro.conf.arg(name="json"), tyro.conf.FlagCreatePairsOff]

QuietFlag = Annotated[bool, tyro.conf.FlagCreatePairsOff]

OffFlag = Annotated[bool, tyro.conf.FlagCreatePairsOff]
"""An option that is off unless it is given."""


def answer_cache() -> Path:
    """Where a user's programs keep what can be had again."""
    base = os.environ.get("XDG_CACHE_HOME", "").strip()
    return (Path(base) if base else Path.home() / ".cache") / "toponav" / "answers"


@dataclass(frozen=True)
class AgentOptions:
    """Which agent searches, and how."""

    method: str = "toponav"
    """toponav or a baseline; an unknown name lists them all. FILE.py:NAME is what a file of yours
    registers, also for the detector and the reasoner."""

    preset: Literal["default", "paper"] = "default"
    """Parameter set: the paper's, or the best we can do."""

    detector: str = "oracle"
    """Perception: oracle reads the simulator's true labels, noisy errs like a real detector."""

    reasoner: str = "prior"
    """What plays the VLM: prior is offline and deterministic, noisy looks at the images with a
    model's errors, openai asks a real one behind any OpenAI-compatible server."""

    model: str | None = None
    """Model of the reasoner openai, as its server calls it; by default gpt-4o."""

    base_url: str | None = None
    """Server of the reasoner openai, such as http://localhost:8080/v1; by default OpenAI's. The key
    comes from the environment variable OPENAI_API_KEY alone."""

    cache: Path | None = field(default_factory=answer_cache)
    """Folder of a model's answers: what was answered once is not asked again; None asks anew."""

    backend: Literal["embedded", "habitat"] = "embedded"
    """What simulates: the embedded simulator, or habitat-sim for scenes in Habitat's files."""

    follower: Literal["map", "oracle"] = "map"
    """How walks are planned: over the agent's own map, or, for comparison with papers that do so,
    with the simulator's navmesh; the latter is named in every table."""

    seed: int = 0
    """Seed of everything random."""

    camera: str = "640x480"
    """Image size, WIDTHxHEIGHT; the field of view stays that of the protocol."""

    max_steps: int = 500
    """Step limit of an episode."""

    set: Annotated[tuple[str, ...], tyro.conf.UseAppendAction] = field(default=())
    """Override any value of config.json, as --set navigator.memory.d_merge=2; repeatable."""


@dataclass(frozen=True)
class ShowOptions:
    """What to show of an episode while it runs."""

    view: Annotated[bool, tyro.conf.FlagCreatePairsOff] = False
    """Watch live in Rerun's viewer (extra `viz`)."""

    record: Path | None = None
    """Write what the viewer would show into FILE.rrd (extra `viz`)."""

    quiet: QuietFlag = False
    """Say nothing but the result, and errors."""

    def live(self) -> LiveOptions:
        """What the live view needs to know."""
        from toponav.viz.live.stream import LiveOptions

        return LiveOptions(self.view, self.record)


@dataclass(frozen=True)
class RunOptions:
    """How many episodes, from where, and by how many workers."""

    episodes: int | None = None
    """Episodes in all, spread evenly over the scenes; by default those that the scenes bring."""

    only: Literal["other-floor", "same-floor"] | None = None
    """Of the episodes that the scenes bring, only those whose target is on another floor than the
    start, or only the others."""

    workers: int = 1
    """Processes; more than one needs the extra `ray`. Results do not depend on it."""

    ray_address: str | None = None
    """HOST:PORT of a Ray cluster's head; by default the workers run on this machine."""

    labels: Path | None = None
    """Label table of mesh scenes: JSON, node-name pattern to category."""

    record: bool = True
    """Write every step and decision into OUT/episodes (about 60 kB an episode), for replay and
    reports; the workers of a cluster must share that folder."""

    explain: bool = True
    """Beside what is recorded, write the map, the weights and small pictures of every decision, for
    toponav report (about 50 kB an episode, three hundredths of its time)."""

    max_cost: float | None = None
    """Dollars that the reasoner's model may take: then no further episode is begun."""

    data: Path = Path("data")
    """Habitat's data folder, for ObjectNav episodes: holds `scene_datasets` and `datasets`."""


def image_size(text: str) -> tuple[int, int]:
    """Width and height from WIDTHxHEIGHT.

    Raises:
        InputError: Not two positive integers.
    """
    width, _, height = text.lower().partition("x")
    if not (width.isdigit() and height.isdigit() and int(width) > 0 and int(height) > 0):
        raise InputError(f"an image size is WIDTHxHEIGHT such as 640x480, not {text!r}")
    return int(width), int(height)


def overrides(settings: tuple[str, ...]) -> dict[str, str]:
    """Dotted keys and values of `--set key=value`.

    Raises:
        InputError: A setting without an equals sign.
    """
    pairs = {}
    for setting in settings:
        key, equals, value = setting.partition("=")
        if not equals or not key:
            raise InputError(f"--set takes key=value, not {setting!r}")
        pairs[key.strip()] = value.strip()
    return pairs


def start_pose(text: str) -> tuple[float, float, float, float]:
    """Position in metres and yaw in radians from x,y,z,yaw.

    Raises:
        InputError: Not four numbers.
    """
    try:
        x, y, z, yaw = (float(part) for part in text.split(","))
    except ValueError as error:
        raise InputError(
            f"--start takes x,y,z,yaw (metres and radians) such as 1.5,2,0,1.57, not {text!r}"
        ) from error
    return x, y, z, yaw


def fresh_folder(path: Path) -> Path:
    """Make the output folder, or say why it cannot be made.

    Raises:
        InputError: The path is a file or cannot be created.
    """
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"cannot make the output folder {path}: {error.strerror}") from error
    return path
