"""Label tables: which parts of a mesh are objects, by name pattern.

A table is a JSON object of patterns and categories, such as `{"Bed_*": "bed", "Sofa*": "sofa"}`.
Patterns are those of shells (`*`, `?`, `[abc]`), match whole names whatever their case, and the
first that matches wins.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from fnmatch import fnmatchcase
from pathlib import Path

from toponav.categories import canonical
from toponav.errors import SceneError
from toponav.scenes.house_io import read_text


@dataclass(frozen=True)
class LabelTable:
    """Patterns with their categories, the first match first.

    Attributes:
        rules: (pattern, canonical category) pairs.
    """

    rules: tuple[tuple[str, str], ...] = ()

    def category(self, name: str) -> str | None:
        """The category of a part, or None when no pattern matches its name."""
        for pattern, category in self.rules:
            if fnmatchcase(name.lower(), pattern.lower()):
                return category
        return None


def load_label_table(path: Path | str) -> LabelTable:
    """Read a label table.

    Raises:
        SceneError: One line with the file and what is wrong in it.
    """
    path = Path(path)
    try:
        content = json.loads(read_text(path))
    except json.JSONDecodeError as error:
        raise SceneError(
            f"{path}: not JSON: {error.msg} at line {error.lineno} column {error.colno}"
        ) from None
    if not isinstance(content, dict) or not content:
        raise SceneError(f'{path}: a label table is a JSON object such as {{"Bed_*": "bed"}}')
    for pattern, category in content.items():
        if not isinstance(category, str) or not category.strip():
            raise SceneError(f"{path}: {pattern!r}: the category must be a name, not {category!r}")
    return LabelTable(tuple((pattern, canonical(name)) for pattern, name in content.items()))
