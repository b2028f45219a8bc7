"""Where the models of a run keep their calls, and what they may reuse."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

from toponav.errors import InputError
from toponav.reasoning.vlm.access import ModelAccess
from toponav.reasoning.vlm.call_log import CallLog
from toponav.reasoning.vlm.replay import Replay

CALLS = "calls"
"""Folder of a run with a log an episode; not there if no model was asked."""

SLOTS = ".slots"


def episode_name(scene: str, index: int) -> str:
    """Names an episode's files; the scene's name is free text."""
    return f"{re.sub(r'[^A-Za-z0-9_.-]+', '_', scene)}_{index}"


@dataclass(frozen=True)
class ModelFiles:
    """The files of a run's models.

    Attributes:
        run: The run's folder, which gets the calls; None to keep none.
        cache: Folder of answers that are not asked for again; None for no cache.
        replayed: Folder of an earlier run whose answers are given again; None to ask.
    """

    run: Path | None = None
    cache: Path | None = None
    replayed: Path | None = None

    def access(self, scene: str, index: int) -> ModelAccess:
        """What the model of one episode may use."""
        name = f"{episode_name(scene, index)}.jsonl"
        return ModelAccess(
            log=CallLog(None if self.run is None else self.run / CALLS / name),
            cache=self.cache,
            replay=None if self.replayed is None else Replay(self.replayed / CALLS / name),
            slots=None if self.run is None else self.run / CALLS / SLOTS,
        )


def check_replay(run: Path) -> None:
    """Make sure that a run can be replayed.

    Raises:
        InputError: It holds no calls of a model.
    """
    if not (run / CALLS).is_dir():
        raise InputError(f"{run}: no model was asked in this run, so there is nothing to replay")
