"""How long is waited, what is asked again and what is not: a model that a test plays."""

from __future__ import annotations

import json
import random
import threading
import time
from collections.abc import Sequence
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from toponav.errors import InputError, ReasonerError
from toponav.reasoning.vlm.access import ModelAccess
from toponav.reasoning.vlm.affinity_prompt import affinity_prompt
from toponav.reasoning.vlm.answer_cache import AnswerCache
from toponav.reasoning.vlm.answers import UnusableAnswerError
from toponav.reasoning.vlm.call_log import CallLog
from toponav.reasoning.vlm.chat import ChatError, ChatReply, ChatRequest, FailureKind
from toponav.reasoning.vlm.circuit_breaker import CircuitBreaker, CircuitBreakerConfig
from toponav.reasoning.vlm.config import VlmConfig
from toponav.reasoning.vlm.model_client import Endpoint, ModelClient
from toponav.reasoning.vlm.prices import known_price, price_table
from toponav.reasoning.vlm.replay import Replay
from toponav.reasoning.vlm.retrying import RetryConfig, wait_before
from toponav.reasoning.vlm.slots import Slots

PROMPT = affinity_prompt("bed", ["kitchen"], "rooms")
OTHER = affinity_prompt("bed", ["attic"], "rooms")
BUSY = ChatError(FailureKind.RATE_LIMITED, "busy", retry_after_s=7.0)
DOWN = ChatError(FailureKind.SERVER_ERROR, "down")


class Played:
    """Says what it was told to say; an error is raised."""

    def __init__(self, *said: str | ChatError) -> None:
        self.said = list(said)
        self.requests: list[ChatRequest] = []

    def complete(self, request: ChatRequest, timeout_s: float) -> ChatReply:
        assert timeout_s > 0.0
        self.requests.append(request)
        said = self.said.pop(0)
        if isinstance(said, ChatError):
            raise said
        return ChatReply(said, 10, 2)


def number(text: str) -> int:
    if not text.isdecimal():
        raise UnusableAnswerError("not a number")
    return int(text)


def client(
    chat: Played, access: ModelAccess | None = None, waits: list[float] | None = None,
    config: VlmConfig | None = None,
) -> ModelClient:  # fmt: skip
    breaker = CircuitBreaker(CircuitBreakerConfig(), time.monotonic)
    wait = (waits if waits is not None else []).append
    return ModelClient(
        Endpoint(chat, breaker), config or VlmConfig(), access or ModelAccess(), sleep=wait
    )


def test_a_server_that_asks_for_patience_gets_it() -> None:
    waits: list[float] = []
    assert client(Played(BUSY, DOWN, "5"), waits=waits).ask(PROMPT, number) == 5
    assert waits[0] == 7.0
    assert 0.0 <= waits[1] <= 2.0


def test_no_wait_leads_beyond_the_deadline() -> None:
    waits: list[float] = []
    config = VlmConfig(retry=RetryConfig(deadline_s=5.0))
    with pytest.raises(ReasonerError, match="rate limited"):
        client(Played(BUSY), waits=waits, config=config).ask(PROMPT, number)
    assert waits == []


@given(st.integers(0, 60), st.integers(0, 1000), st.none() | st.floats(0.0, 100.0))
def test_waits_are_bounded_and_never_shorter_than_asked_for(
    retry: int, seed: int, asked: float | None
) -> None:
    config = RetryConfig()
    wait = wait_before(retry, config, random.Random(seed), asked)
    assert wait >= (asked or 0.0)
    assert wait <= max(asked or 0.0, min(config.longest_backoff_s, 2.0**retry))


def test_an_open_circuit_closes_with_the_first_success() -> None:
    now = [0.0]
    breaker = CircuitBreaker(CircuitBreakerConfig(failures=2, pause_s=10.0), lambda: now[0])
    breaker.failed()
    assert not breaker.is_open
    breaker.failed()
    assert breaker.is_open
    now[0] = 10.0
    assert not breaker.is_open
    breaker.failed()
    assert breaker.is_open  # the one that tried after the pause
    now[0] = 20.0
    breaker.succeeded()
    breaker.failed()
    assert not breaker.is_open
    breaker.break_now()
    assert breaker.is_open


def test_a_question_is_put_to_the_model_once_for_all_episodes(tmp_path: Path) -> None:
    chat = Played("5", "6")
    first, again = ModelAccess(cache=tmp_path), ModelAccess(cache=tmp_path)
    assert client(chat, first).ask(PROMPT, number) == 5
    assert client(chat, again).ask(PROMPT, number) == 5
    assert client(chat, again).ask(OTHER, number) == 6
    assert (first.log.usage().calls, first.log.usage().cached) == (1, 0)
    assert (again.log.usage().calls, again.log.usage().cached) == (1, 1)
    other_model = VlmConfig(model="another")
    with pytest.raises(IndexError):
        client(chat, again, config=other_model).ask(PROMPT, number)


def test_only_usable_answers_are_kept_and_damaged_ones_are_asked_again(tmp_path: Path) -> None:
    access = ModelAccess(cache=tmp_path)
    with pytest.raises(ReasonerError):
        client(Played("x", "y"), access).ask(PROMPT, number)
    assert list(tmp_path.rglob("*.json")) == []
    assert client(Played("5"), access).ask(PROMPT, number) == 5
    [path] = tmp_path.rglob("*.json")
    for damage in ("", "{", "[]", '{"answer": 5}', '{"answer": "x"}'):
        path.write_text(damage)
        assert client(Played("6"), access).ask(PROMPT, number) == 6
    assert AnswerCache(None, "m", {}).get("x") is None


def test_a_recorded_episode_is_given_again_in_order_failures_included(tmp_path: Path) -> None:
    path = tmp_path / "calls" / "a_0.jsonl"
    asked = client(Played("5", DOWN, "x", "y", "7"), ModelAccess(CallLog(path)))
    assert asked.ask(PROMPT, number) == 5
    with pytest.raises(ReasonerError, match="unusable"):
        asked.ask(PROMPT, number)
    assert asked.ask(OTHER, number) == 7

    access = ModelAccess(replay=Replay(path))
    again = client(Played(), access)
    assert again.ask(OTHER, number) == 7
    assert again.ask(PROMPT, number) == 5
    with pytest.raises(ReasonerError, match="unusable"):
        again.ask(PROMPT, number)
    with pytest.raises(ReasonerError, match="not recorded"):
        again.ask(PROMPT, number)
    usage, recorded = access.log.usage(), asked._access.log.usage()
    assert usage.calls == recorded.calls == 5
    assert usage.cost_usd == recorded.cost_usd > 0.0
    assert (usage.not_recorded, recorded.not_recorded) == (1, 0)


def test_a_recording_tells_all_that_was_asked(tmp_path: Path) -> None:
    path = tmp_path / "a_0.jsonl"
    client(Played("5"), ModelAccess(CallLog(path))).ask(PROMPT, number)
    line = json.loads(path.read_text())
    assert line["text"] == PROMPT.text
    assert line["answer"] == line["attempts"][0]["answer"] == "5"
    assert line["estimated_tokens"] == PROMPT.tokens


def test_a_damaged_recording_is_named_and_one_that_was_cut_short_is_used(tmp_path: Path) -> None:
    path = tmp_path / "a_0.jsonl"
    asked = client(Played("5", "7"), ModelAccess(CallLog(path)))
    asked.ask(PROMPT, number)
    asked.ask(OTHER, number)
    whole = path.read_text()
    path.write_text(whole[:-20])
    assert client(Played(), ModelAccess(replay=Replay(path))).ask(PROMPT, number) == 5
    for damage in ("{}", "[]", "nonsense", '{"prompt": 1}'):
        path.write_text(f"{damage}\n{whole}")
        with pytest.raises(InputError, match="line 1: not a recorded exchange"):
            Replay(path)


def test_no_more_requests_at_once_than_slots(tmp_path: Path) -> None:
    at_once, most, lock = [0], [0], threading.Lock()

    def work() -> None:
        with Slots(tmp_path, 2).one(time.monotonic() + 30.0):
            with lock:
                at_once[0] += 1
                most[0] = max(most[0], at_once[0])
            time.sleep(0.05)
            with lock:
                at_once[0] -= 1

    threads = [threading.Thread(target=work) for _ in range(6)]
    run(threads)
    assert most[0] == 2


def run(threads: Sequence[threading.Thread]) -> None:
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()


def test_a_slot_that_never_comes_is_done_without(tmp_path: Path) -> None:
    with Slots(tmp_path, 1).one(time.monotonic() + 5.0):
        waited = threading.Event()

        def other() -> None:
            with Slots(tmp_path, 1).one(time.monotonic() + 0.1):
                waited.set()

        run([threading.Thread(target=other)])
        assert waited.is_set()


def test_prices() -> None:
    price = known_price("gpt-4o-2024-08-06")
    assert price == price_table()["gpt-4o"]
    assert price is not None
    assert price.of(1_000_000, 100_000) == pytest.approx(3.5)
    assert known_price("llama") is None
    assert VlmConfig(model="llama").price() is None
    own = VlmConfig(model="llama", base_url="http://localhost:1/v1").price()
    assert own is not None
    assert own.of(10**6, 10**6) == 0.0
    told = VlmConfig(model="llama", price_per_million=(1.0, 2.0)).price()
    assert told is not None
    assert told.of(10**6, 10**6) == 3.0


def test_a_key_in_the_address_is_refused() -> None:
    with pytest.raises(ValueError, match="environment"):
        VlmConfig(base_url="http://me:secret@localhost/v1")
