"""What a model is asked: golden texts, budgets, and names that try to give orders."""

from __future__ import annotations

import json
import os
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from queries import large_query, small_query

from toponav.reasoning.base import SeenObject
from toponav.reasoning.vlm.affinity_prompt import affinity_prompt
from toponav.reasoning.vlm.guidance_prompt import guidance_prompt, panorama_image, room_prompt
from toponav.reasoning.vlm.panorama_sheet import SheetLayout
from toponav.reasoning.vlm.prompt import ImagePart, Prompt, PromptConfig
from toponav.reasoning.vlm.tokens import image_tokens, text_tokens

GOLDEN = Path(__file__).resolve().parents[2] / "golden"
CONFIG = PromptConfig()
TEXT_ONLY = PromptConfig(images=False)


def as_text(prompt: Prompt) -> str:
    """All of a prompt, for people: images by their sizes."""
    parts = [
        f"[image {part.image.shape[1]} x {part.image.shape[0]}, {part.detail} detail]"
        if isinstance(part, ImagePart)
        else part.text
        for part in prompt.parts
    ]
    schema = f"schema: {json.dumps(prompt.schema)}"
    cost = f"about {prompt.tokens} tokens; left out: {', '.join(prompt.left_out) or 'nothing'}"
    return "\n\n".join([*parts, schema, cost]) + "\n"


@pytest.mark.parametrize(
    ("name", "prompt"),
    [
        ("guidance_small", guidance_prompt(small_query(), CONFIG)),
        ("guidance_text_only", guidance_prompt(small_query(), TEXT_ONLY)),
        ("guidance_200_places", guidance_prompt(large_query(), CONFIG)),
        ("room", room_prompt(small_query().panorama, CONFIG)),
        ("rooms", affinity_prompt("tv_monitor", ["kitchen", "living room"], "rooms")),
        ("objects", affinity_prompt("bed", ["nightstand", "sofa"], "objects")),
    ],
)
def test_prompts_are_those_that_were_looked_at(name: str, prompt: Prompt) -> None:
    """`TOPONAV_WRITE_GOLDEN=1` writes them anew, to be read before they are committed."""
    path = GOLDEN / f"prompt_{name}.txt"
    if os.environ.get("TOPONAV_WRITE_GOLDEN"):
        path.write_text(as_text(prompt), encoding="utf-8")
    assert as_text(prompt) == path.read_text(encoding="utf-8")


@pytest.mark.parametrize("max_tokens", [1600, 2000, 2500, 3000, 4000, 8000])
@pytest.mark.parametrize("images", [True, False])
def test_two_hundred_places_fit_any_budget_and_what_is_left_out_is_told(
    max_tokens: int, images: bool
) -> None:
    prompt = guidance_prompt(large_query(), PromptConfig(max_tokens=max_tokens, images=images))
    assert prompt.tokens <= max_tokens
    omitted = 200 - len(prompt.schema["properties"]["node_id"]["enum"])
    assert f"{omitted} of 200 places" in prompt.left_out
    assert f"{omitted} further places omitted." in prompt.text


def test_a_larger_budget_never_tells_less() -> None:
    budgets = [PromptConfig(max_tokens=n) for n in range(1600, 6000, 100)]
    prompts = [guidance_prompt(large_query(), budget) for budget in budgets]
    told = [len(prompt.schema["properties"]["node_id"]["enum"]) for prompt in prompts]
    assert told == sorted(told)
    assert told[0] < told[-1]


def test_only_what_was_shown_may_be_answered() -> None:
    schema = guidance_prompt(small_query(), CONFIG).schema
    assert schema["properties"]["node_id"]["enum"] == [1, 2]
    assert schema["properties"]["direction"]["enum"] == [0, 1, 2]
    assert schema["required"] == list(schema["properties"])
    assert next(iter(schema["properties"])) == "reason"


def test_the_room_is_asked_for_once() -> None:
    apart = PromptConfig(two_calls=True)
    assert "room_type" in guidance_prompt(small_query(), CONFIG).schema["properties"]
    assert "room_type" not in guidance_prompt(small_query(), apart).schema["properties"]
    assert "room_type" not in guidance_prompt(small_query(), apart).text
    assert list(room_prompt(small_query().panorama, apart).schema["properties"]) == [
        "reason",
        "room_type",
    ]


@settings(max_examples=50)
@given(st.text(max_size=200))
def test_a_name_stays_one_short_item_of_its_line(name: str) -> None:
    plain = guidance_prompt(small_query(), TEXT_ONLY)
    named = guidance_prompt(small_query("tv_monitor", SeenObject(name, 0.5, 1.0)), TEXT_ONLY)
    assert named.text.count("\n") == plain.text.count("\n")
    assert len(named.text) <= len(plain.text) + 60
    wanted = guidance_prompt(small_query(name), TEXT_ONLY)
    assert wanted.text.count("\n") == plain.text.count("\n")


def test_the_same_question_has_the_same_digest_and_another_pixel_another() -> None:
    first, again = (guidance_prompt(small_query(), CONFIG) for _ in range(2))
    assert first.digest == again.digest
    changed = small_query()
    changed.panorama[2].image[0, 0] = 255
    assert guidance_prompt(changed, CONFIG).digest != first.digest
    assert guidance_prompt(small_query("bed"), CONFIG).digest != first.digest


def test_the_sheet_shows_every_view_in_order() -> None:
    query = large_query()
    sheet = panorama_image(query.panorama, PromptConfig(view_width=80)).image
    layout = SheetLayout(count=12, width=80, height=60, lines=1)
    assert sheet.shape[1::-1] == layout.size
    corners = [layout.corner(k) for k in range(12)]
    rows = np.array([sheet[top + 10, left + 40] for left, top in corners])
    shades = [seen.image[0, 0] for seen in query.panorama]
    np.testing.assert_array_equal(rows, shades)


def test_image_tokens_are_those_of_the_published_rule() -> None:
    assert image_tokens(1024, 1024, "high") == 765
    assert image_tokens(2048, 4096, "high") == 1105
    assert image_tokens(4096, 8192, "low") == 85
    assert image_tokens(100, 100, "high") == 255


def test_text_tokens_err_on_the_high_side() -> None:
    assert text_tokens("place 12 (3.4 m away)") >= 6
    assert text_tokens("") == 0
