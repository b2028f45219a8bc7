"""What goes with what, asked of a model once a target: the affinities of rooms and of objects."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

from pydantic import BaseModel, ConfigDict

from toponav.categories import readable
from toponav.memory.text import clean_name
from toponav.reasoning.vlm.prompt import Prompt, TextPart, closed_schema

QUESTIONS = {
    "rooms": "In a building, how likely is it that a room of each of these types holds a {}?",
    "objects": "In a building, how likely is it that a {} is within two metres of each of these?",
}


class Affinities(BaseModel):
    """The answer; one number for each name, in the order given."""

    model_config = ConfigDict(frozen=True, extra="forbid", use_attribute_docstrings=True)

    likelihoods: list[float]
    """From 0 (never) to 1 (always), in the order of the names."""


def affinity_prompt(target: str, names: Sequence[str], kind: Literal["rooms", "objects"]) -> Prompt:
    """The question for `room_affinity` or `object_affinity`; text only.

    Args:
        target: Category name or free text.
        names: One or more rooms or objects.
        kind: Which.
    """
    question = QUESTIONS[kind].format(f'"{clean_name(readable(target))}"')
    listed = "\n".join(f"{k}. {clean_name(readable(name))}" for k, name in enumerate(names, 1))
    task = f"{question}\nAnswer with {len(names)} numbers from 0 to 1, in this order:\n{listed}"
    return Prompt(kind, (TextPart(task),), closed_schema(Affinities))
