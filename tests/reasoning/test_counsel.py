"""Answers at once, in a thread, and after a simulated latency."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable

import pytest
from test_prior import star, view

from toponav.errors import ReasonerError
from toponav.memory.snapshot import NodeView
from toponav.reasoning.base import Query
from toponav.reasoning.counsel import CounselConfig, InBackground, Simulated, Waiting, counsel
from toponav.reasoning.prior import PriorReasoner
from toponav.reasoning.schema import Guidance

PRIOR = PriorReasoner()


def question(target: str = "bed") -> Query:
    return Query(target, star(NodeView(1, (0.0, 0.0), 0, (), "attic", 5, 1)), (view(),))


class Named(PriorReasoner):
    """Signs its answers with what it was asked for, once it may."""

    def __init__(self, gate: Callable[[str], object] = lambda target: None) -> None:
        super().__init__()
        self._gate = gate

    def decide(self, query: Query) -> Guidance:
        self._gate(query.target)
        return super().decide(query).model_copy(update={"reason": query.target})


def eventually(attempt: Callable[[], Guidance | None]) -> Guidance:
    deadline = time.monotonic() + 30.0
    while time.monotonic() < deadline:
        answer = attempt()
        if answer is not None:
            return answer
        time.sleep(0.005)
    raise AssertionError("no answer came")


def test_without_a_wait_nothing_is_late() -> None:
    waiting = Waiting(Named())
    assert waiting.ask(question(), 0.0).reason == "bed"
    assert not waiting.pending
    assert waiting.late(1e9) is None


def test_a_thread_answers_while_the_stand_in_is_gone_by() -> None:
    gate = threading.Event()
    background = InBackground(Named(lambda target: gate.wait(30.0)), PRIOR)
    assert background.ask(question(), 0.0) == PRIOR.decide(question())
    assert background.pending
    assert background.late(1e9) is None
    gate.set()
    assert eventually(lambda: background.late(0.0)).reason == "bed"
    assert not background.pending
    assert background.late(0.0) is None
    background.close()


def test_an_answer_to_an_older_question_is_never_heard() -> None:
    gates = {"bed": threading.Event(), "sofa": threading.Event()}
    background = InBackground(Named(lambda target: gates[target].wait(30.0)), PRIOR)
    background.ask(question("bed"), 0.0)
    background.ask(question("sofa"), 1.0)
    gates["bed"].set()
    time.sleep(0.05)
    assert background.late(2.0) is None
    assert background.pending
    gates["sofa"].set()
    assert eventually(lambda: background.late(2.0)).reason == "sofa"
    background.close()


def test_an_error_in_the_thread_is_raised_where_the_answer_is_wanted() -> None:
    def fail(target: str) -> None:
        raise ReasonerError(f"no {target}")

    background = InBackground(Named(fail), PRIOR)
    background.ask(question(), 0.0)
    with pytest.raises(ReasonerError, match="no bed"):
        eventually(lambda: background.late(0.0))
    background.close()


def test_closing_waits_for_nobody() -> None:
    gate = threading.Event()
    background = InBackground(Named(lambda target: gate.wait(30.0)), PRIOR)
    background.ask(question(), 0.0)
    started = time.monotonic()
    background.close()
    assert not background.pending
    assert time.monotonic() - started < 10.0
    gate.set()


def test_a_simulated_answer_comes_when_its_time_has_come() -> None:
    simulated = Simulated(Named(), PRIOR, latency_s=8.0)
    assert simulated.ask(question(), 100.0) == PRIOR.decide(question())
    assert simulated.late(107.9) is None
    assert simulated.pending
    answer = simulated.late(108.0)
    assert answer is not None
    assert answer.reason == "bed"
    assert simulated.late(200.0) is None
    simulated.ask(question("bed"), 200.0)
    simulated.ask(question("sofa"), 206.0)
    assert simulated.late(208.0) is None
    newest = simulated.late(214.0)
    assert newest is not None
    assert newest.reason == "sofa"


def test_the_configuration_says_which() -> None:
    modes = {"wait": Waiting, "background": InBackground, "simulated": Simulated}
    for mode, kind in modes.items():
        made = counsel(PRIOR, PRIOR, CounselConfig.model_validate({"mode": mode}))
        assert isinstance(made, kind)
        made.close()
