"""When a reasoner's answer is had: at once, or while the agent walks on by a stand-in's."""

from __future__ import annotations

from concurrent.futures import Future, ThreadPoolExecutor
from typing import Literal, Protocol

from pydantic import Field

from toponav.config_model import ConfigModel
from toponav.reasoning.base import Query, Reasoner
from toponav.reasoning.schema import Guidance

THREADS = 4
"""Questions in flight: the newest and those that nobody waits for any more."""


class CounselConfig(ConfigModel):
    """How the agent waits for its reasoner."""

    mode: Literal["wait", "background", "simulated"] = "wait"
    """wait: stand still until the answer is there. background: walk on by the offline prior's
    guidance, and change course when the answer comes. simulated: the same, with a latency that is
    counted in the observations' time, for experiments that repeat."""

    latency_s: float = Field(default=8.0, ge=0.0)
    """Simulated latency of an answer, seconds of the observations' time."""


class Counsel(Protocol):
    """One question at a time; a new one makes the last one's answer worthless."""

    @property
    def pending(self) -> bool:
        """Whether the reasoner's own answer to the last question is still to come."""
        ...

    def ask(self, query: Query, now_s: float) -> Guidance:
        """What to go by until the reasoner's answer comes: that answer, if there is no wait.

        Raises:
            ReasonerError: As the reasoner.
        """
        ...

    def late(self, now_s: float) -> Guidance | None:
        """The reasoner's answer to the last question, once, when it has come since it was asked.

        Raises:
            ReasonerError: As the reasoner.
        """
        ...

    def close(self) -> None:
        """Nobody waits for anything any more."""
        ...


class Waiting:
    """The agent stands still meanwhile."""

    pending = False

    def __init__(self, reasoner: Reasoner) -> None:
        """Ask `reasoner`."""
        self._reasoner = reasoner

    def ask(self, query: Query, now_s: float) -> Guidance:
        """The answer."""
        del now_s
        return self._reasoner.decide(query)

    def late(self, now_s: float) -> None:
        """Never."""
        del now_s

    def close(self) -> None:
        """Nothing is held."""


class InBackground:
    """The reasoner thinks in a thread; real time, so that no two runs are the same."""

    def __init__(self, reasoner: Reasoner, stand_in: Reasoner) -> None:
        """Ask `reasoner`, and go by `stand_in` meanwhile."""
        self._reasoner = reasoner
        self._stand_in = stand_in
        self._threads = ThreadPoolExecutor(THREADS, thread_name_prefix="counsel")
        self._answer: Future[Guidance] | None = None

    @property
    def pending(self) -> bool:
        """Whether the last question has no answer yet."""
        return self._answer is not None

    def ask(self, query: Query, now_s: float) -> Guidance:
        """The stand-in's guidance."""
        del now_s
        self._forget()
        self._answer = self._threads.submit(self._reasoner.decide, query)
        return self._stand_in.decide(query)

    def late(self, now_s: float) -> Guidance | None:
        """The answer, once the thread has it."""
        del now_s
        if self._answer is None or not self._answer.done():
            return None
        answer, self._answer = self._answer, None
        return answer.result()

    def close(self) -> None:
        """Let the threads end by themselves."""
        self._forget()
        self._threads.shutdown(wait=False, cancel_futures=True)

    def _forget(self) -> None:
        if self._answer is not None:
            self._answer.cancel()
            self._answer = None


class Simulated:
    """As `InBackground`, but the answer comes a set time after the question."""

    def __init__(self, reasoner: Reasoner, stand_in: Reasoner, latency_s: float) -> None:
        """Ask `reasoner`, whose answers take `latency_s`, and go by `stand_in` meanwhile."""
        self._reasoner = reasoner
        self._stand_in = stand_in
        self._latency_s = latency_s
        self._answer: Guidance | None = None
        self._due_s = 0.0

    @property
    def pending(self) -> bool:
        """Whether the last answer has not been handed out."""
        return self._answer is not None

    def ask(self, query: Query, now_s: float) -> Guidance:
        """The stand-in's guidance."""
        self._answer = self._reasoner.decide(query)
        self._due_s = now_s + self._latency_s
        return self._stand_in.decide(query)

    def late(self, now_s: float) -> Guidance | None:
        """The answer, once its time has come."""
        if self._answer is None or now_s < self._due_s:
            return None
        answer, self._answer = self._answer, None
        return answer

    def close(self) -> None:
        """Nothing is held."""


def counsel(reasoner: Reasoner, stand_in: Reasoner, config: CounselConfig) -> Counsel:
    """The counsel of a configuration."""
    if config.mode == "background":
        return InBackground(reasoner, stand_in)
    if config.mode == "simulated":
        return Simulated(reasoner, stand_in, config.latency_s)
    return Waiting(reasoner)
