"""Named implementations of a seam: methods, detectors, reasoners."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from difflib import get_close_matches
from typing import Generic, TypeVar

from toponav.errors import InputError

T = TypeVar("T")


class Registry(Generic[T]):
    """Maps names to factories; an unknown name is an error that lists the known ones."""

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
            InputError: No such name; the message lists those known.
        """
        if name not in self._entries:
            raise unknown(self._kind, name, self.names())
        return self._entries[name]

    def names(self) -> list[str]:
        """All names, sorted."""
        return sorted(self._entries)


def unknown(kind: str, name: str, known: Sequence[str]) -> InputError:
    """What to say of a name that is none of those known, and of the nearest one."""
    hint = get_close_matches(name, known, n=1)
    did_you_mean = f" (did you mean {hint[0]!r}?)" if hint else ""
    return InputError(f"unknown {kind} {name!r}{did_you_mean}; known: {', '.join(known)}")
