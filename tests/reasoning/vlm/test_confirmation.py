"""The marked candidate and what is asked about it."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.ndimage import binary_dilation

from toponav.reasoning.vlm.confirmation_prompt import confirmation_prompt, taken_for
from toponav.reasoning.vlm.marked_candidate import (
    CROP_SIDE,
    OUTLINE,
    MarkedCandidate,
    mark_candidate,
)
from toponav.reasoning.vlm.prompt import ImagePart, PromptConfig

IMAGE = np.random.default_rng(0).integers(0, 200, (60, 80, 3), np.uint8)


def box(top: int, left: int, height: int, width: int) -> np.ndarray:
    mask = np.zeros(IMAGE.shape[:2], np.bool_)
    mask[top : top + height, left : left + width] = True
    return mask


@given(st.integers(0, 50), st.integers(0, 70), st.integers(1, 10), st.integers(1, 10))
def test_the_line_is_round_the_object_and_hides_nothing_of_it(
    top: int, left: int, height: int, width: int
) -> None:
    mask = box(top, left, height, width)
    marked = mark_candidate(IMAGE, mask)
    pink = (marked.context == OUTLINE).all(axis=-1)
    np.testing.assert_array_equal(pink, binary_dilation(mask) & ~mask)
    np.testing.assert_array_equal(marked.context[~pink], IMAGE[~pink])
    assert max(marked.crop.shape[:2]) == CROP_SIDE
    assert (marked.crop == OUTLINE).all(axis=-1).any()


def test_an_object_that_fills_the_image_is_marked_inside() -> None:
    marked = mark_candidate(IMAGE, np.ones(IMAGE.shape[:2], np.bool_))
    pink = (marked.context == OUTLINE).all(axis=-1)
    assert pink[0].all()
    assert not pink[30, 40]


def test_the_close_view_shows_the_object_with_a_margin() -> None:
    image = np.zeros((60, 80, 3), np.uint8)
    image[20:40, 30:50] = 250
    crop = mark_candidate(image, box(20, 30, 20, 20)).crop
    assert crop.shape[:2] == (CROP_SIDE, CROP_SIDE)
    bright = (crop > 240).all(axis=-1).mean()
    assert bright == pytest.approx((20 / 34) ** 2, abs=0.03)


def test_what_is_often_taken_for_the_target_is_named() -> None:
    assert taken_for("sofa")[:2] == ("armchair", "seating")
    assert taken_for("unheard of") == ()
    candidate = MarkedCandidate(IMAGE, IMAGE)
    asked = confirmation_prompt(candidate, "sofa", PromptConfig())
    assert "armchair, seating" in asked.text
    assert list(asked.schema["properties"]) == ["reason", "is_target"]
    assert [part.detail for part in asked.parts if isinstance(part, ImagePart)] == ["low", "high"]
    assert "mistaken" not in confirmation_prompt(candidate, "xyz", PromptConfig()).text
