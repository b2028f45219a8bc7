"""`episodes.jsonl`: results appended as they finish, and read back whatever ended the run."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from toponav.errors import InputError
from toponav.evaluation.results import EpisodeResult, from_json, to_json

EPISODES_FILE = "episodes.jsonl"


def read_results(folder: Path) -> list[EpisodeResult]:
    """The results in a run's folder, in the order in which they finished.

    A last line without its newline is what a kill left behind: it is no result yet.

    Raises:
        InputError: No such file, a line that is no result, or an episode that is there twice.
    """
    path = folder / EPISODES_FILE
    try:
        text = path.read_bytes()
    except OSError as error:
        raise InputError(
            f"{path}: {error.strerror}; give the --out folder of a toponav eval"
        ) from error
    results: dict[tuple[str, int], EpisodeResult] = {}
    whole = text[: text.rfind(b"\n") + 1]
    for number, line in enumerate(whole.split(b"\n")[:-1], start=1):
        where = f"{path}, line {number}"
        result = from_json(line.decode("utf-8", errors="replace"), where)
        if result.key in results:
            raise InputError(f"{where}: episode {result.scene} #{result.index} is there twice")
        results[result.key] = result
    return list(results.values())


class Journal:
    """The results of one run on the disk; one process at a time may append to them."""

    def __init__(self, folder: Path) -> None:
        """Keep the results in `folder`, which exists."""
        self.path = folder / EPISODES_FILE
        self._folder = folder

    def begun(self) -> bool:
        """Whether a run has written results here."""
        return self.path.exists() and self.path.stat().st_size > 0

    def repair(self) -> bool:
        """Cut off a last line that a kill left unfinished; says whether there was one."""
        size = self.path.stat().st_size
        with self.path.open("rb+") as stream:
            whole = stream.read().rfind(b"\n") + 1
            stream.truncate(whole)
        return whole < size

    def results(self) -> list[EpisodeResult]:
        """What is done so far.

        Raises:
            InputError: As `read_results`.
        """
        return read_results(self._folder)

    def append(self, result: EpisodeResult) -> None:
        """Write one result and flush it to the disk, so that a kill loses at most the next one.

        Raises:
            OSError: It cannot be written; it names the file, which is as it was before.
        """
        line = memoryview((to_json(result) + "\n").encode())
        with self.path.open("ab", buffering=0) as stream:
            end = stream.tell()
            try:
                while line:  # a full disk takes a part before it refuses
                    line = line[stream.write(line) :]
                os.fsync(stream.fileno())
            except OSError as error:
                os.truncate(self.path, end)
                raise OSError(error.errno, error.strerror, str(self.path)) from error

    @contextmanager
    def locked(self) -> Iterator[None]:
        """Hold the run's folder; the lock goes with the process, however it ends.

        Raises:
            InputError: Another process is running into the same folder.
        """
        try:
            import fcntl
        except ImportError:  # Windows has no such lock, and no such protection
            yield
            return
        with self.path.open("ab") as stream:
            try:
                fcntl.flock(stream, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except OSError as error:
                raise InputError(
                    f"{self._folder}: another toponav eval is writing here; wait for it or choose "
                    "another --out"
                ) from error
            yield
