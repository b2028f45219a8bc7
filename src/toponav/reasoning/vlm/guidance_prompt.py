"""The prompt manager's main question: where to go next (Section III-E)."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from toponav.categories import readable
from toponav.memory.text import MemoryText, TextBudget, clean_name, retell
from toponav.reasoning.base import PanoramaView, Query
from toponav.reasoning.schema import Guidance
from toponav.reasoning.vlm.panorama_sheet import compose_sheet
from toponav.reasoning.vlm.prompt import (
    ImagePart,
    Prompt,
    PromptConfig,
    TextPart,
    closed_schema,
)

ROOM_ONLY = frozenset({"node_id", "direction", "target_found"})
SHRINK = 0.7
"""Factor by which the memory's text shrinks until a prompt fits its budget."""

TASK = """\
The robot looks for: "{target}".

What to answer:
- reason: one sentence on what speaks for your choice.
{room}\
- target_found: true only if the object itself, and not something like it, is to be seen in one \
of the views{images}.
- direction: the number of the view to walk towards: the one that shows the target, else the one \
that most probably leads to it.
- node_id: the number of the place round whose frontiers to search next: where the object is \
likely to be, much is still unseen, and the way is short. A frontier is where known floor meets \
the unknown; a place with none is searched."""
ROOM_TASK = "- room_type: the type of the room in which the robot stands, such as kitchen.\n"
VIEWS = """\
Views, taken while turning on the spot; each looks further to the left than the one before. \
Bearings and positions share one frame: 0 degrees is along x, 90 along y."""
NO_IMAGES = "There are no images: judge by what the detector reports."


@dataclass(frozen=True)
class _Limits:
    """How much is told, at one step of shrinking."""

    budget: TextBudget
    objects_per_view: int
    low_detail: bool = False


def guidance_prompt(query: Query, config: PromptConfig) -> Prompt:
    """The question for k', d_vlm, g_found and, unless asked apart, R.

    Within the budget as much is told as fits. What is left out, in this order: detections beyond
    the three surest of a view, closeness of the look at the images, places of the memory.
    """
    for limits in _ever_tighter(config):
        prompt = _compose(query, config, limits)
        if prompt.tokens <= config.max_tokens:
            return prompt
    return prompt


def room_prompt(panorama: Sequence[PanoramaView], config: PromptConfig) -> Prompt:
    """The question for R alone: R_k = Psi_VLM(V_t^panorama) (Section III-D)."""
    task = "What is the type of the room in which the robot stands, such as kitchen?"
    parts = (TextPart(task), TextPart(_views(panorama, config.objects_per_view)))
    images = (panorama_image(panorama, config),) if config.images else (TextPart(NO_IMAGES),)
    return Prompt("room", parts + images, closed_schema(Guidance, without=ROOM_ONLY))


def panorama_image(panorama: Sequence[PanoramaView], config: PromptConfig) -> ImagePart:
    """All views on one sheet, numbered as `Guidance.direction` counts them, with their bearings."""
    captions = [[f"view {k}: {_degrees(view)} deg"] for k, view in enumerate(panorama)]
    images = [view.image for view in panorama]
    sheet = compose_sheet(images, captions, config.view_width)
    return ImagePart(np.asarray(sheet), config.detail)


def _ever_tighter(config: PromptConfig) -> Iterator[_Limits]:
    """From all that may be told to the least."""
    limits = _Limits(TextBudget(), config.objects_per_view)
    yield limits
    limits = replace(limits, objects_per_view=min(3, config.objects_per_view))
    yield limits
    if config.images and config.detail == "high":
        limits = replace(limits, low_detail=True)
        yield limits
    shortest = TextBudget.model_fields["max_characters"].metadata[0].ge
    characters = float(limits.budget.max_characters)
    while characters > shortest:
        characters = max(shortest, characters * SHRINK)
        budget = limits.budget.model_copy(update={"max_characters": int(characters)})
        yield replace(limits, budget=budget)


def _compose(query: Query, config: PromptConfig, limits: _Limits) -> Prompt:
    memory = retell(query.memory, limits.budget)
    target = clean_name(readable(query.target))
    task = TASK.format(
        target=target,
        room="" if config.two_calls else ROOM_TASK,
        images="" if config.images else " by the detector's report",
    )
    parts: list[TextPart | ImagePart] = [
        TextPart(task),
        TextPart(memory.text),
        TextPart(f"{VIEWS}\n{_views(query.panorama, limits.objects_per_view)}"),
    ]
    if config.images:
        detail = config.model_copy(update={"detail": "low"}) if limits.low_detail else config
        parts.append(panorama_image(query.panorama, detail))
    else:
        parts.append(TextPart(NO_IMAGES))
    schema = closed_schema(
        Guidance,
        without=frozenset({"room_type"}) if config.two_calls else frozenset(),
        node_id=list(memory.told),
        direction=list(range(len(query.panorama))),
    )
    return Prompt("guidance", tuple(parts), schema, _left_out(query, memory, limits))


def _views(panorama: Sequence[PanoramaView], objects: int) -> str:
    """One line a view."""
    return "\n".join(_view_line(k, view, objects) for k, view in enumerate(panorama))


def _view_line(index: int, view: PanoramaView, objects: int) -> str:
    seen = ", ".join(
        f"{clean_name(item.label)} {item.score:.2f}"
        + (f" at {item.range_m:.1f} m" if math.isfinite(item.range_m) else "")
        for item in view.seen[:objects]
    )
    more = len(view.seen) - objects
    return (
        f"- view {index} ({_degrees(view)} deg): floor {view.navigable_area_m2:.1f} m2; "
        f"frontiers: {view.frontier_count}; detected: {seen or 'nothing'}"
        + (f" and {more} more" if more > 0 and objects else "")
    )


def _degrees(view: PanoramaView) -> int:
    return round(math.degrees(view.bearing)) % 360


def _left_out(query: Query, memory: MemoryText, limits: _Limits) -> tuple[str, ...]:
    """What the budget cost, in words."""
    omitted = []
    if memory.omitted:
        omitted.append(f"{memory.omitted} of {len(query.memory.nodes)} places")
    hidden = sum(max(0, len(view.seen) - limits.objects_per_view) for view in query.panorama)
    if hidden:
        omitted.append(f"{hidden} detections")
    if limits.low_detail:
        omitted.append("high image detail")
    return tuple(omitted)
