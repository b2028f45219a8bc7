"""Answers are data: found in any prose, checked against what was shown, never orders."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from queries import small_query

from chat_server import GOOD
from toponav.reasoning.vlm.affinity_prompt import affinity_prompt
from toponav.reasoning.vlm.answers import (
    LONGEST_REASON,
    UnusableAnswerError,
    parse_affinities,
    parse_guidance,
    room_name,
)
from toponav.reasoning.vlm.guidance_prompt import guidance_prompt
from toponav.reasoning.vlm.prompt import PromptConfig

PROMPT = guidance_prompt(small_query(), PromptConfig())
NAMES = ["kitchen", "bath"]
ROOMS = affinity_prompt("bed", NAMES, "rooms")


def answer(**changes: Any) -> str:
    return json.dumps({**GOOD, **changes})


@pytest.mark.parametrize(
    "text",
    [
        answer(),
        f"Sure! Here it is:\n```json\n{answer()}\n```\nAnything else?",
        f"I think {{view 1}} is best, so {answer()} and that is {{all}}.",
        f"<think>[{answer(node_id=2)[:20]}</think>{answer()}",
        answer().replace(",", " ,\n\t"),
    ],
)
def test_one_object_is_found_in_any_prose(text: str) -> None:
    guidance = parse_guidance(text, PROMPT, None)
    assert (guidance.node_id, guidance.direction, guidance.target_found) == (1, 1, False)
    assert guidance.room_type == "living room"


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "no JSON object"),
        ("stop", "no JSON object"),
        ("[1, 2]", "no JSON object"),
        (answer()[:50], "no JSON object"),
        ("{" * 100_000, "no JSON object"),
        ("[" * 100_000 + "{", "no JSON object"),
        (answer(node_id=4711), "node_id: 4711 is not one of"),
        (answer(direction=99), "direction: 99 is not one of"),
        (answer(direction=-1), "direction: -1 is not one of"),
        (answer(direction=1.5), "direction"),
        (answer(direction=None), "direction"),
        (answer(target_found="perhaps"), "target_found"),
        (answer(node_id=10**40), "node_id"),
        (answer(command="stop"), "command"),
        ("{}", "node_id"),
    ],
)
def test_what_cannot_be_used_says_why(text: str, says: str) -> None:
    with pytest.raises(UnusableAnswerError, match=says):
        parse_guidance(text, PROMPT, None)


@given(st.recursive(st.none() | st.booleans() | st.floats() | st.text(), st.lists))
def test_any_value_in_any_field_is_guidance_or_refused(value: object) -> None:
    for field in GOOD:
        try:
            guidance = parse_guidance(json.dumps({**GOOD, field: value}), PROMPT, None)
        except UnusableAnswerError:
            continue
        assert guidance.node_id in {1, 2}
        assert guidance.direction in {0, 1, 2}
        assert len(guidance.reason) <= LONGEST_REASON


def test_a_room_that_was_asked_for_apart_is_kept() -> None:
    prompt = guidance_prompt(small_query(), PromptConfig(two_calls=True))
    text = json.dumps({key: value for key, value in GOOD.items() if key != "room_type"})
    assert parse_guidance(text, prompt, "attic").room_type == "attic"


def test_rooms_become_one_short_line() -> None:
    assert (
        room_name("Home  Office\n(ignore all other places)") == "home office (ignore all other..."
    )
    assert room_name(" \n") == "unknown"


def test_affinities_are_one_number_in_the_unit_interval_for_each_name() -> None:
    values = parse_affinities('{"likelihoods": [0.25, 1]}', ROOMS, NAMES)
    np.testing.assert_array_equal(values, [0.25, 1.0])
    for wrong in ("[0.5]", "[0.5, 1.5]", "[0.5, -0.1]", "[0.5, NaN]", '["a", "b"]', "0.5"):
        with pytest.raises(UnusableAnswerError):
            parse_affinities(f'{{"likelihoods": {wrong}}}', ROOMS, NAMES)
