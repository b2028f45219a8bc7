"""`.semantic.txt`: the objects of an HM3D scene, one a line, with the colours that mark them."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from toponav.errors import SceneError
from toponav.scenes.house_io import read_text

HEADER = "HM3D Semantic Annotations"

_LINE = re.compile(r'\s*(\d+)\s*,\s*([0-9A-Fa-f]{1,6})\s*,\s*"([^"]*)"\s*,\s*(-?\d+)\s*')


@dataclass(frozen=True)
class SemanticObject:
    """One annotated object.

    Attributes:
        id: What Habitat's semantic sensor shows.
        color: sRGB, 0..255 each.
        category: The annotators' own name.
        region: Number of the room.
    """

    id: int
    color: tuple[int, int, int]
    category: str
    region: int


def read_semantic_text(path: Path) -> tuple[SemanticObject, ...]:
    """The objects of a scene, in the file's order.

    Raises:
        SceneError: One line with file and line number: not such a file, or two objects share an id.
    """
    lines = read_text(path).splitlines()
    if not lines or HEADER not in lines[0]:
        raise SceneError(f"{path}: does not begin with {HEADER!r}; fetch the annotations again")
    objects: dict[int, SemanticObject] = {}
    for number, line in enumerate(lines[1:], start=2):
        if not line.strip():
            continue
        match = _LINE.fullmatch(line)
        if match is None:
            raise SceneError(
                f'{path}: line {number}: {line.strip()!r} is not id,RRGGBB,"category",region'
            )
        item = int(match[1])
        if item in objects:
            raise SceneError(f"{path}: line {number}: a second object {item}")
        rgb = int(match[2], 16)
        color = (rgb >> 16, rgb >> 8 & 0xFF, rgb & 0xFF)
        objects[item] = SemanticObject(item, color, match[3].strip(), int(match[4]))
    return tuple(objects.values())


def semantic_text(objects: Sequence[SemanticObject]) -> str:
    """The file's content; a quotation mark cannot stand in a category and becomes an apostrophe."""
    lines = [HEADER]
    for item in objects:
        red, green, blue = item.color
        name = item.category.replace('"', "'")
        lines.append(f'{item.id},{red:02X}{green:02X}{blue:02X},"{name}",{item.region}')
    return "\n".join(lines) + "\n"
