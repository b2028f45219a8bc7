"""A run's folder: what was asked for, the results so far, and whether one may go on with it."""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from pydantic import Field

from toponav.config import config_json
from toponav.config_model import ConfigModel
from toponav.errors import ConfigError, InputError
from toponav.evaluation.crew import Outcome
from toponav.evaluation.journal import Journal
from toponav.evaluation.other_floor import Only
from toponav.evaluation.results import json_ready
from toponav.evaluation.run_config import RunConfig
from toponav.files import append_line, discard_temporaries, write_atomic

CONFIG_FILE, RUN_FILE, SUMMARY_FILE = "config.json", "run.json", "summary.json"
RESULT_FILE = "result.json"
"""The one result of `toponav demo` and `toponav run`."""

ERRORS_FILE = "errors.log"
"""Tracebacks of episodes that failed by a defect; absent without any."""

FREE_TO_CHANGE = frozenset(
    [
        "episodes",
        "data",
        "only",
        "shard",
        "workers",
        "ray_address",
        "record",
        "explain",
        "cache",
        "max_cost",
    ]
)
"""What of a request may differ when a run is resumed, since no result depends on it."""


class RunRequest(ConfigModel):
    """What to run, and by how many; no episode's result depends on who runs it."""

    source: str
    """Scene, folder of scenes, generator range or episode file."""

    episodes: int | None = None
    """How many in all; None runs those that the scenes bring."""

    only: Only | None = None
    """Of those, only the ones that need a change of floor, or only the others."""

    labels: Path | None = None
    """Label table of mesh scenes."""

    data: Path = Path("data")
    """Where the scenes of an episode file lie."""

    shard: str | None = None
    """i/n: run only this part of the episodes."""

    workers: int = 1
    """Processes; one runs here, more need Ray."""

    ray_address: str | None = None
    """HOST:PORT of a cluster's head."""

    record: bool = True
    """Write every step and decision into a folder an episode."""

    explain: bool = True
    """Write beside them the map, the weights and small pictures of every decision."""

    cache: Path | None = None
    """Folder of a model's answers, which are not asked for again."""

    replay: Path | None = None
    """Run whose answers of a model are given again."""

    max_cost: float | None = Field(default=None, gt=0.0)
    """Dollars that a model may take; then no further episode is begun."""


class RunFolder:
    """Configuration, request, results and summary of one run, on the disk."""

    def __init__(self, folder: Path) -> None:
        """Use `folder`; it is made when the run begins."""
        self._folder = folder
        self.journal = Journal(folder)

    @contextmanager
    def opened(self, request: RunRequest, config: RunConfig, resume: bool) -> Iterator[None]:
        """Begin the run, or go on with it, and keep others out meanwhile.

        Args:
            request: What is run.
            config: How.
            resume: Go on with the run that was begun here, if there is one.

        Raises:
            InputError: The folder holds the episodes of a run that is not to be resumed, or of
                another one, or is being written to.
        """
        try:
            self._folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise InputError(
                f"cannot make the output folder {self._folder}: {error.strerror}"
            ) from error
        begun = self.journal.begun()
        if begun and not resume:
            raise InputError(
                f"{self.journal.path} exists: --resume goes on with that run; else choose another "
                "--out"
            )
        with self.journal.locked():
            discard_temporaries(self._folder)
            if begun:
                self._check_same(CONFIG_FILE, config, free=frozenset())
                self._check_same(RUN_FILE, request, free=FREE_TO_CHANGE)
                self.journal.repair()
            write_atomic(self._folder / CONFIG_FILE, config_json(config))
            write_atomic(self._folder / RUN_FILE, config_json(request))
            yield

    def keep(self, outcome: Outcome) -> None:
        """Write a finished episode down."""
        self.journal.append(outcome.result)
        if outcome.trace:
            title = f"{outcome.task.scene} #{outcome.task.index}"
            append_line(self._folder / ERRORS_FILE, f"{title}\n{outcome.trace}")

    def conclude(self, summary: dict[str, Any]) -> None:
        """Write the summary."""
        text = json.dumps(json_ready(summary), indent=2) + "\n"
        write_atomic(self._folder / SUMMARY_FILE, text)

    def _check_same(self, name: str, new: ConfigModel, free: frozenset[str]) -> None:
        """Refuse to mix episodes of different runs, and name what differs."""
        path = self._folder / name
        try:
            old = json.loads(path.read_text(encoding="utf-8"))
        except (OSError, ValueError) as error:
            raise ConfigError(
                f"cannot resume: {path} cannot be read ({error}); choose another --out"
            ) from error
        changed = [
            f"{key} was {before!r}, is {after!r}"
            for key, before, after in differences(old, json.loads(config_json(new)))
            if key not in free
        ]
        if changed:
            raise ConfigError(
                f"cannot resume {self._folder}: {'; '.join(changed)}; use the same options, or "
                "another --out"
            )


def differences(old: Any, new: Any, key: str = "") -> list[tuple[str, Any, Any]]:
    """Dotted key, old and new value of everything that differs."""
    if isinstance(old, dict) and isinstance(new, dict):
        return [
            found
            for name in sorted(old.keys() | new.keys())
            for found in differences(old.get(name), new.get(name), f"{key}.{name}".strip("."))
        ]
    return [] if old == new else [(key, old, new)]
