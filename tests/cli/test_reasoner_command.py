"""`toponav reasoner check`: what it says of servers that can much, little and nothing."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import pytest

from chat_server import GOOD, Fault, chat_server, prompt_text
from small_house import SMALL
from toponav.cli.main import main

LISTED = re.compile(r"^\d+\. ", re.MULTILINE)
"""What a prompt about names lists."""


def capable(body: dict[str, Any]) -> str:
    """Follows every question; sees what is shown."""
    text, content = prompt_text(body), body["messages"][1]["content"]
    if "square" in text:
        return json.dumps({"reason": "green" if isinstance(content, list) else "blue"})
    if "ready" in text:
        return json.dumps({"reason": "Ready."})
    return json.dumps({**GOOD, "node_id": 2, "direction": 1})


def check(capsys: pytest.CaptureFixture[str], url: str, code: int = 0) -> dict[str, Any]:
    arguments = ["reasoner", "check", "--base-url", url, "--model", "gpt-4o", "--json"]
    assert main([*arguments, "--set", "reasoning.openai.retry.backoff_s=0"]) == code
    found: dict[str, Any] = json.loads(capsys.readouterr().out)
    return found


def passed(data: dict[str, Any]) -> list[bool]:
    return [question["passed"] for question in data["questions"]]


def test_a_capable_model(capsys: pytest.CaptureFixture[str]) -> None:
    with chat_server(capable) as server:
        data = check(capsys, server.url)
    assert passed(data) == [True] * 4
    assert data["structured"] == "schema"
    assert data["episode_usd"] == pytest.approx(6 * (1000 * 2.5 + 50 * 10.0) / 1e6)


def test_a_blind_model_without_schemas(capsys: pytest.CaptureFixture[str]) -> None:
    def limited(body: dict[str, Any]) -> str | tuple[int, str]:
        if "response_format" in body:
            return 400, "response_format: not supported"
        if isinstance(body["messages"][1]["content"], list):
            return 400, "image input is not supported"
        return capable(body)

    with chat_server(limited) as server:
        data = check(capsys, server.url)
    assert passed(data) == [True, False, True, True]
    assert data["questions"][1]["detail"] == "the server refuses images"
    assert data["structured"] == "instruction"


def test_a_model_that_rambles(capsys: pytest.CaptureFixture[str]) -> None:
    with chat_server(lambda body: "Well, let me think.") as server:
        data = check(capsys, server.url, code=1)
    assert passed(data) == [False] * 4
    assert data["episode_usd"] is None


def test_a_server_that_is_down_is_asked_one_question(capsys: pytest.CaptureFixture[str]) -> None:
    with chat_server(lambda body: Fault.SERVER_ERROR) as server:
        data = check(capsys, server.url, code=1)
    assert passed(data) == [False]


def test_people_get_lines(capsys: pytest.CaptureFixture[str]) -> None:
    with chat_server(capable) as server:
        assert main(["reasoner", "check", "--base-url", server.url]) == 0
    out = capsys.readouterr().out
    assert "yes  sees images" in out
    assert "an episode of 6 decisions: 0.0180 dollars" in out


def test_the_ledger_of_a_run_adds_up(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    faults = [Fault.SERVER_ERROR]

    def script(body: dict[str, Any]) -> str | Fault:
        if "likelihoods" in json.dumps(body["response_format"]):
            return json.dumps({"likelihoods": [0.5] * len(LISTED.findall(prompt_text(body)))})
        return faults.pop() if faults else json.dumps({**GOOD, "direction": 0})

    with chat_server(script) as server:
        run = [
            "eval", "generated:6", "--episodes", "2", "--max-steps", "30", *SMALL, "--reasoner",
            "openai", "--base-url", server.url, "--cache", "None", "--out", str(tmp_path),
        ]  # fmt: skip
        assert main(run) == 0
    spent = json.loads((tmp_path / "summary.json").read_text())["vlm"]
    capsys.readouterr()
    assert main(["reasoner", "ledger", str(tmp_path), "--json"]) == 0
    rows = json.loads(capsys.readouterr().out)["rows"]
    assert [row["prompt"] for row in rows] == ["guidance", "objects", "all"]
    assert rows[1]["questions"] == 2  # once an episode
    assert rows[-1]["calls"] == spent["calls"] == len(server.requests)
    assert rows[-1]["cost_usd"] == pytest.approx(spent["cost_usd"])
    assert rows[-1]["failures"] == {"server error": 1}
    assert main(["reasoner", "ledger", str(tmp_path)]) == 0
    assert f"{spent['calls']} calls (server error 1)" in capsys.readouterr().out


def test_a_run_without_a_model_has_no_ledger(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    assert main(["reasoner", "ledger", str(tmp_path)]) == 2
    assert "no model was asked" in capsys.readouterr().err
