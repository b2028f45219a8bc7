"""Is it really what is looked for? The question about one marked candidate, before the stop."""

from __future__ import annotations

from pydantic import BaseModel, ConfigDict

from toponav.categories import canonical, readable
from toponav.memory.text import clean_name
from toponav.perception.lookalikes import LOOKALIKES
from toponav.reasoning.vlm.marked_candidate import MarkedCandidate
from toponav.reasoning.vlm.prompt import ImagePart, Prompt, PromptConfig, TextPart, closed_schema

MOST_COUNTEREXAMPLES = 5

TASK = """\
A detector takes the object with the pink outline for a "{target}". The first image shows it from \
close by, the second with what is around it.
What to answer:
- reason: one sentence on what the object is, by its form and its surroundings.
- is_target: true only if it really is a {target}.{counterexamples}"""


class Confirmation(BaseModel):
    """The answer."""

    model_config = ConfigDict(frozen=True, extra="forbid", use_attribute_docstrings=True)

    reason: str
    """One sentence for people."""

    is_target: bool
    """Whether the marked object is what is looked for."""


def confirmation_prompt(candidate: MarkedCandidate, target: str, config: PromptConfig) -> Prompt:
    """The question about one candidate; it needs a model that sees.

    Args:
        candidate: The marked object.
        target: Category name or free text.
        config: How closely the model looks.
    """
    name = clean_name(readable(target))
    others = [clean_name(readable(other)) for other in taken_for(target)]
    listed = f" Often mistaken for it: {', '.join(others)}." if others else ""
    return Prompt(
        "confirmation",
        (
            TextPart(TASK.format(target=name, counterexamples=listed)),
            ImagePart(candidate.crop, "low"),
            ImagePart(candidate.context, config.detail),
        ),
        closed_schema(Confirmation),
    )


def taken_for(target: str) -> tuple[str, ...]:
    """What is most often taken for a category, most often first."""
    category = canonical(target)
    rates = {thing: taken[category] for thing, taken in LOOKALIKES.items() if category in taken}
    ranked = sorted(rates, key=lambda thing: (-rates[thing], thing))
    return tuple(ranked[:MOST_COUNTEREXAMPLES])
