"""Named implementations of a seam: methods, detectors, reasoners; a user's own come from a file."""

from __future__ import annotations

import importlib.util
import sys
from collections.abc import Callable, Sequence
from difflib import get_close_matches
from pathlib import Path
from typing import Generic, TypeVar

from toponav.errors import InputError

T = TypeVar("T")

IN_FILE = ".py:"
"""Between the file and the name, as in `my_agent.py:wall-follower`."""


class Registry(Generic[T]):
    """Maps names to factories; an unknown name is an error that lists the known ones.

    `FILE.py:NAME` is what that file registers as NAME; the file is run, once.
    """

    def __init__(self, kind: str) -> None:
        """Create an empty registry of `kind`, the noun used in messages ("method", ...)."""
        self._kind = kind
        self._entries: dict[str, T] = {}

    def register(self, name: str) -> Callable[[T], T]:
        """Decorator that enters a factory under `name`."""

        def enter(entry: T) -> T:
            if name in self._entries:
                raise ValueError(f"{self._kind} {name!r} is registered twice")
            self._entries[name] = entry
            return entry

        return enter

    def get(self, name: str) -> T:
        """The factory called `name`.

        Raises:
            InputError: No such name, and the message lists those known; or the file that it names
                cannot be run.
        """
        file, inside, own = name.partition(IN_FILE)
        if inside:
            run_once(Path(file + IN_FILE.rstrip(":")))
        wanted = own if inside else name
        if wanted not in self._entries:
            raise unknown(self._kind, wanted, self.names())
        return self._entries[wanted]

    def names(self) -> list[str]:
        """All names, sorted."""
        return sorted(self._entries)


def unknown(kind: str, name: str, known: Sequence[str]) -> InputError:
    """What to say of a name that is none of those known, and of the nearest one."""
    hint = get_close_matches(name, known, n=1)
    did_you_mean = f" (did you mean {hint[0]!r}?)" if hint else ""
    return InputError(f"unknown {kind} {name!r}{did_you_mean}; known: {', '.join(known)}")


def run_once(path: Path) -> None:
    """Run a user's file as a module, unless this process has.

    Raises:
        InputError: There is no such file, or it fails; the message says where.
    """
    name = f"toponav_user.{path.resolve()}"
    if name in sys.modules:
        return
    spec = importlib.util.spec_from_file_location(name, path)
    if spec is None or spec.loader is None or not path.is_file():
        raise InputError(f"there is no file {path}")
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    try:
        spec.loader.exec_module(module)
    except Exception as error:
        del sys.modules[name]
        raise InputError(f"{path} fails: {type(error).__name__}: {error}") from error
