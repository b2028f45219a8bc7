"""Pydantic's validation errors as one line: the path in the file, what is wrong, what to write."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, get_args

from pydantic import BaseModel, ValidationError

_SHOWN_VALUE_CHARACTERS = 40
"""A wrong value is quoted up to this length."""


def json_path(location: Sequence[int | str]) -> str:
    """`("levels", 0, "rooms", 2)` as `levels[0].rooms[2]`."""
    path = ""
    for part in location:
        path += f"[{part}]" if isinstance(part, int) else f".{part}" if path else part
    return path


def describe_schema_error(error: ValidationError, model: type[BaseModel]) -> str:
    """The first problem of `error` as one line `path: what is wrong`, and how many more there are.

    Args:
        error: What validating against `model` raised.
        model: The root model, for naming the keys that an unknown one could have been.
    """
    details = error.errors(include_url=False)
    first = details[0]
    location = first["loc"]
    if first["type"] == "extra_forbidden":
        known = ", ".join(_model_at(model, location[:-1]).model_fields)
        problem = f"unknown key; known keys: {known}"
    elif first["type"] == "missing":
        problem = "missing"
    elif first["type"] == "json_invalid":
        problem = "not JSON: " + str(first["ctx"]["error"])
    else:
        message = first["msg"][:1].lower() + first["msg"][1:]
        problem = f"{message}, not {_shown(first['input'])}"
    path = json_path(location)
    more = f" (and {len(details) - 1} more)" if len(details) > 1 else ""
    return f"{path}: {problem}{more}" if path else f"{problem}{more}"


def _shown(value: Any) -> str:
    text = " ".join(repr(value).split())
    if len(text) <= _SHOWN_VALUE_CHARACTERS:
        return text
    return text[: _SHOWN_VALUE_CHARACTERS - 3] + "..."


def _model_at(model: type[BaseModel], location: Sequence[int | str]) -> type[BaseModel]:
    """The model that validates the object at `location`; indices and dict keys are passed over."""
    for part in location:
        field = model.model_fields.get(part) if isinstance(part, str) else None
        if field is None:
            continue
        inner = _first_model(field.annotation)
        if inner is not None:
            model = inner
    return model


def _first_model(annotation: Any) -> type[BaseModel] | None:
    """The model inside an annotation such as `list[Model]` or `Model | None`."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    for argument in get_args(annotation):
        inner = _first_model(argument)
        if inner is not None:
            return inner
    return None
