"""Answers on disk: a question that was answered once is not asked again."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path
from typing import Any

from toponav.files import write_atomic


class AnswerCache:
    """Usable answers by question and model, shared by all processes that know the folder."""

    def __init__(self, folder: Path | None, model: str, settings: dict[str, Any]) -> None:
        """Keep answers in `folder`; without one there is no cache.

        Args:
            folder: Made when the first answer is kept.
            model: Who answers.
            settings: What else an answer depends on, such as the temperature.
        """
        self._folder = folder
        self._model = json.dumps([model, settings], sort_keys=True)

    def get(self, digest: str) -> str | None:
        """The answer to a prompt of that digest, or None; a file that cannot be read is none."""
        if self._folder is None:
            return None
        try:
            answer = json.loads(self._path(digest).read_text(encoding="utf-8"))["answer"]
        except (OSError, ValueError, KeyError, TypeError):
            return None
        return answer if isinstance(answer, str) else None

    def put(self, digest: str, answer: str) -> None:
        """Keep an answer."""
        if self._folder is not None:
            record = {"model": self._model, "prompt": digest, "answer": answer}
            write_atomic(self._path(digest), json.dumps(record) + "\n")

    def _path(self, digest: str) -> Path:
        assert self._folder is not None
        name = hashlib.sha256(f"{self._model} {digest}".encode()).hexdigest()[:32]
        return self._folder / name[:2] / f"{name}.json"
