"""No more requests at once than a server likes, over all workers of a machine."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Iterator
from pathlib import Path

POLL_S = 0.05


class Slots:
    """So many files; whoever holds the lock of one may send a request."""

    def __init__(self, folder: Path | None, count: int) -> None:
        """Share `count` slots with everybody who knows the folder; without one there is no limit.

        The locks go with the processes that hold them, however these end.
        """
        self._folder = folder
        self._count = count

    @contextlib.contextmanager
    def one(self, deadline: float) -> Iterator[None]:
        """Hold a slot; after `deadline`, in `time.monotonic`, without one."""
        try:
            import fcntl
        except ImportError:  # Windows has no such lock, and no such limit
            fcntl = None  # type: ignore[assignment]
        if self._folder is None or fcntl is None:
            yield
            return
        self._folder.mkdir(parents=True, exist_ok=True)
        with contextlib.ExitStack() as stack:
            streams = [
                stack.enter_context((self._folder / f"{k}.lock").open("ab"))
                for k in range(self._count)
            ]
            while time.monotonic() < deadline:
                for stream in streams:
                    with contextlib.suppress(OSError):
                        fcntl.flock(stream, fcntl.LOCK_EX | fcntl.LOCK_NB)
                        yield
                        return
                time.sleep(POLL_S)
            yield
