"""The base of every configuration class: frozen, unknown keys rejected, docstrings as help."""

from __future__ import annotations

from pydantic import BaseModel, ConfigDict


class ConfigModel(BaseModel):
    """A frozen set of parameters that lives beside the class it configures.

    Attribute docstrings are the help of the command line; every default works as it is.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", use_attribute_docstrings=True)
