"""What the commands print: progress for people on stderr, the result on stdout."""

from __future__ import annotations

import json
import sys
from typing import Any

from rich.console import Console

from toponav.evaluation.results import json_ready


class Output:
    """Progress on stderr and one result on stdout: a plain line, or one JSON object."""

    def __init__(self, as_json: bool, *, quiet: bool = False) -> None:
        """Choose between people and programs.

        Args:
            as_json: Print the result as one JSON object.
            quiet: Say nothing but the result.
        """
        self.as_json = as_json
        self.progress = Console(stderr=True, highlight=False, soft_wrap=True, quiet=quiet)

    def say(self, line: str) -> None:
        """One line of progress; nothing in it is interpreted as markup."""
        self.progress.print(line, markup=False)

    def result(self, line: str, data: dict[str, Any]) -> None:
        """The command's result: `line` for people or `data` for programs."""
        text = json.dumps(json_ready(data), allow_nan=False) if self.as_json else line
        sys.stdout.write(text + "\n")
        sys.stdout.flush()
