"""Where a search failed: every bucket, and their order."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from toponav.evaluation import funnel
from toponav.evaluation.funnel import FAILURES, TOO_FAR_M, SearchEnd, SearchTrace, failure_of

BLIND = SearchTrace()
SEEN = SearchTrace(visible_step=3)
DETECTED = SearchTrace(visible_step=3, detected_step=4)
APPROACHED = SearchTrace(visible_step=3, detected_step=4, approached_step=5, closest_m=1.0)

LIMIT = SearchEnd("step-limit", 5.0, approaching=False, claimed=False, stuck=False)
GAVE_UP = replace(LIMIT, ended="stop")
CLAIMED = replace(GAVE_UP, claimed=True)


@pytest.mark.parametrize(
    ("trace", "end", "failure"),
    [
        (BLIND, LIMIT, funnel.NEVER_VISIBLE),
        (BLIND, GAVE_UP, funnel.NEVER_VISIBLE),
        (SEEN, LIMIT, funnel.NOT_DETECTED),
        (SEEN, GAVE_UP, funnel.NOT_DETECTED),
        (DETECTED, LIMIT, funnel.NOT_APPROACHED),
        (DETECTED, GAVE_UP, funnel.NOT_APPROACHED),
        (APPROACHED, replace(LIMIT, approaching=True), funnel.STEP_LIMIT),
        (APPROACHED, LIMIT, funnel.NO_STOP),
        (APPROACHED, GAVE_UP, funnel.NO_STOP),
        (APPROACHED, CLAIMED, funnel.WRONG_THING),
        (BLIND, CLAIMED, funnel.WRONG_THING),
        (APPROACHED, replace(CLAIMED, distance_to_goal=math.inf), funnel.WRONG_THING),
        (APPROACHED, replace(CLAIMED, distance_to_goal=0.3), funnel.TOO_FAR),
        (APPROACHED, replace(CLAIMED, distance_to_goal=TOO_FAR_M), funnel.TOO_FAR),
        (APPROACHED, replace(CLAIMED, distance_to_goal=TOO_FAR_M + 1e-9), funnel.WRONG_THING),
        (APPROACHED, replace(LIMIT, stuck=True, approaching=True), funnel.STUCK),
        (BLIND, replace(LIMIT, stuck=True), funnel.STUCK),
        (BLIND, replace(GAVE_UP, stuck=True), funnel.NEVER_VISIBLE),  # who gives up is not stuck
        (APPROACHED, replace(CLAIMED, ended="error: lost", stuck=True), funnel.ERROR),
    ],
)
def test_every_failure(trace: SearchTrace, end: SearchEnd, failure: str) -> None:
    assert failure_of(trace, end) == failure


def test_the_cases_above_meet_every_failure_there_is() -> None:
    [mark] = test_every_failure.pytestmark  # type: ignore[attr-defined]
    assert {case[2] for case in mark.args[1]} == set(FAILURES)
    assert len(FAILURES) == len(set(FAILURES)) == 9


steps = st.none() | st.integers(0, 500)
traces = st.builds(SearchTrace, steps, steps, steps, st.floats(0.0, 50.0))
ends = st.builds(
    SearchEnd,
    st.sampled_from(["stop", "step-limit", "error: x"]),
    st.floats(0.0, 50.0) | st.just(math.inf),
    st.booleans(), st.booleans(), st.booleans(),
)  # fmt: skip


@given(trace=traces, end=ends)
def test_the_failure_tells_what_did_not_happen(trace: SearchTrace, end: SearchEnd) -> None:
    failure = failure_of(trace, end)
    assert failure in FAILURES
    assert (failure == funnel.ERROR) == end.ended.startswith("error")
    if failure in (funnel.TOO_FAR, funnel.WRONG_THING):
        assert end.ended == "stop"
        assert (failure == funnel.TOO_FAR) == (end.distance_to_goal <= TOO_FAR_M)
    if failure in (funnel.STUCK, funnel.STEP_LIMIT):
        assert end.ended == "step-limit"
    missed = {
        funnel.NEVER_VISIBLE: trace.visible_step,
        funnel.NOT_DETECTED: trace.detected_step,
        funnel.NOT_APPROACHED: trace.approached_step,
    }
    assert missed.get(failure) is None
    if failure in (funnel.NO_STOP, funnel.STEP_LIMIT):
        assert None not in missed.values()
