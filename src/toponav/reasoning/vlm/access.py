"""What an episode's model may use on the disk."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from toponav.reasoning.vlm.call_log import CallLog
from toponav.reasoning.vlm.replay import Replay


@dataclass(frozen=True, eq=False)
class ModelAccess:
    """Ledger, cache, recording and limits of one episode.

    Attributes:
        log: Keeps every exchange.
        cache: Folder of answers that are not asked for again; None for no cache.
        replay: A recorded episode that answers in the model's stead; the network is not touched.
        slots: Folder of the slots that all workers of a run share; None for no limit.
    """

    log: CallLog = field(default_factory=CallLog)
    cache: Path | None = None
    replay: Replay | None = None
    slots: Path | None = None
