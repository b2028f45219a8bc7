"""Reading and writing house files: strict on the way in, stable and atomic on the way out."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from toponav.errors import SceneError
from toponav.files import write_atomic
from toponav.scenes.house import HOUSE_FORMAT, House
from toponav.scenes.schema_errors import describe_schema_error
from toponav.scenes.validation import validate_house

_LINE_WIDTH = 100
"""A JSON value that fits is written on one line."""


def read_text(path: Path) -> str:
    """The text of a scene file.

    Raises:
        SceneError: It does not exist, cannot be read or is not text.
    """
    try:
        return path.read_text(encoding="utf-8-sig")
    except FileNotFoundError:
        raise SceneError(f"{path}: no such file") from None
    except UnicodeDecodeError as error:
        raise SceneError(
            f"{path}: not a text file ({error.reason} at byte {error.start})"
        ) from None
    except OSError as error:
        raise SceneError(f"{path}: cannot be read: {error.strerror}") from None


def load_house(path: Path | str) -> House:
    """Read a house file.

    Args:
        path: A file in the format `toponav-house/1`.

    Raises:
        SceneError: One line with the file, the JSON path and the problem.
    """
    path = Path(path)
    return parse_house(read_text(path), path)


def parse_house(text: str, path: Path) -> House:
    """The house in `text`, the content of the file `path`; object meshes lie beside that file.

    Raises:
        SceneError: As `load_house`.
    """
    try:
        house = House.model_validate_json(text, strict=True)
    except ValidationError as error:
        if any(detail["loc"] == ("format",) for detail in error.errors(include_url=False)):
            raise SceneError(
                f"{path}: format: this release reads {HOUSE_FORMAT!r} and nothing else"
            ) from None
        raise SceneError(f"{path}: {describe_schema_error(error, House)}") from None
    if "format" not in house.model_fields_set:
        raise SceneError(f'{path}: format: missing; write "format": "{HOUSE_FORMAT}"')
    try:
        validate_house(house, path.parent)
    except SceneError as error:
        raise SceneError(f"{path}: {error}") from None
    return house


def save_house(house: House, path: Path | str) -> None:
    """Write a house file, replacing an older one in a single step.

    The same house always gives the same bytes, one room, opening or object a line, so that
    versions compare well.

    Raises:
        SceneError: The house is inconsistent, or the file cannot be written.
    """
    path = Path(path)
    validate_house(house)
    replace_file(path, house_to_json(house))


def house_to_json(house: House) -> str:
    """The text of a house file."""
    return _formatted(house.model_dump(mode="json"), "") + "\n"


def replace_file(path: Path, content: str | bytes) -> None:
    """Write a scene file whole or not at all.

    Raises:
        SceneError: The folder or the file cannot be written.
    """
    try:
        write_atomic(path, content)
    except OSError as error:
        raise SceneError(f"{path}: cannot be written: {error.strerror}") from None


def _formatted(value: Any, indent: str) -> str:
    """JSON with every value on one line that fits there; longer ones have one item a line."""
    line = json.dumps(value, ensure_ascii=False)
    is_container = isinstance(value, dict | list)
    if not is_container or not value or len(indent) + len(line) <= _LINE_WIDTH:
        return line
    inner = indent + " "
    if isinstance(value, dict):
        items = [f"{json.dumps(key)}: {_formatted(item, inner)}" for key, item in value.items()]
        opening, closing = "{}"
    else:
        items = [_formatted(item, inner) for item in value]
        opening, closing = "[]"
    return opening + "\n" + inner + f",\n{inner}".join(items) + "\n" + indent + closing
