"""A recorded episode's exchanges, given back in order without any network."""

from __future__ import annotations

import json
from collections import defaultdict, deque
from pathlib import Path

from toponav.errors import InputError
from toponav.reasoning.vlm.exchange import Exchange, exchange_of


class Replay:
    """What was recorded of one episode, by prompt."""

    def __init__(self, path: Path) -> None:
        """Take a log that `CallLog` wrote; an episode without one asked nothing.

        Raises:
            InputError: As `read_exchanges`.
        """
        self._exchanges: defaultdict[str, deque[Exchange]] = defaultdict(deque)
        for exchange in read_exchanges(path) if path.exists() else ():
            self._exchanges[exchange.digest].append(exchange)

    def next(self, digest: str) -> Exchange | None:
        """What came of this prompt the next time it was asked; None if it was not."""
        waiting = self._exchanges[digest]
        return waiting.popleft() if waiting else None


def read_exchanges(path: Path) -> list[Exchange]:
    """The exchanges of a log, in order; a last line that a kill cut short is left out.

    Raises:
        InputError: A line is no exchange.
    """
    lines = path.read_text(encoding="utf-8").split("\n")[:-1]
    exchanges = []
    for number, line in enumerate(lines, start=1):
        exchange = _exchange(line)
        if exchange is None:
            raise InputError(f"{path}, line {number}: not a recorded exchange with a model")
        exchanges.append(exchange)
    return exchanges


def _exchange(line: str) -> Exchange | None:
    try:
        data = json.loads(line)
    except ValueError:
        return None
    if not isinstance(data, dict):
        return None
    known = {key: data[key] for key in Exchange.__dataclass_fields__ if key in data}
    return exchange_of(known)
