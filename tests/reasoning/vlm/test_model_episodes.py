"""Whole episodes and evaluations with a model behind a real server."""

from __future__ import annotations

import json
import random
import re
from collections import Counter
from pathlib import Path
from typing import Any

import pytest

from chat_server import GOOD, SEEN_AS, Fault, chat_server, prompt_text
from small_house import SMALL, small_config, small_runner
from toponav.cli.main import main
from toponav.evaluation.evaluate import evaluate
from toponav.evaluation.run_config import RunConfig
from toponav.evaluation.run_folder import RunRequest
from toponav.reasoning.base import Query
from toponav.reasoning.prior import PriorReasoner
from toponav.reasoning.schema import Guidance
from toponav.reasoning.vlm.access import ModelAccess
from toponav.reasoning.vlm.vlm_reasoner import VlmReasoner
from toponav.types import Action, Observation

KEY = "sk-test-fedcba9876543210"


@pytest.fixture(autouse=True)
def key(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("OPENAI_API_KEY", KEY)


def asking(url: str) -> RunConfig:
    overrides = {
        "reasoner": "openai",
        "reasoning.openai.base_url": url,
        "reasoning.openai.price_per_million": "[1, 1]",
        "reasoning.openai.retry.backoff_s": "0",
        "reasoning.openai.retry.timeout_s": "0.5",
        "reasoning.openai.breaker.pause_s": "0",
        "reasoning.openai.prompt.two_calls": "false",
        "navigator.panorama.views": "3",
    }
    return small_config("toponav", max_steps=20, overrides=overrides)


class Overheard:
    """What the reasoner in this process is asked, for a server that plays the prior."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.query: Query | None = None
        decide = VlmReasoner.decide

        def listening(reasoner: VlmReasoner, query: Query) -> Guidance:
            self.query = query
            return decide(reasoner, query)

        monkeypatch.setattr(VlmReasoner, "decide", listening)

    def answer(self, body: dict[str, Any]) -> str:
        assert self.query is not None
        listed = re.findall(r"^\d+\. (.*)$", prompt_text(body), re.MULTILINE)
        if listed:
            affinity = PriorReasoner().object_affinity(self.query.target, listed)
            return json.dumps({"likelihoods": affinity.tolist()})
        guidance = PriorReasoner().decide(self.query)
        asked = body["response_format"]["json_schema"]["schema"]["properties"]
        return json.dumps({k: v for k, v in guidance.model_dump().items() if k in asked})


class Actions:
    """Remembers what the agent did."""

    def __init__(self) -> None:
        self.actions: list[Action] = []

    def on_step(self, observation: Observation, action: Action) -> None:
        del observation
        self.actions.append(action)


@pytest.mark.parametrize("preset", ["paper", "default"])
def test_the_prior_behind_a_server_acts_as_the_prior_itself(
    monkeypatch: pytest.MonkeyPatch, preset: str
) -> None:
    overheard = Overheard(monkeypatch)
    with chat_server(overheard.answer) as server:
        asked = {"reasoner": "openai", "reasoning.openai.base_url": server.url}
        runs = []
        for overrides in ({}, asked):
            runner = small_runner("toponav", preset, overrides=overrides)
            for index in range(4):
                watch, access = Actions(), ModelAccess()
                result = runner.run(runner.episode(index), (watch,), access=access)
                usage = access.log.usage()
                assert usage.failures == usage.unanswered == 0
                assert (usage.calls > 0) == bool(overrides)
                runs.append((watch.actions, result.distance_to_goal))
    assert runs[:4] == runs[4:]
    assert len({len(actions) for actions, _ in runs}) > 1


def test_a_hundred_episodes_with_faults_in_every_third_answer(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    overheard, draw = Overheard(monkeypatch), random.Random(0)

    def script(body: dict[str, Any]) -> str | Fault:
        if draw.random() < 0.3:
            return draw.choice(list(Fault))
        return overheard.answer(body)

    with chat_server(script) as server:
        config = asking(server.url)
        request = RunRequest(source="generated:6", episodes=100, record=False)
        summary = evaluate(request, config, tmp_path / "run")
    usage = summary["vlm"]
    assert summary["all"]["n"] == 100
    assert usage["failure_kinds"] == dict(sorted(server.faults.items()))
    assert usage["calls"] == len(server.requests)
    assert server.faults.keys() == set(SEEN_AS.values())
    lines = (tmp_path / "run" / "episodes.jsonl").read_text().splitlines()
    results = [json.loads(line) for line in lines]
    assert all(result["ended"] in {"stop", "step-limit"} for result in results)
    per_episode: Counter[str] = Counter()
    for result in results:
        per_episode.update(result["vlm"]["failure_kinds"])
    assert per_episode == server.faults
    assert 0 < usage["unanswered"] < usage["calls"]


def untimed(folder: Path) -> list[dict[str, Any]]:
    lines = (folder / "episodes.jsonl").read_text().splitlines()
    return [{**json.loads(line), "seconds": None} for line in lines]


def test_a_recorded_run_is_replayed_without_a_network(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    overheard, draw = Overheard(monkeypatch), random.Random(1)
    first, second, third = tmp_path / "first", tmp_path / "second", tmp_path / "third"
    with chat_server(
        lambda body: Fault.FILTERED if draw.random() < 0.2 else overheard.answer(body)
    ) as server:
        config = asking(server.url)
        evaluate(RunRequest(source="generated:6", episodes=20), config, first)
    assert main(["eval", "--replay", str(first), "--out", str(second)]) == 0
    assert untimed(second) == untimed(first)
    trajectories = sorted(first.glob("episodes/*/trajectory.jsonl"))
    assert len(trajectories) == 20
    for path in trajectories:
        assert path.read_bytes() == (second / path.relative_to(first)).read_bytes()
    assert "prompts changed" not in capsys.readouterr().out

    # The same run after a change of what is said to the model.
    monkeypatch.setattr("toponav.reasoning.vlm.guidance_prompt.NO_IMAGES", "No pictures.")
    monkeypatch.setattr("toponav.reasoning.vlm.guidance_prompt.VIEWS", "Views.")
    assert main(["eval", "--replay", str(first), "--out", str(third)]) == 0
    usage = json.loads((third / "summary.json").read_text())["vlm"]
    assert usage["not_recorded"] == usage["unanswered"] > 0
    assert "prompts changed since the recording" in capsys.readouterr().out


def test_replay_is_told_nothing_that_the_run_knows(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["eval", "--replay", str(tmp_path), "--out", str(tmp_path / "x")]) == 2
    assert "cannot read the configuration" in capsys.readouterr().err
    assert main(["eval", "generated:6", "--replay", str(tmp_path)]) == 2
    assert "leave them out" in capsys.readouterr().err
    offline = tmp_path / "offline"
    evaluate(RunRequest(source="generated:6"), small_config("random", max_steps=2), offline)
    assert main(["eval", "--replay", str(offline), "--out", str(tmp_path / "x")]) == 2
    assert "nothing to replay" in capsys.readouterr().err


def test_a_run_stops_at_its_limit_of_cost_and_goes_on_with_a_higher_one(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "run"
    with chat_server(lambda body: json.dumps({**GOOD, "direction": 0})) as server:
        asked = [
            "eval", "generated:6", "--episodes", "6", "--preset", "default", "--max-steps", "20",
            "--reasoner", "openai", "--model", "m", "--base-url", server.url, "--cache", "None",
            *SMALL, "--set", "navigator.panorama.views=3", "--out", str(out),
        ]  # fmt: skip
        limit = ["--max-cost", "0.003", "--set", "reasoning.openai.price_per_million=[1,1]"]
        assert main([*asked, *limit]) == 1
        assert "of --max-cost 0.003 after" in capsys.readouterr().err
        spent = [r["vlm"]["cost_usd"] for r in untimed(out)]
        assert 0 < len(spent) < 6
        assert sum(spent) >= 0.003 > sum(spent[:-1])
        assert main([*asked, *limit[2:], "--resume"]) == 0
        assert len(untimed(out)) == 6
    unpriced = [part for part in asked if part not in {"--base-url", server.url}]
    assert main([*unpriced[:-1], str(tmp_path / "other"), "--max-cost", "1"]) == 2
    assert "price of m is not known" in capsys.readouterr().err


def test_a_key_is_in_no_file_and_no_word_of_a_run(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    faults = [Fault.UNAUTHORIZED, Fault.SERVER_ERROR, Fault.RATE_LIMITED]
    with chat_server(lambda body: faults.pop() if faults else json.dumps(GOOD)) as server:
        arguments = [
            "eval", "generated:6", "--episodes", "3", "--max-steps", "30", "--reasoner", "openai",
            "--base-url", server.url, "--cache", str(tmp_path / "cache"), *SMALL,
            "--set", "reasoning.openai.breaker.pause_s=0",
            "--out", str(tmp_path / "run"),
        ]  # fmt: skip
        assert main(arguments) == 0
    assert server.keys[0] == f"Bearer {KEY}"
    files = [path for path in tmp_path.rglob("*") if path.is_file()]
    assert {"cache", "calls", "episodes"} <= {part for path in files for part in path.parts}
    assert [path for path in files if KEY.encode() in path.read_bytes()] == []
    assert KEY not in "".join(capfd.readouterr())


def test_without_a_key_a_run_does_not_begin(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.delenv("OPENAI_API_KEY")
    out = tmp_path / "run"
    assert main(["eval", "generated:6", "--reasoner", "openai", "--out", str(out)]) == 2
    assert "OPENAI_API_KEY" in capsys.readouterr().err
    assert not out.exists()
