"""Where a search failed: the first stage that it did not reach.

A search passes its stages in order: the target comes into view, the detector finds it, the agent
sets out for it, the agent stops at it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

NEVER_VISIBLE = "never visible"
NOT_DETECTED = "visible but not detected"
NOT_APPROACHED = "detected but not approached"
NO_STOP = "approached but no stop"
WRONG_THING = "stopped on the wrong thing"
TOO_FAR = "stopped too far"
STEP_LIMIT = "step limit"
STUCK = "stuck"
ERROR = "error"

FAILURES = (
    NEVER_VISIBLE, NOT_DETECTED, NOT_APPROACHED, NO_STOP, WRONG_THING, TOO_FAR, STEP_LIMIT, STUCK,
    ERROR,
)  # fmt: skip
"""Every failure, in the order in which a search can meet them."""

TOO_FAR_M = 2.0
"""A stop that misses a viewpoint by less than this was at the target, but not near enough."""


@dataclass(frozen=True)
class SearchTrace:
    """When a search first reached each stage, in steps; None where it never did.

    Attributes:
        visible_step: The target was in view.
        detected_step: The detector found it where it is.
        approached_step: The agent set out for it.
        closest_m: Least distance to a viewpoint along the way, metres; infinite without a path.
    """

    visible_step: int | None = None
    detected_step: int | None = None
    approached_step: int | None = None
    closest_m: float = math.inf


@dataclass(frozen=True)
class SearchEnd:
    """How a search ended.

    Attributes:
        ended: "stop", "step-limit" or "error: ...".
        distance_to_goal: DTG, metres.
        approaching: The agent was on its way to what it took for the target.
        claimed: A stop meant "here it is" rather than "I give up".
        stuck: The agent had not got away from one spot for long.
    """

    ended: str
    distance_to_goal: float
    approaching: bool
    claimed: bool
    stuck: bool


def failure_of(trace: SearchTrace, end: SearchEnd) -> str:
    """Which of `FAILURES` an episode that did not succeed is.

    A stop that claims the target is judged by where it was made. An agent that ends on one spot is
    stuck. Any other search failed at the first stage that it missed; one that missed none ran out
    of steps on its way to the target, or turned away from it.
    """
    stopped = end.ended == "stop"
    if end.ended.startswith(ERROR):
        return ERROR
    if stopped and end.claimed:
        return TOO_FAR if end.distance_to_goal <= TOO_FAR_M else WRONG_THING
    if end.stuck and not stopped:
        return STUCK
    stages = (
        (trace.visible_step, NEVER_VISIBLE),
        (trace.detected_step, NOT_DETECTED),
        (trace.approached_step, NOT_APPROACHED),
    )
    missed = next((failure for step, failure in stages if step is None), None)
    if missed is not None:
        return missed
    return STEP_LIMIT if end.approaching and not stopped else NO_STOP
