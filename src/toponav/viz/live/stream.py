"""Where a live recording goes: the viewer, a file, or both."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from toponav.errors import InputError, MissingExtraError
from toponav.files import temporary_beside
from toponav.viz.live.blueprint import blueprint
from toponav.viz.live.watcher import LiveWatcher

APPLICATION = "toponav"
SUFFIX = ".rrd"
VIEWER_MEMORY = "1GiB"
"""Beyond it the viewer forgets the oldest steps of a long run."""


@dataclass(frozen=True)
class LiveOptions:
    """What to show and keep; with neither, nothing is logged.

    Attributes:
        view: Open the viewer.
        record: File that gets the recording.
    """

    view: bool = False
    record: Path | None = None


@contextmanager
def watching(options: LiveOptions, target: str, name: str) -> Iterator[LiveWatcher | None]:
    """A watcher of one episode; None when nothing is asked for.

    The file is there, whole, when the block ends, also by an error.

    Args:
        options: Where the recording goes.
        target: Category searched for.
        name: Of the episode, for the viewer's list of recordings.

    Raises:
        MissingExtraError: Rerun is not installed.
        InputError: There is no display for the viewer, or the file is not called `.rrd`.
    """
    if not options.view and options.record is None:
        yield None
        return
    check(options)
    rr = import_rerun()
    stream = rr.RecordingStream(APPLICATION)
    stream.send_recording_name(name)
    temporary = None
    sinks: list[Any] = []
    if options.record is not None:
        options.record.parent.mkdir(parents=True, exist_ok=True)
        temporary = temporary_beside(options.record)
        sinks.append(rr.FileSink(temporary))
    if options.view:
        rr.spawn(connect=False, memory_limit=VIEWER_MEMORY, hide_welcome_screen=True)
        sinks.append(rr.GrpcSink())
    stream.set_sinks(*sinks, default_blueprint=blueprint(rr))
    try:
        yield LiveWatcher(rr, stream, target)
    finally:
        stream.flush()
        stream.disconnect()
        if temporary is not None and options.record is not None:
            temporary.replace(options.record)


def check(options: LiveOptions) -> None:
    """Make sure that a recording can go where it is wanted, before an episode is begun.

    Raises:
        MissingExtraError: Rerun is not installed.
        InputError: There is no display for the viewer, or the file is not called `.rrd`.
    """
    if not options.view and options.record is None:
        return
    import_rerun()
    if options.record is not None and options.record.suffix != SUFFIX:
        raise InputError(f"--record writes Rerun's files: call it {options.record.stem}{SUFFIX}")
    if options.view and not _has_display():
        raise InputError(
            "--view opens a window and there is no display here: write the search with --record "
            f"FILE{SUFFIX}, and open that with `rerun FILE{SUFFIX}` where there is one"
        )


def import_rerun() -> Any:
    """Rerun's module.

    Raises:
        MissingExtraError: It is not installed.
    """
    try:
        import rerun
        import rerun.blueprint
    except ImportError as error:
        raise MissingExtraError(
            "--view and --record need Rerun: pip install 'toponav[viz]'"
        ) from error
    return rerun


def _has_display() -> bool:
    windowed = sys.platform in {"darwin", "win32"}
    return windowed or any(os.environ.get(name) for name in ("DISPLAY", "WAYLAND_DISPLAY"))
